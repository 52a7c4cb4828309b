"""The results of a generation, and the population of the current one."""
from __future__ import annotations

import dataclasses
import inspect
import operator
from typing import Any, Callable, Iterable, Sequence

import numpy
import numpy.typing

from evod import plotting
from evod.conversion import result
from evod.errors import FailedPrecondition
from evod.genes import ACCOUNT_PARTS, GENE_NAMES, Genes
from evod.objectives import Front
from evod.results import ColonyStatistics, GenerationStatistics, GeneStatistics
from evod.tables import fitness_text, html_table, pandas
from evod.v1 import commands_pb2, world_pb2


def account_part(gene: GeneStatistics, part: str) -> float:
    """Returns one of ACCOUNT_PARTS for a gene; nan if there is no selection account for this generation."""
    return numpy.nan if gene.account is None else float(getattr(gene.account, part))


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """An organism and its fitness, returned by `History.best`, `History.hall_of_fame` and `World.best`."""

    genes: Genes  #: shape (genes,): genes["free0"]
    fitness: float
    generation: int
    island: int
    organism: int  #: its id in its generation and on its island

    @property
    def of(self) -> tuple[int, int, int]:
        """Generation, island and id, as ``world.table("lineage", of=solution.of)`` accepts them: the table of its
        ancestors."""
        return self.generation, self.island, self.organism

    def __repr__(self) -> str:
        text = self.genes.text()
        return f"<solution of generation {self.generation}: fitness {fitness_text(self.fitness)}, {text}>"

    def _repr_html_(self) -> str:
        caption = f"fitness {fitness_text(self.fitness)}: organism {self.organism} of generation {self.generation}"
        return html_table(("gene", "value"), self.genes.to_texts().items(), caption)


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Generation:
    """The results of one generation over all islands.

    `best`, `mean` and `worst` are the fitness of the best, the average and the worst organism of the generation. Means
    over islands are weighted by their number of organisms.

    Examples
    --------
    >>> import evod
    >>> with evod.local(seed=42) as lab:
    ...     for g in lab.world().run(generations=2):
    ...         print(g)
    generation 1: best 337.6, mean 71.1, 25 of 50 alive
    generation 2: best 294.4, mean 84.7, 27 of 50 alive
    """

    number: int  #: number of the generation; the first is 1
    islands: tuple[GenerationStatistics, ...]  #: all statistics of each island, in index order
    minimize: bool = False  #: whether less fitness is better: the numbers of a function that World.evaluate minimizes
    evaluation_count: int | None = None  #: organisms that the call of World.evaluate has rated until now; or None
    best_solution: Solution | None = None  #: the best organism that the call of World.evaluate has rated; or None
    front: Front | None = None  #: the best organisms, if the call of World.evaluate rates several objectives; or None

    @property
    def end_tick(self) -> int:
        """The tick at which the generation ended, counted from the beginning of the run."""
        return self.islands[0].end_tick

    @property
    def organism_count(self) -> int:
        """The number of organisms."""
        return sum(island.organism_count for island in self.islands)

    @property
    def alive_count(self) -> int:
        """The number of organisms alive at the end of the generation."""
        return sum(island.alive_count for island in self.islands)

    @property
    def best(self) -> float:
        """The best fitness of all organisms on all islands."""
        return (min if self.minimize else max)(island.fitness_best for island in self.islands)

    @property
    def mean(self) -> float:
        """The mean fitness of all organisms on all islands."""
        return self._mean([island.fitness_mean for island in self.islands])

    @property
    def worst(self) -> float:
        """The worst fitness of all organisms on all islands."""
        return (max if self.minimize else min)(island.fitness_worst for island in self.islands)

    @property
    def diversity(self) -> float:
        """The genetic diversity, 0 to 1: a gene's standard deviation divided by its range, averaged over genes and
        islands."""
        return self._mean([island.diversity for island in self.islands])

    @property
    def genes(self) -> Genes:
        """The mean of each gene, shape (genes,): ``g.genes["body_size"]``."""
        means = numpy.array([[gene.mean for gene in island.genes] for island in self.islands])
        return Genes(numpy.average(means, axis=0, weights=self._weights()), self.islands[0].genes.names)

    @property
    def selection(self) -> Genes:
        """The part of `change` that is due to selection, because some organisms had more descendants than others.

        Shape (genes,), in the units of the genes: ``g.selection["body_size"]``. nan in the first generation, and in
        runs of older versions, which did not record it. selection + transmission + migration = change (docs/MODEL.md).

        Examples
        --------
        >>> import evod
        >>> with evod.local(seed=42) as lab:
        ...     first, second = lab.world().run(generations=2)
        >>> bool(numpy.isnan(first.selection).all())
        True
        >>> numpy.allclose(second.selection + second.transmission + second.migration, second.genes - first.genes)
        True
        """
        return self._mean_part("selection")

    @property
    def transmission(self) -> Genes:
        """The part of `change` that is due to crossover, mutation and the bounds of the genes."""
        return self._mean_part("transmission")

    @property
    def migration(self) -> Genes:
        """The part of `change` that is due to migration between islands."""
        return self._mean_part("migration")

    @property
    def change(self) -> Genes:
        """The mean of each gene minus its mean in the previous generation; shape (genes,), nan in the first
        generation."""
        return self._mean_part("change")

    def _mean_part(self, name: str) -> Genes:
        parts = [[account_part(gene, name) for gene in island.genes] for island in self.islands]
        return Genes(numpy.average(numpy.array(parts), axis=0, weights=self._weights()), self.islands[0].genes.names)

    def _weights(self) -> list[int]:
        return [island.organism_count for island in self.islands]

    def _mean(self, values: Sequence[float]) -> float:
        return float(numpy.average(values, weights=self._weights()))

    def __repr__(self) -> str:
        return f"<{self}>"

    def __str__(self) -> str:
        what = f"{self.alive_count} of {self.organism_count} alive"
        if self.evaluation_count is not None:
            what = f"{self.evaluation_count} evaluations"
        return f"generation {self.number}: best {fitness_text(self.best)}, mean {fitness_text(self.mean)}, {what}"

    def negated(self) -> Generation:
        """The same generation with the opposite sign of every fitness, as the function of World.evaluate returned it if
        it is minimized."""
        islands = tuple(dataclasses.replace(island, **{name: 0.0 - getattr(island, name) for name in _SIGNED})
                        for island in self.islands)
        return dataclasses.replace(self, islands=islands, minimize=not self.minimize)


