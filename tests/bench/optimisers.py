"""evod and DEAP as optimisers of nine functions, with the same budget, operators and rates.

    optimisers.py EVOD PACKAGE [--seeds N] [--only NAME …] [--json]

Both keep the best of 100 organisms, draw the parents of the others by tournaments of 3, cross nine of ten pairs
uniformly, and mutate one gene in n on average: by a Gaussian step of a twentieth of its range, or, for bits and orders,
by a new random value. An order is that of real genes (random keys), of which three chromosomes in ten exchange two.
200 generations are 20,000 evaluations. Both call the same NumPy function with a whole generation. The lower the better.

Prints medians over the seeds, the p-value of the two-sided Mann–Whitney test with Holm's adjustment for the number of
functions, and seconds per run. evod's seconds include its server and the record of the run.
"""
import argparse
import json
import math
import random
import statistics
import sys
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("package", help="where the Python package is: build/release/python")
parser.add_argument("--seeds", type=int, default=25)
parser.add_argument("--only", nargs="+", metavar="NAME", help="only these functions")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.package)

try:
    from deap import tools
except ImportError:
    sys.exit("optimisers.py: DEAP is not installed, so there is nothing to compare with (Debian: python3-deap)")
import numpy  # noqa: E402

import evod  # noqa: E402
from evod.paired_tests import holm  # noqa: E402

ORGANISMS, GENERATIONS, TOURNAMENT, CROSSOVER, SWAP = 100, 200, 3, 0.9, 0.3
NUMBERS = numpy.random.default_rng(1)
WEIGHTS, VALUES = NUMBERS.integers(10, 100, 50), NUMBERS.integers(10, 100, 50)
CITIES = NUMBERS.random((32, 2))


def rosenbrock(x):
    return (100 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (1 - x[:, :-1]) ** 2).sum(axis=1)


def rastrigin(x):
    return 10 * x.shape[1] + (x**2 - 10 * numpy.cos(2 * numpy.pi * x)).sum(axis=1)


def ackley(x):
    return (20 + math.e - 20 * numpy.exp(-0.2 * numpy.sqrt((x**2).mean(axis=1)))
            - numpy.exp(numpy.cos(2 * numpy.pi * x).mean(axis=1)))


def schwefel(x):
    return 418.9828872724339 * x.shape[1] - (x * numpy.sin(numpy.sqrt(numpy.abs(x)))).sum(axis=1)


def griewank(x):
    return 1 + (x**2).sum(axis=1) / 4000 - numpy.cos(x / numpy.sqrt(numpy.arange(1, x.shape[1] + 1))).prod(axis=1)


