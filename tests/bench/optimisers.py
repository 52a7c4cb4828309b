"""evod and DEAP as optimisers of ten functions, with the same budget, operators and rates.

    optimisers.py EVOD PACKAGE [--seeds N] [--only NAME …] [--json]

Both keep the best of 100 organisms, draw the parents of the others by tournaments of 3, and cross nine of ten pairs:

    reals        simulated binary crossover (index 15), polynomial mutation (index 20) of one gene in n
    bits         uniform crossover, one bit in n flips
    tour         order crossover, inversion of a part of three tours in ten
    mixed        uniform crossover, one gene in n takes a Gaussian step of a tenth of its range, or another choice

200 generations are 20,000 evaluations. Both call the same NumPy function with a whole generation. The lower the better.

Prints medians over the seeds, the p-value of the two-sided Mann–Whitney test with Holm's adjustment for the number of
functions, seconds per run, and their ratio, evod to DEAP: the runs of both alternate in one process. evod's seconds
include its server and the record of the run. Without --json it ends with status 1 if evod is worse at alpha 0.01, or
needs more than half of the time.
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

ORGANISMS, GENERATIONS, TOURNAMENT, CROSSOVER, INVERSION = 100, 200, 3, 0.9, 0.3
SPREAD, MUTATION_SPREAD, STEP = 15, 20, 0.1
ALPHA, TIME_RATIO_MAX = 0.01, 0.5
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
    return -(x @ VALUES) + 10.0 * numpy.maximum(x @ WEIGHTS - WEIGHTS.sum() // 2, 0)


def tour(x):
    stops = CITIES[x.astype(int)]
    return numpy.linalg.norm(stops - numpy.roll(stops, 1, axis=1), axis=2).sum(axis=1)


def mixed(x):
    """A real number, a rate, a count, one of five materials, and a switch that makes the materials matter."""
    length, rate, count, material, cooled = x.T
    waves = 2 * (1 - numpy.cos(3 * (length - 1.7)))
    return ((length - 1.7) ** 2 + waves + (numpy.log10(rate) + 2.5) ** 2 + ((count - 11) / 4) ** 2
            + COSTS[material.astype(int)] * (1 + cooled) + 3 * (1 - cooled))


COSTS = numpy.array([0.8, 0.0, 1.5, 0.4, 2.0])


class Reals:
    def __init__(self, function, bound):
        self.function, self.count, self.low, self.high = function, 20, -bound, bound
        self.setting = {"free_genes": self.count, "free_gene_min": self.low, "free_gene_max": self.high,
                        "crossover": "simulated_binary", "crossover_spread_index": SPREAD, "creep": "polynomial",
                        "mutation_spread_index": MUTATION_SPREAD, "mutation_chance": 1 / self.count}

    def founder(self):
        return [random.uniform(self.low, self.high) for _ in range(self.count)]

    def cross(self, first, second):
        tools.cxSimulatedBinaryBounded(first, second, SPREAD, self.low, self.high)

    def mutate(self, genes):
        tools.mutPolynomialBounded(genes, MUTATION_SPREAD, self.low, self.high, 1 / self.count)


class Bits:
    def __init__(self, function, count):
        self.function, self.count = function, count
        self.setting = {"free_genes": [evod.genes.Choice(f"bit{i}", (0, 1)) for i in range(count)],
                        "mutation_chance": 1 / count}

    def founder(self):
        return [random.randrange(2) for _ in range(self.count)]

    def cross(self, first, second):
        tools.cxUniform(first, second, 0.5)

    def mutate(self, genes):
        tools.mutFlipBit(genes, 1 / self.count)


class Tour:
    function, setting = staticmethod(tour), {"free_genes": [evod.genes.Permutation("stop", len(CITIES))],
                                             "mutation_chance": 0, "rearranging": "inversion",
                                             "rearrange_chance": INVERSION}

    def founder(self):
        return random.sample(range(len(CITIES)), len(CITIES))

    def cross(self, first, second):
        tools.cxOrdered(first, second)

    def mutate(self, genes):
        if random.random() < INVERSION:
            first, last = sorted(random.sample(range(len(genes)), 2))
            genes[first:last + 1] = genes[first:last + 1][::-1]


class Mixed:
    function = staticmethod(mixed)
    setting = {"free_genes": [evod.genes.Real("length", -5, 5), evod.genes.Real("rate", 1e-4, 1, scale="logarithmic"),
                              evod.genes.Integer("count", 1, 32), evod.genes.Choice("material", "abcde"),
                              evod.genes.Choice("cooled", (0, 1))],
               "creep": "gaussian", "free_mutation_step": STEP, "mutation_chance": 1 / 5}  # fmt: skip

    def founder(self):
        return [random.uniform(-5, 5), 10 ** random.uniform(-4, 0), random.randint(1, 32), random.randrange(5),
                random.randrange(2)]

    def cross(self, first, second):
        tools.cxUniform(first, second, 0.5)

    def mutate(self, genes):
        length, rate, count, material, cooled = (random.random() < 1 / 5 for _ in range(5))
        if length:
            genes[0] = min(max(random.gauss(genes[0], STEP * 10), -5), 5)
        if rate:
            genes[1] = 10 ** min(max(random.gauss(math.log10(genes[1]), STEP * 4), -4), 0)
        if count:
            step = random.gauss(0, STEP * 31)
            genes[2] = min(max(genes[2] + (round(step) or math.copysign(1, step)), 1), 32)
        if material:
            genes[3] = (genes[3] + random.randint(1, 4)) % 5
        if cooled:
            genes[4] = 1 - genes[4]


PROBLEMS = {
    "sphere": Reals(lambda x: (x**2).sum(axis=1), 5.12),
    "Rosenbrock": Reals(rosenbrock, 2.048),
    "Rastrigin": Reals(rastrigin, 5.12),
    "Ackley": Reals(ackley, 32.768),
    "Schwefel": Reals(schwefel, 500),
    "Griewank": Reals(griewank, 600),
    "OneMax": Bits(lambda x: x.shape[1] - x.sum(axis=1), 200),
    "knapsack": Bits(knapsack, 50),
    "tour": Tour(),
    "mixed": Mixed(),
}


def with_evod(lab, name, seed):
    problem = PROBLEMS[name]
    setting = {"fitness": "external", "external_bodies": False, "population_size": ORGANISMS, "mutate_group": "free",
               "population_model": "generational", "selection": "tournament", "tournament_size": TOURNAMENT,
               "elite_count": 1, "crossover": "uniform", "crossover_chance": CROSSOVER, **problem.setting}
    world = lab.create_world("run", setting, seed=seed)
    found = world.evaluate(lambda genes, life: problem.function(numpy.asarray(genes, float)), GENERATIONS,
                           minimize=True)
    world.delete()
    return found.best().fitness


class Individual(list):
    """A chromosome of DEAP; its tournaments compare `fitness`."""


def with_deap(name, seed):
    problem = PROBLEMS[name]
    random.seed(seed)

    def rated(population):
        for individual, cost in zip(population, problem.function(numpy.array(population, float))):
            individual.fitness = -cost
        return population

    population = rated([Individual(problem.founder()) for _ in range(ORGANISMS)])
    for _ in range(GENERATIONS - 1):
        elite = tools.selBest(population, 1)[0]
        children = [Individual(parent) for parent in tools.selTournament(population, ORGANISMS, TOURNAMENT)]
        for first, second in zip(children[::2], children[1::2]):
            if random.random() < CROSSOVER:
                problem.cross(first, second)
        for child in children[:-1]:
            problem.mutate(child)
        population = rated([Individual(elite), *children[:-1]])
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


rows, best = [], []
with evod.local(program=options.evod) as lab:
    for name in options.only or PROBLEMS:
        runs = [(timed(with_evod, lab, name, seed), timed(with_deap, name, seed))
                for seed in range(1, options.seeds + 1)]
        (ours, our_s), (theirs, their_s) = (zip(*found) for found in zip(*runs))
        best.append((ours, theirs))
        rows.append({"function": name, "evod": statistics.median(ours), "deap": statistics.median(theirs),
                     "evod_s": statistics.median(our_s), "deap_s": statistics.median(their_s),
                     "time_ratio": statistics.median(one / other for one, other in zip(our_s, their_s))})
for row, p in zip(rows, holm([mann_whitney_p(*both) for both in best])):
    row["adjusted_p"] = p
if options.json:
    print(json.dumps(rows))
    sys.exit()
print(f"{'function':12}{'evod':>12}{'DEAP':>12}{'adjusted p':>12}{'evod s':>9}{'DEAP s':>9}{'ratio':>8}")
line = "{function:12}{evod:12.4g}{deap:12.4g}{adjusted_p:12.2g}{evod_s:9.2f}{deap_s:9.2f}{time_ratio:8.2f}"
for row in rows:
    print(line.format(**row))
failures = [f"{row['function']}: evod is worse" for row in rows
            if row["adjusted_p"] < ALPHA and row["evod"] > row["deap"]]
failures += [f"{row['function']}: evod takes {row['time_ratio']:.2f} of the time of DEAP" for row in rows
             if row["time_ratio"] > TIME_RATIO_MAX]
sys.exit("\n".join(failures) if failures else 0)
