"""Plans that find the best organisms of a world in its statistics and its run file. This module does no I/O."""
from __future__ import annotations

import csv
import io
from typing import Mapping

import numpy

from evod.errors import wrong_argument
from evod.generations import Solution
from evod.genes import GeneNames, Genes
from evod.plans import Plan, export, history


def hall_of_fame(
    world: str, names: GeneNames, k: int, first: int | None, last: int | None, island: int | None, minimize: bool
) -> Plan[list[Solution]]:
    """Returns the k best organisms of ended generations, best first; of organisms with equal genes the first one.

    names     of the genes in the solutions
    minimize  whether the fitness in the solutions has the opposite sign
    """
    if isinstance(k, bool) or not isinstance(k, (int, numpy.integer)) or k < 1:
        raise wrong_argument("k", "a whole number, at least 1", k)
    ended = yield from history(world, first, last, island)
    if not ended:
        return []
    if k == 1:  # the statistics name the organism; its genes are in a small table
        rows = [row for generation in ended for row in generation.islands]
        top = max(rows, key=lambda row: row.fitness_best)
        text = yield from export(world, "population", "csv", top.generation, None)
        name = top.island, top.best_organism
        table = csv.DictReader(io.StringIO(text))
        genes = next(row for row in table if (int(row["island"]), int(row["organism"])) == name)
        return [_solution({**genes, "generation": str(top.generation)}, names, top.fitness_best, minimize)]
    text = yield from export(world, "organisms", "csv", None, None)
    numbers = {generation.number for generation in ended}
    wanted = [row for row in csv.DictReader(io.StringIO(text))
              if int(row["generation"]) in numbers and island in (None, int(row["island"])) and row["fitness"]]
    wanted.sort(key=lambda row: -float(row["fitness"]))
    found: dict[tuple[str, ...], Solution] = {}
    for row in wanted:
        found.setdefault(tuple(row[name] for name in names), _solution(row, names, float(row["fitness"]), minimize))
        if len(found) == k:
            break
    return list(found.values())


def _solution(row: Mapping[str, str], names: GeneNames, fitness: float, minimize: bool) -> Solution:
    genes = Genes(numpy.array([names.value(name, row[name]) for name in names], numpy.float32), names)
    return Solution(genes, 0.0 - fitness if minimize else fitness, int(row["generation"]), int(row["island"]),
                    int(row["organism"]))