def knapsack(x):
    """The negative value; a load above half of all weights costs ten for each unit."""
    taken = x >= 0.5
    return -(taken @ VALUES) + 10.0 * numpy.maximum(taken @ WEIGHTS - WEIGHTS.sum() // 2, 0)


def tour(x):
    stops = CITIES[numpy.argsort(x, axis=1)]
    return numpy.linalg.norm(stops - numpy.roll(stops, 1, axis=1), axis=2).sum(axis=1)


#: The function, the number of genes, their bounds, and whether a mutation is a step.
FUNCTIONS = {
    "sphere": (lambda x: (x**2).sum(axis=1), 20, -5.12, 5.12, True),
    "Rosenbrock": (rosenbrock, 20, -2.048, 2.048, True),
    "Rastrigin": (rastrigin, 20, -5.12, 5.12, True),
    "Ackley": (ackley, 20, -32.768, 32.768, True),
    "Schwefel": (schwefel, 20, -500, 500, True),
    "Griewank": (griewank, 20, -600, 600, True),
    "OneMax": (lambda x: (x < 0.5).sum(axis=1), 200, 0, 1, False),
    "knapsack": (knapsack, 50, 0, 1, False),
    "tour": (tour, 32, 0, 1, False),
}


def with_evod(lab, name, seed):
    function, count, low, high, is_step = FUNCTIONS[name]
    setting = {"fitness": "external", "external_bodies": False, "population_size": ORGANISMS, "free_genes": count,
               "free_gene_min": low, "free_gene_max": high, "mutate_group": "free", "population_model": "generational",
               "selection": "tournament", "tournament_size": TOURNAMENT, "elite_count": 1, "crossover": "uniform",
               "crossover_chance": CROSSOVER, "creep": "gaussian", "free_mutation_step": (high - low) / 20,
               "mutation_chance": 1 / count if is_step else 0, "reset_chance": 0 if is_step else 1 / count,
               "rearranging": "swap" if name == "tour" else "none", "rearrange_chance": SWAP}  # fmt: skip
    world = lab.create_world("run", setting, seed=seed)
    found = world.evaluate(lambda genes, life: function(numpy.asarray(genes, float)), GENERATIONS, minimize=True)
    world.delete()
    return found.best().fitness


class Individual(list):
    """A chromosome of DEAP; its tournaments compare `fitness`."""


def with_deap(name, seed):
    function, count, low, high, is_step = FUNCTIONS[name]
    random.seed(seed)

    def rated(population):
        for individual, cost in zip(population, function(numpy.array(population, float))):
            individual.fitness = -cost
        return population

    def mutated(genes):
        if is_step:
            tools.mutGaussian(genes, 0, (high - low) / 20, 1 / count)
            genes[:] = [min(max(gene, low), high) for gene in genes]
            return
        genes[:] = [random.uniform(low, high) if random.random() < 1 / count else gene for gene in genes]
        if name == "tour" and random.random() < SWAP:
            i, j = random.sample(range(count), 2)
            genes[i], genes[j] = genes[j], genes[i]

    population = rated([Individual(random.uniform(low, high) for _ in range(count)) for _ in range(ORGANISMS)])
    for _ in range(GENERATIONS - 1):
        elite = tools.selBest(population, 1)[0]
        children = [Individual(parent) for parent in tools.selTournament(population, ORGANISMS - 1, TOURNAMENT)]
        for first, second in zip(children[::2], children[1::2]):
            if random.random() < CROSSOVER:
                tools.cxUniform(first, second, 0.5)
        for child in children:
            mutated(child)
        population = rated([Individual(elite), *children])
    return -max(individual.fitness for individual in population)


def mann_whitney_p(one, other):
    """The two-sided p-value by the normal approximation, with corrections for ties and continuity."""
    both = numpy.array([*one, *other])
    _, place, ties = numpy.unique(both, return_inverse=True, return_counts=True)
    ranks = (numpy.cumsum(ties) - (ties - 1) / 2)[place]
    n, m, total = len(one), len(other), len(both)
    u = ranks[:n].sum() - n * (n + 1) / 2
    variance = n * m / 12 * (total + 1 - (ties**3 - ties).sum() / (total * (total - 1)))
    return 1.0 if variance == 0 else math.erfc(max(abs(u - n * m / 2) - 0.5, 0) / math.sqrt(2 * variance))


def timed(call, *words):
    began = time.perf_counter()
    return call(*words), time.perf_counter() - began


names = options.only or list(FUNCTIONS)
found = {}
with evod.local(program=options.evod) as lab:
    for name in names:
        runs = [(timed(with_evod, lab, name, seed), timed(with_deap, name, seed))
                for seed in range(1, options.seeds + 1)]
        found[name] = {program: {"best": [run[index][0] for run in runs],
                                 "seconds": statistics.median(run[index][1] for run in runs)}
                       for index, program in enumerate(("evod", "deap"))}
adjusted = holm([mann_whitney_p(found[name]["evod"]["best"], found[name]["deap"]["best"]) for name in names])
if options.json:
    print(json.dumps({name: {**found[name], "adjusted_p": p} for name, p in zip(names, adjusted)}))
else:
    print(f"{'function':12}{'evod':>12}{'DEAP':>12}{'adjusted p':>12}{'evod s':>9}{'DEAP s':>9}")
    for name, p in zip(names, adjusted):
        evod_, deap = found[name]["evod"], found[name]["deap"]
        medians = "".join(f"{statistics.median(x['best']):12.4g}" for x in (evod_, deap))
        print(f"{name:12}{medians}{p:12.2g}{evod_['seconds']:9.2f}{deap['seconds']:9.2f}")
