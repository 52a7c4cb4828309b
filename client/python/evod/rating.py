"""Rates populations with a function of the user, and decides when World.evaluate ends. This module does no I/O.

Threads      one call of World.evaluate owns a Rater. Its methods are called in turn, perhaps on different threads.
"""
from __future__ import annotations

import dataclasses
import math
import time
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy
import numpy.typing

from evod.errors import InvalidArgument, Violation, wrong_argument
from evod.generations import Generation, Life, Population, Solution
from evod.genes import Genes

Array = numpy.typing.NDArray[Any]
Fitness = Callable[[Genes, Life], numpy.typing.ArrayLike]

FITNESS_MAX = 1e100  # the largest absolute value of a fitness
HALL_MAX = 100  # how many of the best solutions a Rater stores


class Rater:
    """A fitness function, with what it has returned until now.

    visible    the genes that the function gets; None: all genes.
    has_bodies whether organisms live on islands; the life of a survivor then differs from generation to generation.
    minimize   whether less is better for the function; evod gets the negative numbers.
    only_new   whether the function gets only organisms whose genes it has not rated in the generation before.
    """

    def __init__(self, function: Fitness, visible: Sequence[str] | None, has_bodies: bool, *, minimize: bool,
                 only_new: bool) -> None:
        if not callable(function):
            raise wrong_argument("function", "a function of genes and life", repr(function))
        if only_new and has_bodies:
            raise wrong_argument("only_new", "False in a world with bodies: survivors live again in each generation",
                                 only_new)
        self._function, self._visible, self._only_new = function, visible, only_new
        self._has_bodies = has_bodies
        self.minimize = minimize
        self.evaluation_count = 0
        self._hall: dict[bytes, _Rated] = {}  # by genes, best first
        self._best: tuple[bytes, _Rated] | None = None  # the best one of the last generation that was rated
        self._names: Sequence[str] = ()  # of the genes
        # The fitness by genes of the generation before and of this one; the islands of a generation are rated in turn.
        self._before: dict[bytes, float] = {}
        self._now: tuple[int, dict[bytes, float]] = (0, {})

    def rate(self, population: Population) -> Array:
        """Calls the function with the organisms of an island, and returns the fitness that evod needs.

        Raises InvalidArgument if the function returns a wrong shape or number, or writes into its arrays.
        """
        if population.generation != self._now[0]:
            self._before, self._now = self._now[1], (population.generation, {})
        genes = genes_of(population, self._visible)
        self._names = genes.names or ()
        keys = numpy.ascontiguousarray(genes).view(f"V{genes.itemsize * genes.shape[1]}").ravel().tolist()
        is_new = numpy.array([self._has_bodies or key not in self._before for key in keys], bool)
        life = dataclasses.replace(population.life, is_new=is_new)
        if self._only_new:
            fitness = numpy.array([self._before.get(key, 0.0) for key in keys])
            if is_new.any():
                ids = numpy.flatnonzero(is_new)
                fitness[is_new] = self._call(Genes(genes[is_new], genes.names or ()), life.of(is_new), ids)
            self.evaluation_count += int(is_new.sum())
        else:
            fitness = self._call(genes, life, numpy.arange(len(keys)))
            self.evaluation_count += len(fitness)
        self._now[1].update(zip(keys, fitness.tolist()))
        self._remember(keys, fitness, life)
        return 0.0 - fitness if self.minimize else fitness

    def completed(self, generation: Generation) -> Generation:
        """Returns an ended generation in the sign of the function, with what this Rater knows about it."""
        in_sign = generation.negated() if self.minimize else generation
        best = None
        if self._best is not None and self._best[1].generation == generation.number:
            best = self._solution(*self._best)
        return dataclasses.replace(in_sign, evaluation_count=self.evaluation_count, best_solution=best)

    def hall_of_fame(self, k: int) -> list[Solution]:
        """Returns the k best solutions until now, best first."""
        if not 1 <= k <= HALL_MAX:
            raise wrong_argument("k", f"1 to {HALL_MAX}; world.hall_of_fame(k) returns more", k)
        return [self._solution(*item) for item in list(self._hall.items())[:k]]

    def _call(self, genes: Genes, life: Life, organisms: Array) -> Array:
        where = f"in generation {life.generation}, island {life.island}"
        for array in (genes, *vars(life).values()):
            if isinstance(array, numpy.ndarray):
                array.flags.writeable = False
        try:
            result = self._function(genes, life)
        except ValueError as error:
            if "read-only" not in str(error):
                raise
            raise wrong_argument(
                "genes", "reading; a function that repairs genes repairs a copy, genes.copy(), and rates the copy",
                "a write", f"the fitness function has written into its arguments {where}: evod stores the genes that "
                "it has drawn, and repaired genes cannot be handed back") from error
        return self._checked(result, organisms, where)

    def _checked(self, result: Any, organisms: Array, where: str) -> Array:
        count = len(organisms)
        allowed = f"an array of {count} numbers, one for each organism"
        message = f"the fitness function has returned a value that is not allowed {where}"
        try:
            fitness = numpy.asarray(result, float)
        except (TypeError, ValueError):
            raise wrong_argument("fitness", allowed, repr(result)[:200], message) from None
        if fitness.shape != (count,):
            if fitness.ndim == 2 and len(fitness) == count:
                allowed += "; of several objectives, return a weighted sum"
            raise wrong_argument("fitness", allowed, f"the shape {fitness.shape}", message)
        wrong = numpy.flatnonzero(~(numpy.abs(fitness) <= FITNESS_MAX))
        if len(wrong):
            worse = "greater" if self.minimize else "less"
            faults = [Violation(f"fitness[{i}]", f"{-FITNESS_MAX:g} to {FITNESS_MAX:g}", str(fitness[i]))
                      for i in wrong[:5]]
            named = ", ".join(str(organisms[i]) for i in wrong[:5]) + (", …" if len(wrong) > 5 else "")
            raise InvalidArgument(
                f"{message}: {len(wrong)} of {count} numbers, of organism {named}. For genes that cannot be rated, "
                f"return a penalty: a number somewhat {worse} than those of all others", faults)
        return fitness

    def _remember(self, keys: Sequence[bytes], fitness: Array, life: Life) -> None:
        costs = fitness if self.minimize else -fitness
        last = next(reversed(self._hall.values())).cost if len(self._hall) >= HALL_MAX else math.inf
        for place, i in enumerate(numpy.argsort(costs, kind="stable")[:HALL_MAX].tolist()):
            found = _Rated(float(costs[i]), float(fitness[i]), life.generation, life.island, i)
            if place == 0 and (self._best is None or self._best[1].generation != life.generation
                               or found.cost < self._best[1].cost):
                self._best = keys[i], found
            if found.cost >= last:
                break
            if keys[i] not in self._hall or found.cost < self._hall[keys[i]].cost:
                self._hall[keys[i]] = found
        self._hall = dict(sorted(self._hall.items(), key=lambda item: item[1].cost)[:HALL_MAX])

    def _solution(self, key: bytes, rated: _Rated) -> Solution:
        genes = Genes(numpy.frombuffer(key, numpy.float32).copy(), self._names)
        return Solution(genes, rated.fitness, rated.generation, rated.island, rated.organism)


