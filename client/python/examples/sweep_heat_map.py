"""Sweeps two parameters and plots the final mean fitness as a heat map.

    sweep_heat_map.py [--generations N] [--seeds N] [--steps N] [--output FILE]
"""
import argparse

import evod

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--generations", type=int, default=30)
parser.add_argument("--seeds", type=int, default=4)
parser.add_argument("--steps", type=int, default=5)
parser.add_argument("--output", default="sweep_heat_map.png")
options = parser.parse_args()

sweep = evod.sweep(
    {"selection": "tournament"},
    grid={"mutation_chance": {"from": 0, "to": 0.4, "steps": options.steps},  # chance that a gene mutates
          "mutation_step": {"from": 5, "to": 25, "steps": options.steps}},  # largest change of a gene
    replicates=options.seeds,
    generations=options.generations,
    seed=1,
)  # fmt: skip
print(sweep.last.groupby(["mutation_chance", "mutation_step"]).fitness_mean.mean().unstack().round(1))
sweep.plot().figure.savefig(options.output)
