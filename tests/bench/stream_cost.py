"""What pictures cost by each codec, on a real evod: bytes, the server's time, and numpy's to decode them.

    stream_cost.py EVOD MESSAGES [--organisms N ...] [--seconds S] [--json]

Each world runs at the speed of life, and one viewer at a time reads 30 pictures a second of the same stretch of it. Bytes
are those of whole frames with their headers, keyframes included; the server's time is that of its network thread, sending
included.
"""
import argparse
import ctypes
import pathlib
import statistics
import sys
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--organisms", type=int, nargs="+", default=[50, 10_000])
parser.add_argument("--seconds", type=int, default=20, help="simulated, and real, of each codec")
parser.add_argument("--runs", type=int, help="2 for a quick look")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path[:0] = [options.messages, str(pathlib.Path(__file__).resolve().parents[1] / "system")]

from bench_client import Client, Server, assignments, benchmark_world, print_figures  # noqa: E402
from delta_decoder import Decoder  # noqa: E402
from evod.v1 import commands_pb2 as c, stream_pb2, world_pb2 as w  # noqa: E402

first_tick, last_tick = 60, 60 + 60 * (5 if options.runs else options.seconds)
zstd = ctypes.CDLL("libzstd.so.1")
zstd.ZSTD_getFrameContentSize.restype, zstd.ZSTD_decompress.restype = ctypes.c_ulonglong, ctypes.c_size_t


def zstd_content(frame):
    content = ctypes.create_string_buffer(zstd.ZSTD_getFrameContentSize(frame, ctypes.c_size_t(len(frame))))
    zstd.ZSTD_decompress(content, ctypes.c_size_t(len(content)), frame, ctypes.c_size_t(len(frame)))
    return content.raw


def watch(server, name, codec, compression):
    """Reads the pictures of a run from first_tick to last_tick; figures of one picture, in the mean."""
    control = server.control
    control.call(reset_world=c.ResetWorld(world=name))
    control.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
    control.call(run_until_tick=c.RunUntilTick(world=name, tick=first_tick))
    while next(x for x in control.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == name).tick < first_tick:
        time.sleep(0.005)
    control.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(real_time_factor=1)))
    viewer = Client(server.port)
    viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=name, rate_hz=30, codec=codec, compression=compression))
    before = server.thread_s("evod")
    control.call(run_until_tick=c.RunUntilTick(world=name, tick=last_tick))
    decoder, sizes, alive, decoding, keyframes = Decoder(zstd_content), [], [], [], []
    tick = 0
    while tick < last_tick:
        channel, body = viewer.frame()
        if channel != 2:
            continue
        picture = stream_pb2.SnapshotFrame.FromString(bytes(body))
        tick = picture.tick
        if codec == stream_pb2.CODEC_DELTA:
            began = time.thread_time()
            decoder.decode(picture)
            decoding.append(time.thread_time() - began)
            if picture.base_sequence == 0:
                keyframes.append(8 + len(body))
        sizes.append(8 + len(body))
        alive.append(picture.organism_count)
    spent = server.thread_s("evod") - before
    viewer.socket.close()
    figures = {"pictures": len(sizes), "bytes": statistics.mean(sizes), "bytes_median": statistics.median(sizes),
               "bytes_per_organism": sum(sizes) / sum(alive), "server_ms": 1e3 * spent / len(sizes)}
    if decoding:
        figures |= {"decode_ms": 1e3 * statistics.median(decoding), "keyframes": len(keyframes),
                    "keyframe_bytes": statistics.mean(keyframes)}
    return figures


def measure():
    figures = {}
    with Server(options.evod, "--keep-nothing") as server:
        for organisms in options.organisms:
            name = f"w{organisms}"
            parameters = {} if organisms == 50 else benchmark_world(organisms)
            server.control.call(create_world=c.CreateWorld(name=name, seed=1, parameters=assignments(parameters)))
            for codec, number, compression in (("columns", 1, 1), ("delta", 2, 1), ("delta and zstd", 2, 2)):
                figures[f"{organisms} {codec}"] = {"organisms": organisms, "codec": codec} | watch(
                    server, name, number, compression)
            server.control.call(delete_world=c.DeleteWorld(world=name))
    return figures


figures = measure()
if options.json:
    print_figures(list(figures.values()), True)
else:
    print_figures({name: {k: v for k, v in of.items() if k not in ("organisms", "codec")} for name, of in figures.items()},
                  False)
