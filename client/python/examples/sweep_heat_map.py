"""Sweeps two parameters and plots the final mean fitness as a heat map. The server runs several worlds at the same
time.

    sweep_heat_map.py [--generations N] [--seeds N] [--steps N] [--output FILE]
"""
import argparse

import matplotlib.pyplot as plt
import numpy

import evod

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--generations", type=int, default=30)
parser.add_argument("--seeds", type=int, default=4)
parser.add_argument("--steps", type=int, default=5)
parser.add_argument("--output", default="sweep_heat_map.png")
options = parser.parse_args()

chances = numpy.linspace(0, 0.4, options.steps)  # chance that a gene mutates
sizes = numpy.linspace(5, 25, options.steps)  # largest change of a gene
fitness = numpy.zeros((options.steps, options.steps))

with evod.local() as lab:
    for row, chance in enumerate(chances):
        for column, size in enumerate(sizes):
            parameters = {"mutation_chance": chance, "mutation_step": size, "selection": "tournament"}
            worlds = [lab.create_world(f"seed-{seed}", parameters, seed=seed)
                      for seed in range(1, options.seeds + 1)]
            runs = [world.run(options.generations) for world in worlds]  # starts all worlds
            fitness[row, column] = numpy.mean([run.wait().mean for run in runs])
            for world in worlds:
                world.delete()
        print(f"mutation_chance {chance:.2f}:", " ".join(f"{value:6.1f}" for value in fitness[row]))

plt.pcolormesh(sizes, chances, fitness, cmap="viridis", shading="nearest")
plt.colorbar(label=f"mean fitness in generation {options.generations}")
plt.xlabel("mutation_step")
plt.ylabel("mutation_chance")
plt.savefig(options.output)
