"""While a world runs, prints the number of living organisms, the distance to their food, and each generation's results.

    watch_a_run.py [HOST:PORT] [--generations N]      without HOST:PORT, starts a private server
"""
import argparse

import numpy

import evod

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("server", nargs="?", help="HOST:PORT of a server that grants the role controller; default: a "
                                              "private server")
parser.add_argument("--generations", type=int, default=3)
options = parser.parse_args()

with evod.connect(options.server) if options.server else evod.local(seed=42, speed=40) as lab:
    world = lab.world()
    run = world.run(generations=options.generations)
    with world.snapshots(rate_hz=5) as snapshots:
        for snapshot in snapshots:
            organisms, food = snapshot.organisms, snapshot.food
            away_px = numpy.hypot(organisms.x_px[:, None] - food.x_px, organisms.y_px[:, None] - food.y_px)
            if away_px.size:
                print(f"generation {snapshot.generation}, {snapshot.generation_tick / 60:4.1f} s: {len(organisms)} "
                      "alive, "
                      f"mean health {organisms.health.mean():5.1f}, food {away_px.min(axis=1).mean():4.0f} px away")
            if snapshot.state != evod.RUNNING:
                break
    for generation in run:
        print(generation)
