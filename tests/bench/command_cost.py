"""How long a command waits for the disk, beside checkpoints of a large world too, and beside what the disk itself
takes.

    command_cost.py EVOD MESSAGES [--organisms N] [--seconds S] [--data FOLDER] [--json]

A world runs at full speed, in a generation that does not end. One client sends a command and a query by turns, each
once the one before is answered. Both wait for the tick that is being simulated; only the command waits for the disk. A
command came beside a checkpoint if the server wrote more than 100 KB meanwhile, which commands and hashes do not take:
then a checkpoint was being written, or a log copied. The disk itself: 4 KiB appended to a file of the same folder, and
fdatasync. How long commands waited for the disk once they had been carried out, and commits took, is what the server
measures itself.
"""
import argparse
import contextlib
import os
import re
import sqlite3
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--organisms", type=int, default=100_000)
parser.add_argument("--seconds", type=float, default=30, help="to ask for")
parser.add_argument("--data", default=None, help="the folder whose disk is meant; otherwise that of temporary files")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Server, assignments, benchmark_world, print_figures  # noqa: E402
from evod.v1 import commands_pb2 as c, world_pb2 as w  # noqa: E402

large_bytes = 100_000


def shares(seconds):
    """Milliseconds that half, and 99 of 100, do not exceed, and the most."""
    if not seconds:
        return {"count": 0}
    ordered = sorted(1e3 * s for s in seconds)
    return {"count": len(ordered), "p50_ms": ordered[len(ordered) // 2], "p99_ms": ordered[len(ordered) * 99 // 100],
            "max_ms": ordered[-1]}


def histogram_of(control, name):
    """Of a histogram of the server's metrics: its mean, and by milliseconds how many in 100 took no longer."""
    histogram = next(family for family in control.call(get_metrics=c.GetMetrics()).metrics.families
                     if family.name == name).samples[0].histogram
    count = sum(histogram.counts)
    shares, below = {}, 0
    for bound, of_bucket in zip(histogram.bounds, histogram.counts):
        below += of_bucket
        if 0.2e-3 < bound < 0.1:
            shares[f"within_{1e3 * bound:g}_ms_percent"] = 100 * below / count
    return {"count": count, "mean_ms": 1e3 * histogram.sum / count} | shares


def timed(act):
    began = time.perf_counter()
    act()
    return time.perf_counter() - began


def measure_disk(folder):
    times = []
    with open(f"{folder}/disk", "wb", buffering=0) as file:
        for _ in range(500):
            def append():
                file.write(bytes(4096))
                os.fdatasync(file.fileno())
            times.append(timed(append))
    os.remove(f"{folder}/disk")
    return shares(times)


def measure_commands(folder):
    parameters = benchmark_world(options.organisms) | {"generation_s": 3600.0, "health_loss_per_s": 0.1}
    alone, beside, queries, checkpoints = [], [], [], set()
    with Server(options.evod, "--threads", "1", "--data", folder) as server:
        control = server.control
        control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(parameters)))
        control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        control.run_to(10)
        control.call(run=c.Run(world="w"))
        with open(f"/proc/{server.process.pid}/io", "rb", buffering=0) as io, \
                contextlib.closing(sqlite3.connect(f"file:{folder}/w.evod?mode=ro", uri=True)) as run:
            def written_bytes():
                return int(re.search(rb"wchar: (\d+)", os.pread(io.fileno(), 1000, 0))[1])
            def tick():
                return next(x for x in control.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == "w").tick
            began = looked = time.monotonic()
            first_tick = tick()
            while time.monotonic() < began + options.seconds:
                before = written_bytes()
                took = timed(lambda: control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True))))
                (beside if written_bytes() - before > large_bytes else alone).append(took)
                queries.append(timed(tick))
                if time.monotonic() > looked + 0.5:
                    looked = time.monotonic()
                    checkpoints |= {tick for (tick,) in run.execute("SELECT tick FROM checkpoint")}
            ticks = tick() - first_tick
            waited = histogram_of(control, "evod_journal_wait_seconds")
            commits = histogram_of(control, "evod_journal_commit_seconds")
    return {"checkpoints": len(checkpoints), "tick_ms": 1e3 * options.seconds / max(ticks, 1),
            "command_alone": shares(alone), "command_beside_a_checkpoint": shares(beside), "query": shares(queries),
            "waited_for_the_disk": waited, "commit": commits}


with tempfile.TemporaryDirectory(dir=options.data) as folder:
    figures = {"organisms": options.organisms, "load": os.getloadavg()[0], "disk": measure_disk(folder)}
    figures |= measure_commands(folder)
print_figures(figures | {"load_after": os.getloadavg()[0]}, options.json)