_SIGNED = ("fitness_best", "fitness_mean", "fitness_median", "fitness_worst")  # deviations have no sign


def generations_of(rows: Iterable[world_pb2.GenerationStatistics], gene_names: Sequence[str]) -> list[Generation]:
    """Combines the rows of each generation into a Generation. The rows must be ordered by generation and island."""
    by_number: dict[int, list[GenerationStatistics]] = {}
    for row in rows:
        by_number.setdefault(row.generation, []).append(result(row, gene_names))
    return [Generation(number, tuple(islands)) for number, islands in by_number.items()]


_ISLAND_COLUMNS = tuple(field.name for field in dataclasses.fields(GenerationStatistics)
                        if field.name not in ("genes", "colony", "predators"))
_COLONY_COLUMNS = tuple(field.name for field in dataclasses.fields(ColonyStatistics))
_MOMENT_COLUMNS = ("generation", "island", "end_tick", "simulated_s")  # those that both species share


def _columns_of(rows: Sequence[GenerationStatistics | None], gene_names: Sequence[str]) -> dict[str, Any]:
    """Returns the statistics of one species as arrays. Numbers that are not there are nan."""

    def column(of: Callable[[Any], Any]) -> Any:
        return numpy.array([numpy.nan if row is None else of(row) for row in rows])

    columns = {name: column(operator.attrgetter(name)) for name in _ISLAND_COLUMNS}
    for gene in gene_names:
        for what in ("mean", "deviation", "min", "max"):
            columns[f"{gene}_{what}"] = column(lambda row: float(getattr(row.genes[gene], what)))
    for gene in gene_names:
        for part in ACCOUNT_PARTS:
            columns[f"{gene}_{part}"] = column(lambda row: account_part(row.genes[gene], part))
    if any(row is not None and row.colony is not None for row in rows):
        for name in _COLONY_COLUMNS:
            columns[name] = column(lambda row: numpy.nan if row.colony is None else getattr(row.colony, name))
    return columns


