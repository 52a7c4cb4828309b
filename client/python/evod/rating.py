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

from evod.errors import FailedPrecondition, InvalidArgument, Violation, wrong_argument
from evod.generations import Generation, Life, Population, Solution
from evod.genes import Genes
from evod.objectives import front_of

Array = numpy.typing.NDArray[Any]


@dataclasses.dataclass(frozen=True, eq=False)
class Repaired:
    """What a fitness function returns that has repaired chromosomes: they breed in place of those that it got.

    The run file contains them, so the run can be repeated without the function.

    Examples
    --------
    >>> import evod
    >>> def rate(genes, life):
    ...     whole = genes.round()
    ...     return evod.Repaired(whole.sum(axis=1), whole)
    """

    fitness: numpy.typing.ArrayLike  #: as the function returns it otherwise
    genes: numpy.typing.ArrayLike  #: in the shape of the genes that the function got, each within its bounds


Fitness = Callable[[Genes, Life], "numpy.typing.ArrayLike | Repaired"]

FITNESS_MAX = 1e100  # the largest absolute value of a fitness
HALL_MAX = 100  # how many of the best solutions a Rater stores


class Rater:
    """A fitness function, with what it has returned until now.

    has_bodies whether organisms live on islands; the life of a survivor then differs from generation to generation.
    minimize   whether less is better for the function; evod gets the negative numbers.
    only_new   whether the function gets only organisms whose genes it has not rated in the generation before.
    objectives how many numbers the function returns for an organism.
    """

    def __init__(self, function: Fitness, has_bodies: bool, *, minimize: bool, only_new: bool,
                 objectives: int = 1) -> None:
        if not callable(function):
            raise wrong_argument("function", "a function of genes and life", repr(function))
        if only_new and has_bodies:
            raise wrong_argument("only_new", "False in a world with bodies: survivors live again in each generation",
                                 only_new)
        self._function, self._only_new = function, only_new
        self._has_bodies = has_bodies
        self.minimize = minimize
        self._objectives = objectives
        self._parts: list[tuple[Genes, Array]] = []  # of the islands of this generation, for its front
        self.evaluation_count = 0
        self._hall: dict[bytes, _Rated] = {}  # by genes, best first
        self._best: tuple[bytes, _Rated] | None = None  # the best one of the last generation that was rated
        self._names: Sequence[str] = ()  # of the genes
        # The fitness by genes of the generation before and of this one; the islands of a generation are rated in turn.
        self._before: dict[bytes, Any] = {}
        self._now: tuple[int, dict[bytes, Any]] = (0, {})

    def rate(self, population: Population) -> tuple[Array, Array | None]:
        """Calls the function with the organisms of an island. Returns the fitness that evod needs, of shape (count,) or
        (count, objectives), and the chromosomes of all organisms if the function has repaired some.

        Raises InvalidArgument if the function returns a wrong shape or number, or writes into its arrays.
        """
        if population.generation != self._now[0]:
            self._before, self._now, self._parts = self._now[1], (population.generation, {}), []
        genes = population.genes.copy()
        self._names = genes.names or ()
        keys = _keys_of(genes)
        is_new = numpy.array([self._has_bodies or key not in self._before for key in keys], bool)
        life = dataclasses.replace(population.life, is_new=is_new)
        rated = is_new if self._only_new else numpy.ones(len(keys), bool)
        fitness = numpy.zeros((len(keys), self._objectives) if self._objectives > 1 else len(keys))
        for row in numpy.flatnonzero(~rated):
            fitness[row] = self._before[keys[row]]
        repaired = None
        if rated.any():
            shown = Genes(genes[rated], self._names)
            fitness[rated], repaired = self._call(shown, life.of(rated), numpy.flatnonzero(rated))
        self.evaluation_count += int(rated.sum())
        whole = None
        if repaired is not None:
            genes[rated] = repaired
            keys = _keys_of(genes)
            whole = numpy.asarray(genes)
        values: Any = fitness.tolist()  # its type differs between versions of NumPy
        self._now[1].update(zip(keys, values))
        if self._objectives > 1:
            self._parts.append((genes, fitness))
        else:
            self._remember(keys, fitness, life)
        return (0.0 - fitness if self.minimize else fitness), whole

    def completed(self, generation: Generation) -> Generation:
        """Returns an ended generation in the sign of the function, with what this Rater knows about it."""
        in_sign = generation.negated() if self.minimize else generation
        best = front = None
        if self._best is not None and self._best[1].generation == generation.number:
            best = self._solution(*self._best)
        if self._parts and self._now[0] == generation.number:
            genes = Genes(numpy.concatenate([part[0] for part in self._parts]), self._names)
            front = front_of(generation.number, genes, numpy.concatenate([part[1] for part in self._parts]),
                             self.minimize)
        return dataclasses.replace(in_sign, evaluation_count=self.evaluation_count, best_solution=best, front=front)

    def hall_of_fame(self, k: int) -> list[Solution]:
        """Returns the k best solutions until now, best first."""
        if self._objectives > 1:
            raise FailedPrecondition(
                "of several objectives, no single organism is the best: evaluation.front() returns the best ones")
        if not 1 <= k <= HALL_MAX:
            raise wrong_argument("k", f"1 to {HALL_MAX}; world.hall_of_fame(k) returns more", k)
        return [self._solution(*item) for item in list(self._hall.items())[:k]]

    def _call(self, genes: Genes, life: Life, organisms: Array) -> tuple[Array, Array | None]:
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
                "genes", "reading; a function that repairs genes repairs a copy, genes.copy(), and returns "
                "evod.Repaired(fitness, copy)", "a write",
                f"the fitness function has written into its arguments {where}") from error
        if not isinstance(result, Repaired):
            return self._checked(result, organisms, where), None
        repaired = numpy.asarray(result.genes, numpy.float32)
        if repaired.shape != genes.shape:
            raise wrong_argument("Repaired.genes", f"the shape of the genes, {genes.shape}",
                                 f"the shape {repaired.shape}",
                                 f"the fitness function has returned wrong chromosomes {where}")
        return self._checked(result.fitness, organisms, where), repaired

    def _checked(self, result: Any, organisms: Array, where: str) -> Array:
        count = len(organisms)
        shape = (count, self._objectives) if self._objectives > 1 else (count,)
        allowed = f"an array of {count} numbers, one for each organism"
        if self._objectives > 1:
            allowed = f"an array of the shape {shape}: {self._objectives} numbers for each organism (objectives)"
        message = f"the fitness function has returned a value that is not allowed {where}"
        try:
            fitness = numpy.asarray(result, float)
        except (TypeError, ValueError):
            raise wrong_argument("fitness", allowed, repr(result)[:200], message) from None
        if fitness.shape != shape:
            if fitness.shape == (count, 1):
                allowed += ": column [:, 0] of the array"
            elif fitness.ndim == 2 and len(fitness) == count:
                allowed += f". For {fitness.shape[1]} objectives, create the world with objectives={fitness.shape[1]}"
            raise wrong_argument("fitness", allowed, f"the shape {fitness.shape}", message)
        wrong = numpy.flatnonzero(~(numpy.abs(fitness).reshape(count, -1) <= FITNESS_MAX).all(axis=1))
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
        best: Any = numpy.argsort(costs, kind="stable")[:HALL_MAX].tolist()
        for place, i in enumerate(best):
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


def _keys_of(genes: Genes) -> list[bytes]:
    """The bytes of each chromosome."""
    rows: Any = numpy.ascontiguousarray(genes).view(f"V{genes.itemsize * genes.shape[1]}").ravel().tolist()
    keys: list[bytes] = rows
    return keys


class _Rated(NamedTuple):
    """A solution without its genes."""

    cost: float  # less is better
    fitness: float  # as the function returned it
    generation: int
    island: int
    organism: int


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