class _Rated(NamedTuple):
    """A solution without its genes."""

    cost: float  # less is better
    fitness: float  # as the function returned it
    generation: int
    island: int
    organism: int


def genes_of(population: Population, visible: Sequence[str] | None) -> Genes:
    """The genes of a population that a fitness function gets: a copy."""
    names = population.genes.names or ()
    if visible is None:
        return Genes(numpy.array(population.genes), names)
    columns = [names.index(name) for name in visible]
    return Genes(numpy.array(population.genes)[:, columns], visible)


# ---- the end
# -------------------------------------------------------------------------------------------------------


class EndRules:
    """The criteria that end a call of World.evaluate."""

    def __init__(self, *, target: float | None, stagnation: int | None, seconds: float | None,
                 until: Callable[[Generation], object] | None) -> None:
        if target is not None and not _is_number(target):
            raise wrong_argument("target", "a number", target)
        if stagnation is not None and (not _is_number(stagnation) or stagnation != int(stagnation) or stagnation < 1):
            raise wrong_argument("stagnation", "a whole number of generations, at least 1", stagnation)
        if seconds is not None and (not _is_number(seconds) or seconds <= 0):
            raise wrong_argument("seconds", "a number greater than 0", seconds)
        if until is not None and not callable(until):
            raise wrong_argument("until", "a function of a Generation; target= accepts a fitness", repr(until))
        self._target, self._stagnation, self._seconds, self._until = target, stagnation, seconds, until
        self._began = time.monotonic()
        self._record: Generation | None = None  # the first generation with the best fitness until now

    def reason(self, generation: Generation) -> str:
        """Why the call ends with this generation: the name of an argument; "" if it goes on."""
        sign = -1 if generation.minimize else 1
        if self._record is None or sign * generation.best > sign * self._record.best:
            self._record = generation
        if self._target is not None and sign * generation.best >= sign * self._target:
            return "target"
        if self._stagnation is not None and generation.number - self._record.number >= self._stagnation:
            return "stagnation"
        if self._seconds is not None and time.monotonic() - self._began >= self._seconds:
            return "seconds"
        return "until" if self._until is not None and self._until(generation) else ""


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float, numpy.number)) and not isinstance(value, bool) and math.isfinite(value)