class History(list[Generation]):
    """Ended generations of a world in order, returned by `World.history`: a list with a table and a plot.

    Examples
    --------
    >>> import evod
    >>> with evod.local(seed=42) as lab:
    ...     world = lab.world()
    ...     world.run(generations=2).wait()
    ...     history = world.history()
    <generation 2: best 294.4, mean 84.7, 27 of 50 alive>
    >>> history
    <history of 2 generations, 1 to 2>
    >>> history.to_pandas()[["generation", "fitness_best", "body_size_mean"]].round(1)
       generation  fitness_best  body_size_mean
    0           1         337.6            98.3
    1           2         294.4           101.4
    """

    #: Returns the k best organisms of these generations, best first; None: they are not known.
    _solutions: Callable[[int], Any] | None = None

    def best(self) -> Solution:
        """Returns the best organism of all these generations, the first one of several: genes, fitness, generation,
        island.

        Raises
        ------
        FailedPrecondition
            No generation has ended. Or evod.aio has returned this history: write ``await world.best()``.

        Examples
        --------
        >>> import evod
        >>> with evod.local(seed=42) as lab:
        ...     world = lab.world()
        ...     world.run(generations=2).wait()
        ...     best = world.history().best()
        <generation 2: best 294.4, mean 84.7, 27 of 50 alive>
        >>> best.generation, round(best.fitness, 1), round(float(best.genes["body_size"]), 1)
        (1, 337.6, 104.6)
        """
        return self.hall_of_fame(1)[0]

    def hall_of_fame(self, k: int = 10) -> list[Solution]:
        """Returns the k best organisms of all these generations, best first. Of organisms with equal genes, it contains
        the first one; the result is shorter if there are fewer than k.

        Histories of `World.evaluate` know up to 100. Others are read from the run file of the world.
        """
        if self._solutions is None:
            raise FailedPrecondition("this history has no organisms: call world.best() or world.hall_of_fame()")
        found = self._solutions(k)
        if inspect.iscoroutine(found):
            found.close()
            raise FailedPrecondition("with evod.aio, write await world.best() or await world.hall_of_fame(k)")
        solutions: list[Solution] = found
        if not solutions:
            raise FailedPrecondition("no generation has ended yet")
        return solutions

    def plot(self, ax: Any = None) -> Any:
        """Plots the best and the mean fitness with matplotlib, with a band of one standard deviation; returns the
        axes."""
        return plotting.plot_fitness(self.columns(), ax)

    @property
    def gene_names(self) -> tuple[str, ...]:
        """The names of the genes."""
        return self[0].islands[0].genes.names if self else GENE_NAMES

    def columns(self) -> dict[str, numpy.typing.NDArray[Any]]:
        """Returns the columns of `to_pandas` as arrays, without pandas."""
        rows = [island for g in self[:] for island in g.islands]
        columns = _columns_of(rows, self.gene_names)
        if any(row.predators for row in rows):
            predators = _columns_of([row.predators for row in rows], self.gene_names)
            columns |= {f"predators_{name}": column for name, column in predators.items()
                        if name not in _MOMENT_COLUMNS}
        if self and self[0].evaluation_count is not None:
            columns["evaluations"] = numpy.array([g.evaluation_count for g in self[:] for _ in g.islands])
        return columns

    def to_pandas(self) -> Any:
        """Returns a DataFrame with one row per generation and island.

        It has the columns of ``world.table("generations")`` and of `RunFile.generations`. In a world with predators,
        their columns have the prefix ``predators_``; the others are about the prey.
        """
        return pandas().DataFrame(self.columns())

    def __repr__(self) -> str:
        which = f", {self[0].number} to {self[-1].number}" if self else ""
        return f"<history of {len(self)} generations{which}>"

    def _repr_html_(self) -> str:
        rows: list[tuple[object, ...]] = [
            (g.number, *map(fitness_text, (g.best, g.mean, g.worst)), g.alive_count, g.organism_count) for g in self[:]
        ]
        if len(rows) > 2 * _ROWS_SHOWN:
            rows[_ROWS_SHOWN:-_ROWS_SHOWN] = [("…",) * len(rows[0])]
        table = html_table(("generation", "best", "mean", "worst", "alive", "organisms"), rows, repr(self)[1:-1])
        return table + plotting.image_html(self.plot)


_ROWS_SHOWN = 10  # at each end of a long history in a notebook


