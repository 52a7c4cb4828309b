"""Forks a run at a generation and continues the fork without crossover, to compare it with the original run.

    fork.py [--generations N] [--output FILE]
"""
import argparse

import matplotlib.pyplot as plt

import evod

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--generations", type=int, default=60)
parser.add_argument("--output", default="fork.png")
options = parser.parse_args()
half = options.generations // 2

with evod.local(seed=7) as lab:
    origin = lab.world()
    origin.set(selection="tournament")
    origin.run(options.generations).wait()

    other = origin.fork("without_crossover", at_generation=half)  # has the same organisms, seed and parameters
    other.set(crossover="none")
    other.run(options.generations - half + 1).wait()

    for world in (origin, other):
        history = world.history()
        plt.plot([g.number for g in history], [g.mean for g in history], label=world.name)
    same = [g.mean for g in origin.history(half, half)] == [g.mean for g in other.history(half, half)]
    print(f"generation {half} of both is", "the same" if same else "different")

plt.axvline(half, color="0.4", linestyle="--", linewidth=1)
plt.xlabel("generation")
plt.ylabel("mean fitness")
plt.legend(frameon=False)
plt.savefig(options.output)
