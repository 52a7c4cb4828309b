"""The cost of the Python package with a real server: generations compared to `evod run`, and snapshots as arrays.

    python_cost.py EVOD PACKAGE [--rounds N] [--seconds S] [--organisms N] [--json]

Generations: each round runs the same hundred generations of the default world on one thread, first with `evod run`,
then with World.run() and a Python callback for each. Start-up is excluded. On a busy machine compare the processor time
of the simulation thread rather than the clock.

Snapshots: one connection receives them from a world at full speed and converts every column to px. It has several
subscriptions, as the server sends each at most 120 snapshots per second. Then the same snapshots are decoded from
memory, which measures the package alone.
"""
import argparse
import copy
import pathlib
import resource
import statistics
import subprocess
import sys
import time

import numpy

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("package", help="where the Python package is: build/release/python")
parser.add_argument("--rounds", type=int, default=9)
parser.add_argument("--seconds", type=float, default=10)
parser.add_argument("--organisms", type=int, default=10_000)
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.package)

import evod  # noqa: E402
from bench_client import benchmark_world, print_figures, spread  # noqa: E402
from evod import framing  # noqa: E402
from evod.snapshot_decoder import SnapshotDecoder  # noqa: E402
from evod.v1 import stream_pb2  # noqa: E402

GENERATIONS, SUBSCRIPTIONS = 100, 4


def by_program(program, seed):
    """Seconds by the clock, and seconds of processor time."""
    def run_s(generations):
        def now():
            used = resource.getrusage(resource.RUSAGE_CHILDREN)
            return numpy.array((time.perf_counter(), used.ru_utime + used.ru_stime))

        began = now()
        command = [program, "run", "--seed", str(seed), "--generations", str(generations), "--threads", "1"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return now() - began

    return run_s(1 + GENERATIONS) - run_s(1)


def simulation_s(lab):
    """Processor time of the simulation thread."""
    supervisor = lab._server._supervisor.pid
    with open(f"/proc/{supervisor}/task/{supervisor}/children") as children:
        tasks = pathlib.Path("/proc") / children.read().split()[0] / "task"
    (task,) = (task for task in tasks.iterdir() if (task / "comm").read_text().strip() == "simulation")
    return int((task / "schedstat").read_text().split()[0]) / 1e9


def by_package(program, seed):
    """Seconds by the clock, processor time of the simulation thread, and processor time of this program."""
    best = []
    with evod.local(seed=seed, threads=1, program=program) as lab:
        run = lab.world().run(1 + GENERATIONS)
        next(run)

        def now():
            return numpy.array((time.perf_counter(), simulation_s(lab), time.process_time()))

        began = now()
        for g in run:
            best.append((g.best, g.mean))
        took = now() - began
    assert len(best) == GENERATIONS
    return took


def generations(program, rounds):
    pairs = [(by_program(program, seed), by_package(program, seed)) for seed in range(1, rounds + 1)]
    return {"evod_run_s": spread([a[0] for a, _ in pairs]), "package_s": spread([b[0] for _, b in pairs]),
            "ratio": spread([b[0] / a[0] for a, b in pairs]),
            "ratio_of_processor_s_of_what_simulates": spread([b[1] / a[1] for a, b in pairs]),
            "python_processor_ms_a_generation": spread([1e3 * b[2] / GENERATIONS for _, b in pairs])}


def convert(snapshot):
    """Converts every column to px."""
    kinds = (snapshot.organisms, snapshot.food, snapshot.poison)
    return sum(float(kind.x_px[0] + kind.y_px[0]) for kind in kinds) + float(
        snapshot.organisms.radius_px[0] + snapshot.organisms.health[0])


def snapshots(program, organisms, seconds):
    messages = []
    with evod.local(seed=1, program=program, experiment=benchmark_world(organisms)) as lab:
        world, core = lab.world(), lab._link.core
        streams = [world.snapshots(120) for _ in range(SUBSCRIPTIONS)]
        world.run()
        for stream in streams:
            next(stream)
        began, tick, count = time.perf_counter(), next(streams[0]).tick, 0
        while time.perf_counter() < began + seconds:
            for stream in streams:
                snapshot = next(stream)
                convert(snapshot)
                count += 1
        come_per_s = count / (time.perf_counter() - began)
        ticks_per_s = (snapshot.tick - tick) / (time.perf_counter() - began)
        for stream in streams:
            stream.close()
        take = core._take_snapshot
        core._take_snapshot = lambda message: (messages.append(copy.deepcopy(message)), take(message))
        with world.snapshots(120) as recorded:
            while len(messages) < 200:
                next(recorded)
    last = messages[-1].subscription_id  # the first messages are of the closed subscriptions
    messages = [message for message in messages if message.subscription_id == last]
    data = [framing.encode(message.SerializeToString()) for message in messages]
    decoder, reader = SnapshotDecoder(), framing.FrameReader()
    began = time.perf_counter()
    for one in data:
        reader.feed(one)
        for _, body in reader.frames():
            convert(decoder.decode(stream_pb2.SnapshotFrame.FromString(body)))
    alone_per_s = len(data) / (time.perf_counter() - began)
    return {"organisms": organisms, "come_per_s": come_per_s, "ticks_per_s": ticks_per_s,
            "decoded_alone_per_s": alone_per_s,
            "frame_bytes": statistics.mean(map(len, data))}


print_figures({"generations": generations(options.evod, options.rounds),
               "snapshots": snapshots(options.evod, options.organisms, options.seconds)}, options.json)
