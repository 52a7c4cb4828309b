"""The cost of snapshots in each codec, on a real evod: bytes, the server's time, and NumPy's time to decode them.

    stream_cost.py EVOD MESSAGES [--organisms N ...] [--movers] [--seconds S] [--json]

Each world runs at real time, and one viewer at a time reads 30 snapshots a second of the same stretch of it. Bytes
are those of whole frames with their headers, keyframes included; the server's time is that of its network thread,
sending included.

With --movers instead: 23,000 entities of which some move, by delta and zstd, 20 snapshots a second, 3 ticks from one to
the next. `half_move` is default.json with scale_with_population and 10,000 organisms; of `tenth_moves` 2,300 are
organisms on as much ground; of `all_move` all are, with ground in proportion. Bytes are those of an entity and
snapshot; a keyframe is either one that all get, every 2 s, or `asked` for by one viewer in between. Then what the
simulation thread does to give a snapshot away, as the server measures it, of 10,000 and 100,000 organisms at full
speed.
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
parser.add_argument("--movers", action="store_true", help="what it takes depends on how many move")
parser.add_argument("--seconds", type=int, help="simulated, and real, of each codec (20), or kind of world (10)")
parser.add_argument("--runs", type=int, help="2 for a quick look")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path[:0] = [options.messages, str(pathlib.Path(__file__).resolve().parents[1] / "system")]

from bench_client import Client, Server, assignments, benchmark_world, print_figures  # noqa: E402
from delta_decoder import Decoder  # noqa: E402
from evod.v1 import commands_pb2 as c, stream_pb2, world_pb2 as w  # noqa: E402

rate_hz = 20 if options.movers else 30
seconds = 5 if options.runs else options.seconds or (10 if options.movers else 20)
first_tick, last_tick = 60, 60 + 60 * seconds
zstd = ctypes.CDLL("libzstd.so.1")
zstd.ZSTD_getFrameContentSize.restype, zstd.ZSTD_decompress.restype = ctypes.c_ulonglong, ctypes.c_size_t


def zstd_content(frame):
    content = ctypes.create_string_buffer(zstd.ZSTD_getFrameContentSize(frame, ctypes.c_size_t(len(frame))))
    zstd.ZSTD_decompress(content, ctypes.c_size_t(len(content)), frame, ctypes.c_size_t(len(frame)))
    return content.raw


def watch(server, name, codec, compression):
    """Reads the snapshots of a run from first_tick to last_tick; figures of one snapshot, on average."""
    control = server.control
    control.call(reset_world=c.ResetWorld(world=name))
    control.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
    control.call(run_until_tick=c.RunUntilTick(world=name, tick=first_tick))
    while next(x for x in control.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == name).tick < first_tick:
        time.sleep(0.005)
    control.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(real_time_factor=1)))
    viewer = Client(server.port)
    subscribed = viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=name, rate_hz=rate_hz, codec=codec,
                                                                      compression=compression)).subscription
    before = server.thread_s("evod")
    control.call(run_until_tick=c.RunUntilTick(world=name, tick=last_tick))
    decoder, sizes, alive, decoding, keyframes = Decoder(zstd_content), [], [], [], []
    entities, entities_in_keyframes = 0, 0
    tick = 0
    while tick < last_tick:
        channel, body = viewer.frame()
        if channel != 2:
            continue
        snapshot = stream_pb2.SnapshotFrame.FromString(bytes(body))
        tick = snapshot.tick
        if codec == stream_pb2.CODEC_DELTA:
            began = time.thread_time()
            decoder.decode(snapshot)
            decoding.append(time.thread_time() - began)
            if snapshot.base_sequence == 0:
                keyframes.append(8 + len(body))
                entities_in_keyframes += entities_in(snapshot)
        entities += entities_in(snapshot)
        sizes.append(8 + len(body))
        alive.append(snapshot.organism_count)
    spent = server.thread_s("evod") - before
    if options.movers:
        control.call(run_until_tick=c.RunUntilTick(world=name, tick=last_tick + 60))
        asked = keyframe_asked_for(viewer, subscribed.subscription_id)
        viewer.socket.close()
        return {"snapshots": len(sizes), "keyframes": len(keyframes), "entities": entities / len(sizes),
                "bytes_each": sum(sizes) / entities, "keyframe_bytes_each": sum(keyframes) / entities_in_keyframes,
                "asked_keyframe_bytes_each": asked, "server_ns_each": 1e9 * spent / entities}
    viewer.socket.close()
    figures = {"snapshots": len(sizes), "bytes": statistics.mean(sizes), "bytes_median": statistics.median(sizes),
               "bytes_per_organism": sum(sizes) / sum(alive), "server_ms": 1e3 * spent / len(sizes)}
    if decoding:
        figures |= {"decode_ms": 1e3 * statistics.median(decoding), "keyframes": len(keyframes),
                    "keyframe_bytes": statistics.mean(keyframes)}
    return figures


def entities_in(snapshot):
    return (snapshot.organism_count + snapshot.food_count + snapshot.poison_count + snapshot.crate_count +
            snapshot.obstacle_count)


def keyframe_asked_for(viewer, subscription_id):
    """Bytes an entity of one, some snapshots after the one before it."""
    for _ in range(8):
        viewer.frame()
    viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription_id))
    while True:
        channel, body = viewer.frame()
        snapshot = stream_pb2.SnapshotFrame.FromString(bytes(body)) if channel == 2 else None
        if snapshot and snapshot.base_sequence == 0:
            return (8 + len(body)) / entities_in(snapshot)


def handing_over(server, organisms):
    """Milliseconds of the simulation thread for a snapshot."""
    def snapshots():
        of_world = next(family for family in server.control.call(get_metrics=c.GetMetrics()).metrics.families
                        if family.name == "evod_snapshot_seconds").samples[-1].histogram
        return of_world.sum, sum(of_world.counts)
    server.control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(
        {"population_size": organisms, "scale_with_population": True})))
    server.control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
    viewer = Client(server.port)
    server.control.call(run=c.Run(world="w"))
    viewer.call(subscribe_snapshots=c.SubscribeSnapshots(
        world="w", rate_hz=rate_hz, codec=stream_pb2.CODEC_DELTA, compression=stream_pb2.COMPRESSION_ZSTD))
    for _ in range(10):
        viewer.frame()
    sum_before, count_before = snapshots()
    for _ in range(rate_hz * seconds):
        viewer.frame()
    sum_after, count_after = snapshots()
    viewer.socket.close()
    server.control.call(delete_world=c.DeleteWorld(world="w"))
    return {"hand_over_ms": 1e3 * (sum_after - sum_before) / (count_after - count_before),
            "snapshots": count_after - count_before}


def measure_movers():
    def ground(organisms):  # of default.json
        return {"island_width_px": 1280 * (organisms / 50) ** 0.5, "island_height_px": 720 * (organisms / 50) ** 0.5}

    worlds = {"half_move": {"population_size": 10_000, "scale_with_population": True},
              "tenth_moves": {"population_size": 2_300, "food_count": 8_000, "poison_count": 12_700, **ground(10_000)},
              "all_move": {"population_size": 23_000, "food_count": 0, "poison_count": 0, **ground(23_000)}}
    figures = {}
    with Server(options.evod, "--keep-nothing") as server:
        for name, parameters in worlds.items():
            server.control.call(create_world=c.CreateWorld(name=name, seed=1, parameters=assignments(parameters)))
            figures[name] = watch(server, name, stream_pb2.CODEC_DELTA, stream_pb2.COMPRESSION_ZSTD)
            server.control.call(delete_world=c.DeleteWorld(world=name))
        for organisms in (10_000, 100_000):
            figures[f"given_away_{organisms}"] = handing_over(server, organisms)
    return figures


def measure():
    figures = {}
    with Server(options.evod, "--keep-nothing") as server:
        for organisms in options.organisms:
            name = f"w{organisms}"
            parameters = {} if organisms == 50 else benchmark_world(organisms)
            server.control.call(create_world=c.CreateWorld(name=name, seed=1, parameters=assignments(parameters)))
            for codec, number, compression in (("plain", 3, 1), ("delta", 2, 1), ("delta and zstd", 2, 2)):
                figures[f"{organisms} {codec}"] = {"organisms": organisms, "codec": codec} | watch(
                    server, name, number, compression)
            server.control.call(delete_world=c.DeleteWorld(world=name))
    return figures


if options.movers:
    print_figures(measure_movers(), options.json)
    sys.exit()
figures = measure()
if options.json:
    print_figures(list(figures.values()), True)
else:
    print_figures({name: {k: v for k, v in of.items() if k not in ("organisms", "codec")} for name,
                   of in figures.items()},
                  False)