#: Arguments of other optimisers, and what World.evaluate has in their place.
_WORDS: Mapping[str, str] = {
    **dict.fromkeys(("minimise", "minimization", "minimum"), "minimize=True"),
    **dict.fromkeys(("maximize", "maximise"), "nothing: evod maximises, unless minimize=True is given"),
    **dict.fromkeys(("num_generations", "n_generations", "n_gen", "ngen", "max_generations", "iterations", "max_iter",
                     "maxiter", "epochs"), "generations=N"),
    **dict.fromkeys(("callback", "callbacks", "on_gen"), "on_generation=function"),
    **dict.fromkeys(("target_fitness", "goal", "reach"), "target=number"),
    **dict.fromkeys(("patience", "saturate", "n_iter_no_change", "max_no_improvement"), "stagnation=generations"),
    **dict.fromkeys(("timeout", "max_time", "time_limit", "timeout_s"), "seconds=number"),
    **dict.fromkeys(("stop_criteria", "stop", "stopping", "termination", "stop_when"),
                    "until=function, target=, stagnation= or seconds="),
    **dict.fromkeys(("verbose", "disp", "show_progress"), "progress=True"),
    **dict.fromkeys(("fitness_func", "fitness_function", "func", "objective"), "the function as the first argument"),
    **dict.fromkeys(("workers", "n_jobs", "processes", "parallel", "pool"),
                    "a function that uses the cores, such as numpy.array(pool.map(rate_one, genes))"),
    **dict.fromkeys(("bounds", "gene_space", "init_range_low", "init_range_high"),
                    "the parameters free_gene_min and free_gene_max of lab.create_world"),
    **dict.fromkeys(("num_genes", "n_var", "dimensions", "dim"), "the parameter free_genes of lab.create_world"),
    **dict.fromkeys(("pop_size", "population_size", "sol_per_pop"),
                    "the parameter population_size of lab.create_world"),
    **dict.fromkeys(("seed", "random_seed", "random_state"), "seed=N of lab.create_world"),
}  # fmt: skip


def hint_of(name: str) -> str | None:
    """What to write in place of an argument that other optimisers have; None if it is not such an argument."""
    return _WORDS.get(name)


def refuse_unknown(names: Mapping[str, object]) -> None:
    """Raises InvalidArgument for arguments that World.evaluate does not have, with what to write in their place."""
    if names:
        known = "generations, minimize, only_new, target, stagnation, seconds, until, on_generation or progress"
        raise InvalidArgument("World.evaluate has no such argument",
                              [Violation(name, hint_of(name) or known, repr(value)) for name, value in names.items()])
