"""Measures what a viewer costs the simulation, and how long commands take, with a real evod.

    viewer_cost.py EVOD MESSAGES [--organisms N] [--runs N] [--json]

The server simulates the same ticks of the same run repeatedly at full speed on one thread, alternately with and without
a subscriber at 30 snapshots per second. The program compares the processor time of the simulation thread for these
ticks.
"""
import argparse
import socket
import sys
import threading
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="folder of the Python message classes: build/release/tests/system")
parser.add_argument("--organisms", type=int, default=10_000)
parser.add_argument("--runs", type=int, default=11, help="pairs of runs")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Client, Server, assignments, benchmark_world, print_figures, spread, spread_ms  # noqa: E402
from evod.v1 import commands_pb2 as c, world_pb2 as w  # noqa: E402

parameters = benchmark_world(options.organisms)
first_tick, last_tick = 60, 60 + max(100, 6_000_000 // options.organisms)


def serve(*arguments):
    return Server(options.evod, "--keep-nothing", *arguments)


class Reader(threading.Thread):
    """Reads and counts the snapshots of a viewer until its connection is shut down."""

    def __init__(self, viewer):
        super().__init__()
        self.viewer, self.snapshots, self.snapshot_bytes = viewer, 0, 0
        self.start()

    def run(self):
        try:
            while True:
                channel, body = self.viewer.frame()
                if channel == 2:
                    self.snapshots += 1
                    self.snapshot_bytes = len(body)
        except (EOFError, OSError):
            pass

    def finish(self):
        self.viewer.socket.shutdown(socket.SHUT_RDWR)
        self.join()


def measure_starts():
    """Seconds from exec to the first client's welcome, for several starts."""
    starts = []
    for _ in range(9):
        with serve() as server:
            starts.append(server.start_s)
    return starts


def measure_memory():
    """The peak memory of a server with the default world at full speed, in bytes."""
    with serve() as server:
        server.control.call(create_world=c.CreateWorld(name="w", seed=1))
        server.control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        server.control.call(run=c.Run(world="w"))
        time.sleep(5)
        return server.status_bytes("VmHWM")


def measure_viewer(server):
    """Seconds of the simulation thread per tick, without and with a viewer; snapshots received, and bytes of the
    last."""
    per_tick = {False: [], True: []}
    snapshots = 0
    control = server.control
    for run in range(2 * options.runs):
        watched = run % 2 == 1
        control.call(reset_world=c.ResetWorld(world="w"))
        reader = None
        if watched:
            viewer = Client(server.port)
            viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=30))
            reader = Reader(viewer)
        control.run_to(first_tick)
        before = server.thread_s("simulation")
        control.run_to(last_tick)
        per_tick[watched].append((server.thread_s("simulation") - before) / (last_tick - first_tick))
        if reader:
            reader.finish()
            snapshots += reader.snapshots
    return per_tick, snapshots, reader.snapshot_bytes


def time_calls(control, count, **request):
    times = []
    for _ in range(count):
        began = time.perf_counter()
        control.call(**request)
        times.append(time.perf_counter() - began)
    return times


def measure():
    starts = measure_starts()
    memory_bytes = measure_memory()
    with serve("--threads", "1") as server:
        control = server.control
        control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(parameters)))
        control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        per_tick, snapshots, snapshot_bytes = measure_viewer(server)
        control.call(run=c.Run(world="w"))
        command_beside = time_calls(control, 300, set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        query_beside = time_calls(control, 300, list_worlds=c.ListWorlds())
        control.call(pause=c.Pause(world="w"))
        command_at_rest = time_calls(control, 1000, pause=c.Pause(world="w"))
    rises = [100 * (watched / alone - 1) for alone, watched in zip(per_tick[False], per_tick[True])]
    return {"organisms": options.organisms, "items": parameters["food_count"] + parameters["poison_count"],
            "ticks": last_tick - first_tick, "pairs": options.runs,
            "start_ms": spread_ms(starts), "default_world_memory_bytes": memory_bytes,
            "tick_alone_ms": spread_ms(per_tick[False]), "tick_watched_ms": spread_ms(per_tick[True]),
            "viewer_rise_percent": spread(rises),
            "snapshots": snapshots, "snapshot_bytes": snapshot_bytes,
            "command_at_rest_ms": spread_ms(command_at_rest), "command_beside_ms": spread_ms(command_beside),
            "query_beside_ms": spread_ms(query_beside)}


print_figures(measure(), options.json)
