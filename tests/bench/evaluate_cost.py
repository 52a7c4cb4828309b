"""Generations per second of World.evaluate() with a NumPy function, and of the same world that computes its fitness
itself.

    evaluate_cost.py EVOD PACKAGE [--rounds N] [--organisms N] [--generations N] [--json]

Each round rates N organisms in N generations over the loopback interface. The server stores the run, with the
durability that it has by default. Start-up and the creation of the worlds are excluded. The processor time is that of
this program.
"""
import argparse
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("package", help="where the Python package is: build/release/python")
parser.add_argument("--rounds", type=int, default=9)
parser.add_argument("--organisms", type=int, default=1_000)
parser.add_argument("--generations", type=int, default=100)
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.package)

import numpy  # noqa: E402

import evod  # noqa: E402
from bench_client import print_figures, spread  # noqa: E402

SETTING = {"external_bodies": False, "population_size": options.organisms}


def rastrigin(genes, life):
    x = (genes - 150) / 25
    return -(10 * x.shape[1] + (x**2 - 10 * numpy.cos(2 * numpy.pi * x)).sum(axis=1))


def timed(call):
    began, used = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - began, time.process_time() - used


rated, python_ms, built_in = [], [], []
with tempfile.TemporaryDirectory() as data, evod.local(program=options.evod, data=data) as lab:
    for lap in range(options.rounds):
        world = lab.create_world("rated", SETTING | {"fitness": "external"}, seed=lap)
        clock_s, processor_s = timed(lambda: world.evaluate(rastrigin, generations=options.generations))
        rated.append(options.generations / clock_s)
        python_ms.append(1000 * processor_s / options.generations)
        world.delete()
        world = lab.create_world("built_in", SETTING | {"fitness": "rastrigin"}, seed=lap)
        built_in.append(options.generations / timed(lambda: world.run(generations=options.generations).wait())[0])
        world.delete()

print_figures({
    "organisms": options.organisms,
    "generations_per_s": spread(rated),
    "built_in_generations_per_s": spread(built_in),
    "python_ms_per_generation": spread(python_ms),
}, options.json)  # fmt: skip
