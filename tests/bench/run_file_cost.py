"""What there is to a run file: how it grows, how soon any moment of it is there, and how long verifying takes.

    run_file_cost.py EVOD MESSAGES [--generations N] [--runs N] [--json]

The run is the default world's. Its file grows by the difference of two runs, one twice as long as the other, over the
generations between. Moments are drawn by chance and sought one after another. Verifying the run is compared with
simulating it without a file, `evod run`, by turns.
"""
import argparse
import os
import random
import subprocess
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--generations", type=int, default=200, help="of the longer run")
parser.add_argument("--moments", type=int, default=200, help="that are sought")
parser.add_argument("--runs", type=int, default=9, help="pairs of runs, for the time")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Server, print_figures, spread, spread_ms  # noqa: E402
from evod.v1 import commands_pb2 as c, world_pb2 as w  # noqa: E402


def keep_run(folder, generations):
    """The path of a run file of so many generations, and the ticks that it holds."""
    os.mkdir(folder)
    with Server(options.evod, "--data", folder, "--seed", "1", "--speed", "max") as server:
        server.control.call(run=c.Run(world="default", generations=generations))
        waiting = 1
        while waiting:
            time.sleep(0.05)
            world = server.control.call(list_worlds=c.ListWorlds()).worlds.worlds[0]
            waiting = world.state == w.RUN_STATE_RUNNING
    return f"{folder}/default.evod", world.tick


def seek_times(path, ticks):
    """Seconds until the server is at each of some moments and says its hash."""
    chance, times = random.Random(1), []
    with Server(options.evod, "replay", path) as server:
        for _ in range(options.moments):
            to = c.RunMoment(tick=chance.randrange(ticks + 1))
            began = time.perf_counter()
            world = server.control.call(seek=c.Seek(world="default", to=to)).world
            times.append(time.perf_counter() - began)
            assert world.tick == to.tick
    return times


def wall_s(*command):
    began = time.perf_counter()
    subprocess.run([options.evod, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - began


def measure():
    with tempfile.TemporaryDirectory() as folder:
        short, _ = keep_run(folder + "/short", options.generations // 2)
        path, ticks = keep_run(folder + "/long", options.generations)
        growth = (os.path.getsize(path) - os.path.getsize(short)) / (options.generations - options.generations // 2)
        simulated, verified = [], []
        for _ in range(options.runs):
            simulated.append(wall_s("run", "--seed", "1", "--generations", str(options.generations)))
            verified.append(wall_s("verify", path))
        return {"generations": options.generations, "ticks": ticks, "bytes_per_generation": growth,
                "seek_ms": spread_ms(seek_times(path, ticks)), "run_s": spread(simulated), "verify_s": spread(verified),
                "verify_over_run": spread([v / s for v, s in zip(verified, simulated)])}


print_figures(measure(), options.json)
