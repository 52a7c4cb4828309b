"""Changes a parameter in the middle of a run, and plots fitness and genes before and after the change.

    change_at_generation_20.py [--generations N] [--output FILE]
"""
import argparse

import matplotlib.pyplot as plt

import evod

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--generations", type=int, default=60)
parser.add_argument("--output", default="change_at_generation_20.png")
options = parser.parse_args()

with evod.local(seed=42) as lab:
    world = lab.world()
    world.set(selection="tournament")
    world.run(generations=20).wait()  # after generation 20 the world pauses
    world.set(poison_count=80)  # twice the default, from the next generation on
    for generation in world.run(generations=options.generations - 20):
        print(generation)

    figure, (above, below) = plt.subplots(2, figsize=(8, 9), sharex=True)
    world.plot_fitness(above)
    world.plot_genes(below)
    for axes in (above, below):
        axes.axvline(20.5, color="0.4", linestyle="--", linewidth=1)
    above.set_title("twice as much poison from generation 21 on", fontsize=10)
    figure.savefig(options.output)
