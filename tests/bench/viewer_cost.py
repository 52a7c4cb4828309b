"""What a viewer costs the simulation, and how long commands take, on a real evod.

    viewer_cost.py EVOD MESSAGES [--organisms N] [--runs N] [--json]

The same ticks of the same run are simulated again and again at full speed on one thread, by turns with a subscriber at
30 pictures a second and without one; what is compared is the processor time of the simulation thread for those ticks.
"""
import argparse
import re
import socket
import statistics
import subprocess
import sys
import threading
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--organisms", type=int, default=10_000)
parser.add_argument("--runs", type=int, default=11, help="pairs of runs")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Client, assignments, benchmark_world, print_figures, thread_s  # noqa: E402
from evod.v1 import commands_pb2 as c, world_pb2 as w  # noqa: E402

parameters = benchmark_world(options.organisms)
first_tick, last_tick = 60, 60 + max(100, 6_000_000 // options.organisms)


def start(*arguments):
    began = time.perf_counter()
    process = subprocess.Popen([options.evod, "--port", "0", "--keep-nothing", *arguments],
                               stdout=subprocess.PIPE, text=True)
    line = process.stdout.readline()
    port = int(line.split("listening on ")[1].split(",")[0].rsplit(":")[1])
    Client(port)
    return process, port, time.perf_counter() - began


class Reader(threading.Thread):
    """Reads what a viewer is sent, and counts it, until its connection is shut down."""

    def __init__(self, viewer):
        super().__init__()
        self.viewer, self.pictures, self.picture_bytes = viewer, 0, 0
        self.start()

    def run(self):
        try:
            while True:
                channel, body = self.viewer.frame()
                if channel == 2:
                    self.pictures += 1
                    self.picture_bytes = len(body)
        except (EOFError, OSError):
            pass

    def finish(self):
        self.viewer.socket.shutdown(socket.SHUT_RDWR)
        self.join()


def measure_starts():
    """Seconds from exec to the first client's welcome, several times."""
    starts = []
    for _ in range(9):
        process, _, took = start()
        starts.append(took)
        process.terminate()
        process.wait()
    return starts


def measure_memory():
    """The most memory that a server with the default world at full speed takes, in bytes."""
    process, port, _ = start()
    control = Client(port)
    control.call(create_world=c.CreateWorld(name="w", seed=1))
    control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
    control.call(run=c.Run(world="w"))
    time.sleep(5)
    peak_kib = re.search(r"VmHWM:\s+(\d+)", open(f"/proc/{process.pid}/status").read())[1]
    process.terminate()
    process.wait()
    return int(peak_kib) * 1024


def measure_viewer(process, port, control):
    """Seconds of the simulation thread per tick, by whether a viewer watched; how many pictures, and bytes of one."""
    per_tick = {False: [], True: []}
    pictures = 0
    for run in range(2 * options.runs):
        watched = run % 2 == 1
        control.call(reset_world=c.ResetWorld(world="w"))
        reader = None
        if watched:
            viewer = Client(port)
            viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=30))
            reader = Reader(viewer)
        control.run_to(first_tick)
        before = thread_s(process.pid, "simulation")
        control.run_to(last_tick)
        per_tick[watched].append((thread_s(process.pid, "simulation") - before) / (last_tick - first_tick))
        if reader:
            reader.finish()
            pictures += reader.pictures
    return per_tick, pictures, reader.picture_bytes


def time_calls(control, count, **request):
    times = []
    for _ in range(count):
        began = time.perf_counter()
        control.call(**request)
        times.append(time.perf_counter() - began)
    return times


def spread_ms(values):
    return {"median": 1e3 * statistics.median(values), "min": 1e3 * min(values), "max": 1e3 * max(values)}


def measure():
    starts = measure_starts()
    memory_bytes = measure_memory()
    process, port, _ = start("--threads", "1")
    control = Client(port)
    control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(parameters)))
    control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
    per_tick, pictures, picture_bytes = measure_viewer(process, port, control)
    control.call(run=c.Run(world="w"))
    command_beside = time_calls(control, 300, set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
    query_beside = time_calls(control, 300, list_worlds=c.ListWorlds())
    control.call(pause=c.Pause(world="w"))
    command_at_rest = time_calls(control, 1000, pause=c.Pause(world="w"))
    process.terminate()
    process.wait()
    rises = [100 * (watched / alone - 1) for alone, watched in zip(per_tick[False], per_tick[True])]
    return {"organisms": options.organisms, "items": parameters["food_count"] + parameters["poison_count"],
            "ticks": last_tick - first_tick, "pairs": options.runs,
            "start_ms": spread_ms(starts), "default_world_memory_bytes": memory_bytes,
            "tick_alone_ms": spread_ms(per_tick[False]), "tick_watched_ms": spread_ms(per_tick[True]),
            "viewer_rise_percent": {"median": statistics.median(rises), "min": min(rises), "max": max(rises)},
            "pictures": pictures, "picture_bytes": picture_bytes,
            "command_at_rest_ms": spread_ms(command_at_rest), "command_beside_ms": spread_ms(command_beside),
            "query_beside_ms": spread_ms(query_beside)}


print_figures(measure(), options.json)
