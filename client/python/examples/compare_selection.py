"""Compares the selection methods: plots the mean fitness over several runs for each, with a 95 % confidence band.

    compare_selection.py [--generations N] [--seeds N] [--output FILE]
"""
import argparse

import matplotlib.pyplot as plt
import numpy

import evod

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--generations", type=int, default=40)
parser.add_argument("--seeds", type=int, default=10)
parser.add_argument("--output", default="compare_selection.png")
options = parser.parse_args()

# Half the width of the 95 % confidence interval in standard errors: a quantile of Student's t-distribution, computed
# from its series expansion.
z, runs_less_1 = 1.96, options.seeds - 1
errors = z + (z**3 + z) / (4 * runs_less_1) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * runs_less_1**2)

with evod.local() as lab:
    for method in lab.registry()["selection"].choices:
        runs = []
        for seed in range(1, options.seeds + 1):
            world = lab.create_world("run", {"selection": method}, seed=seed)
            runs.append([generation.mean for generation in world.run(options.generations)])
            world.delete()
        fitness = numpy.array(runs)  # shape (seeds, generations)
        mean, band = fitness.mean(axis=0), errors * fitness.std(axis=0, ddof=1) / numpy.sqrt(options.seeds)
        print(f"{method}: {mean[-1]:.1f} ± {band[-1]:.1f}")
        number = numpy.arange(1, options.generations + 1)
        plt.plot(number, mean, label=method)
        plt.fill_between(number, mean - band, mean + band, alpha=0.2, linewidth=0)

plt.xlabel("generation")
plt.ylabel(f"mean fitness of {options.seeds} runs")
plt.legend(frameon=False)
plt.savefig(options.output)