@dataclasses.dataclass(frozen=True, eq=False)
class Life:
    """What the organisms of a generation have achieved until now, as arrays of shape (count,). Without bodies, all are
    0."""

    generation: int
    island: int
    lived_s: numpy.typing.NDArray[numpy.float64]  #: seconds lived
    health: numpy.typing.NDArray[numpy.float32]  #: 0 for dead organisms
    food_eaten: numpy.typing.NDArray[numpy.uint32]
    poison_eaten: numpy.typing.NDArray[numpy.uint32]
    #: Without bodies: False for organisms whose genes World.evaluate has already rated in the generation before, such
    #: as survivors. Otherwise True.
    is_new: numpy.typing.NDArray[numpy.bool_]

    def of(self, rows: numpy.typing.NDArray[numpy.bool_]) -> Life:
        """The life of some of the organisms. `rows` is a mask."""
        columns: dict[str, Any] = {name: value[rows] for name, value in vars(self).items()
                                   if isinstance(value, numpy.ndarray)}
        return dataclasses.replace(self, **columns)

    def __repr__(self) -> str:
        return f"<life of {len(self.lived_s)} organisms in generation {self.generation}>"


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Population:
    """All organisms of the current generation on one island, including dead ones. Row i is the organism with id i."""

    generation: int
    generation_tick: int  #: ticks since the generation began
    genes: Genes  #: shape (count, genes): genes["body_size"] has the shape (count,)
    parents: numpy.typing.NDArray[numpy.uint32]  #: shape (count, 2): ids of the parents; (0, 2) in the first generation
    #: shape (count,): number of the founder of the lineage; (0,) if unknown
    founders: numpy.typing.NDArray[numpy.uint32]
    choices: numpy.typing.NDArray[numpy.uint8]  #: shape (count,): evod.Choice of the next tick; 0: none
    forces: numpy.typing.NDArray[numpy.float32]  #: shape (count, 2): force in the next tick, kg px/s²
    targets: numpy.typing.NDArray[numpy.float32]  #: shape (count, 2): position of the target, px
    life: Life

    def __len__(self) -> int:
        return len(self.genes)

    def __repr__(self) -> str:
        return f"<population of {len(self)} organisms in generation {self.generation}>"

    def to_pandas(self) -> Any:
        """Returns a DataFrame with one row per organism: its id, parents, founder and genes.

        Columns that the server does not know, such as parents in the first generation, are missing.
        """
        columns: dict[str, Any] = {"organism": numpy.arange(len(self))}
        if len(self.parents):
            columns |= {"parent_first": self.parents[:, 0], "parent_second": self.parents[:, 1]}
        if len(self.founders):
            columns["founder"] = self.founders
        return pandas().DataFrame(columns | self.genes.to_texts())


def gene_count_of(part: commands_pb2.Population) -> int | None:
    """The number of genes of the organisms; None if there are no organisms."""
    return len(part.genes) // 4 // part.count if part.count else None


def population_of(parts: Sequence[commands_pb2.Population], island: int, gene_names: Sequence[str]) -> Population:
    """Joins the parts of one population of an island. The parts must be in order."""

    def rows(field: str, kind: str, columns: int) -> Any:
        whole = [
            numpy.frombuffer(getattr(part, field), kind).reshape(columns, -1).T for part in parts
                 if getattr(part, field)
        ]
        return numpy.concatenate(whole) if whole else numpy.zeros((0, columns), kind)

    genes = Genes(rows("genes", "<f4", len(gene_names)), gene_names)

    def lived(field: str, kind: str) -> Any:
        column = rows(field, kind, 1)[:, 0]
        return column if len(column) else numpy.zeros(len(genes), kind)

    return Population(
        generation=parts[-1].generation,
        generation_tick=parts[-1].generation_tick,
        genes=genes,
        parents=rows("parents", "<u4", 2),
        founders=rows("founders", "<u4", 1)[:, 0],
        choices=rows("choices", "<u1", 1)[:, 0],
        forces=rows("forces", "<f4", 2),
        targets=rows("targets", "<f4", 2),
        life=Life(
            generation=parts[-1].generation,
            island=island,
            lived_s=lived("lived_s", "<f8"),
            health=lived("health", "<f4"),
            food_eaten=lived("food_eaten", "<u4"),
            poison_eaten=lived("poison_eaten", "<u4"),
            is_new=numpy.ones(len(genes), bool),
        ),
    )
