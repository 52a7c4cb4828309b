"""DEAP on the function of Rastrigin, with the algorithm that evod_rastrigin.cpp describes; one run as one line of JSON.

The function is DEAP's own, deap.benchmarks.rastrigin, which is evod's with the sign changed.
"""
import argparse
import json
import random
import time

from deap import base, benchmarks, creator, tools

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--population", type=int, default=1000)
parser.add_argument("--generations", type=int, default=100)
parser.add_argument("--seed", type=int, default=1)
options = parser.parse_args()
gene_count, bound = 6, 5.12

creator.create("Fitness", base.Fitness, weights=(-1.0,))
creator.create("Individual", list, fitness=creator.Fitness)
toolbox = base.Toolbox()
toolbox.register("gene", random.uniform, -bound, bound)
toolbox.register("individual", tools.initRepeat, creator.Individual, toolbox.gene, gene_count)
toolbox.register("population", tools.initRepeat, list, toolbox.individual)
toolbox.register("select", tools.selTournament, tournsize=3)
toolbox.register("mate", tools.cxUniform, indpb=0.5)
toolbox.register("mutate", tools.mutGaussian, mu=0, sigma=1, indpb=0.15)
toolbox.register("evaluate", benchmarks.rastrigin)


def evaluate(population):
    for individual in population:
        individual.fitness.values = toolbox.evaluate(individual)


def breed(population):
    children = [toolbox.clone(parent) for parent in toolbox.select(population, len(population) - 1)]
    for first, second in zip(children[::2], children[1::2]):
        toolbox.mate(first, second)
    for child in children:
        toolbox.mutate(child)
        child[:] = [min(max(gene, -bound), bound) for gene in child]
    return [toolbox.clone(tools.selBest(population, 1)[0])] + children


random.seed(options.seed)
began = time.process_time()
population = toolbox.population(options.population)
evaluate(population)
for _ in range(options.generations - 1):
    population = breed(population)
    evaluate(population)
took = time.process_time() - began
best = tools.selBest(population, 1)[0]
print(json.dumps({"program": "deap", "population": options.population, "generations": options.generations,
                  "seed": options.seed, "ms_per_generation": 1e3 * took / options.generations,
                  "fitness_best": -best.fitness.values[0]}))
