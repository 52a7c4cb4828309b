"""What clients cost the simulation, whether they watch, idle or attack; how soon commands and snapshots arrive
meanwhile.

    network_cost.py EVOD MESSAGES [--organisms N] [--runs N] [--only NAME ...] [--json]

The world is that of default.json with scale_with_population. It runs free with one worker; the same ticks of the same
run are simulated by turns with such clients and without. The clients are a process of their own
(tests/system/attacker.py), pinned to another core than the server's simulation thread. A loss is the rise of the
simulation thread's processor time per tick, plus the processor time of all other threads of the server over the
simulation thread's. Snapshots come 20 times a second, as deltas without compression.
"""
import argparse
import json
import os
import pathlib
import statistics
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--organisms", type=int, default=10_000)
parser.add_argument("--runs", type=int, default=9, help="pairs of runs of each kind of client")
parser.add_argument("--only", nargs="+", metavar="NAME", help="of the kinds of clients below, and latency")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path[:0] = [options.messages, str(pathlib.Path(__file__).resolve().parents[1] / "system")]

from attack import Attack  # noqa: E402
from bench_client import Client, Server, assignments, print_figures, spread  # noqa: E402
from evod.v1 import commands_pb2 as c, stream_pb2, world_pb2 as w  # noqa: E402

cores = sorted(os.sched_getaffinity(0))
server_core, client_core = cores[0], cores[-1]
first_tick, last_tick = 120, 120 + max(200, 200_000_000 // options.organisms)
kinds = {"viewer_1": ("watch", 1), "viewers_10": ("watch", 10), "viewers_50": ("watch", 50),
         "region_viewers_200": ("views", 200), "idle_1000": ("idle", 1000), "slow_200": ("slow", 200),
         "deaf_100": ("deaf", 100), "malformed_50000_a_second": ("malformed", 50_000)}


def serve(*arguments):
    return Server(options.evod, "--threads", "1", "--sessions-max", "2000", *arguments)


def create(server, organisms):
    parameters = assignments({"population_size": organisms, "scale_with_population": True})
    server.control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=parameters))
    server.control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))


def pin(server):
    """The simulation thread to one core; the others go where they like."""
    for task, name in server.threads():
        if name == "simulation":
            os.sched_setaffinity(task, {server_core})


def thread_s(server):
    """Processor seconds: of the simulation thread, of all others."""
    return server.thread_s("simulation"), server.thread_s(lambda name: name != "simulation")


def attack(server, kind, number):
    """Clients of that kind, on a core that is not the simulation's."""
    clients = Attack(options.messages, server.port, kind, number)
    os.sched_setaffinity(clients.process.pid, {client_core})
    return clients


def stretch(server):
    """Processor and wall seconds of the ticks that are measured: of the simulation thread, the others, the clock."""
    server.control.run_to(first_tick)
    before, began = thread_s(server), time.perf_counter()
    server.control.run_to(last_tick, pause_s=0.25)
    wall = time.perf_counter() - began
    return [after - earlier for after, earlier in zip(thread_s(server), before)] + [wall]


def loss(server, kind, number):
    connections = 1 if kind == "malformed" else number  # whose number is of frames
    rises, shares, losses, walls, became, memory = [], [], [], [], None, []
    for _ in range(options.runs):
        server.control.call(reset_world=c.ResetWorld(world="w"))
        alone = stretch(server)
        server.control.call(reset_world=c.ResetWorld(world="w"))
        without = server.status_bytes("VmRSS")
        clients = attack(server, kind, number)
        beside = stretch(server)
        memory.append((server.status_bytes("VmRSS") - without) / connections)
        became = clients.end()
        rises.append(100 * (beside[0] / alone[0] - 1))
        shares.append(100 * beside[1] / beside[0])
        losses.append(rises[-1] + shares[-1])
        walls.append(100 * (beside[2] / alone[2] - 1))
    return {"loss_percent": spread(losses), "simulation_rise_percent": spread(rises),
            "others_share_percent": spread(shares), "wall_rise_percent": spread(walls),
            "memory_bytes_each": spread(memory), **{name: became[name]
                                                    for name in ("frames", "bytes", "closed", "seconds")}}


def measure_losses():
    figures = {"organisms": options.organisms, "ticks": last_tick - first_tick, "pairs": options.runs}
    with serve("--keep-nothing") as server:
        create(server, options.organisms)
        pin(server)
        for name, (kind, number) in kinds.items():
            if options.only is None or name in options.only:
                figures[name] = loss(server, kind, number)
                print(name, json.dumps(figures[name]), file=sys.stderr, flush=True)
    return figures


def percentile(values, percent):
    return sorted(values)[min(len(values) - 1, len(values) * percent // 100)]


def measure_latency(folder):
    """Milliseconds to the answer of a command during a full stream; to the first snapshot of a late subscriber."""
    figures = {}
    for name, arguments in (("kept_nothing", ["--keep-nothing"]), ("durable", ["--data", folder])):
        with serve(*arguments) as server:
            create(server, options.organisms)
            clients = attack(server, "watch", 10)
            server.control.call(run=c.Run(world="w"))
            time.sleep(1)
            worlds = server.control.call(list_worlds=c.ListWorlds()).worlds.worlds
            tick_ms = 1e3 / next(x for x in worlds if x.name == "w").ticks_per_s
            times = []
            for _ in range(1000):
                began = time.perf_counter()
                server.control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
                times.append(1e3 * (time.perf_counter() - began))
            figures[f"command_{name}_ms"] = {"tick": tick_ms, "median": statistics.median(times),
                                             "p99": percentile(times, 99), "max": max(times)}
            clients.end()
    for organisms in (10_000, 100_000):
        with serve("--keep-nothing") as server:
            create(server, organisms)
            server.control.call(run=c.Run(world="w"))
            times = []
            for _ in range(15):
                began = time.perf_counter()
                viewer = Client(server.port)
                viewer.call(subscribe_snapshots=c.SubscribeSnapshots(
                    world="w", rate_hz=20, codec=stream_pb2.CODEC_DELTA, compression=stream_pb2.COMPRESSION_ZSTD))
                while viewer.frame()[0] != 2:
                    pass
                times.append(1e3 * (time.perf_counter() - began))
                viewer.socket.close()
            figures[f"first_snapshot_{organisms}_ms"] = spread(times)
    return figures


def measure():
    figures = {} if options.only == ["latency"] else measure_losses()
    if options.only is None or "latency" in options.only:
        with tempfile.TemporaryDirectory() as folder:
            figures |= measure_latency(folder)
    return figures


print_figures(measure(), options.json)
