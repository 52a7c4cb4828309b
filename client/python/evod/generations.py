"""What one generation came to."""
from __future__ import annotations

import dataclasses
from typing import Any, Sequence

import numpy
import numpy.typing

from evod.v1 import commands_pb2, world_pb2


ACCOUNT_PARTS = ("selection", "transmission", "migration", "change")


def account_part(gene: world_pb2.GeneStatistics, part: str) -> float:
    """One of ACCOUNT_PARTS; nan where there is no account."""
    return float(getattr(gene.account, part)) if gene.HasField("account") else numpy.nan


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Generation:
    """What one generation came to on all islands together.

    >>> import evod
    >>> with evod.local(seed=42) as lab:
    ...     for g in lab.world().run(generations=2):
    ...         print(g)
    generation 1: best 337.6, mean 71.1, 25 of 50 alive
    generation 2: best 294.4, mean 84.7, 27 of 50 alive
    """

    number: int  #: 1 for the first
    islands: tuple[world_pb2.GenerationStatistics, ...]  #: the same of each island, and more

    @property
    def end_tick(self) -> int:
        """Ticks since the run began, when it had ended."""
        return self.islands[0].end_tick

    @property
    def organism_count(self) -> int:
        return sum(island.organism_count for island in self.islands)

    @property
    def alive_count(self) -> int:
        """Alive at the end."""
        return sum(island.alive_count for island in self.islands)

    @property
    def best(self) -> float:
        """The greatest fitness."""
        return max(island.fitness_best for island in self.islands)

    @property
    def mean(self) -> float:
        """The mean fitness."""
        return self._mean([island.fitness_mean for island in self.islands])

    @property
    def worst(self) -> float:
        return min(island.fitness_worst for island in self.islands)

    @property
    def diversity(self) -> float:
        """Mean over genes of the deviation divided by the width of the gene's bounds; mean over islands."""
        return self._mean([island.diversity for island in self.islands])

    @property
    def genes(self) -> numpy.typing.NDArray[Any]:
        """The mean of each gene, in the order of WorldInfo.gene_names."""
        means = numpy.array([[gene.mean for gene in island.genes] for island in self.islands])
        return numpy.asarray(numpy.average(means, axis=0, weights=self._weights()))

    @property
    def selection(self) -> numpy.typing.NDArray[Any]:
        """How far selection moved the mean of each gene since the generation before: those with other genes than the mean
        had more descendants, or fewer. Gene units, in the order of WorldInfo.gene_names; nan in the first generation, and
        where nobody knows. With transmission and migration it is the change.

        >>> import evod
        >>> with evod.local(seed=42) as lab:
        ...     first, second = lab.world().run(generations=2)
        >>> bool(numpy.isnan(first.selection).all())
        True
        >>> numpy.allclose(second.selection + second.transmission + second.migration, second.genes - first.genes)
        True
        """
        return self._moved("selection")

    @property
    def transmission(self) -> numpy.typing.NDArray[Any]:
        """How far it moved because descendants are not as their parents: crossover, mutation, bounds."""
        return self._moved("transmission")

    @property
    def migration(self) -> numpy.typing.NDArray[Any]:
        """How far migrants moved it."""
        return self._moved("migration")

    @property
    def change(self) -> numpy.typing.NDArray[Any]:
        """How far the mean of each gene is from that of the generation before."""
        return self._moved("change")

    def _moved(self, by: str) -> numpy.typing.NDArray[Any]:
        parts = [[account_part(gene, by) for gene in island.genes] for island in self.islands]
        return numpy.asarray(numpy.average(numpy.array(parts), axis=0, weights=self._weights()))

    def _weights(self) -> list[int]:
        return [island.organism_count for island in self.islands]

    def _mean(self, values: Sequence[float]) -> float:
        return float(numpy.average(values, weights=self._weights()))

    def __repr__(self) -> str:
        return f"<{self}>"

    def __str__(self) -> str:
        return (
            f"generation {self.number}: best {self.best:.1f}, mean {self.mean:.1f}, "
            f"{self.alive_count} of {self.organism_count} alive"
        )


def generations_of(rows: Sequence[world_pb2.GenerationStatistics]) -> list[Generation]:
    """Rows ordered by generation and island."""
    by_number: dict[int, list[world_pb2.GenerationStatistics]] = {}
    for row in rows:
        by_number.setdefault(row.generation, []).append(row)
    return [Generation(number, tuple(islands)) for number, islands in by_number.items()]


@dataclasses.dataclass(frozen=True, eq=False)
class Population:
    """The organisms of the generation that runs on one island, alive and dead; row i is the organism with the id i."""

    generation: int
    generation_tick: int
    genes: numpy.typing.NDArray[numpy.float32]  #: shape (count, 6), in the order of WorldInfo.gene_names
    parents: numpy.typing.NDArray[numpy.uint32]  #: shape (count, 2): ids in the generation before; (0, 2) in the first
    founders: numpy.typing.NDArray[numpy.uint32]  #: shape (count), or (0) where nobody knows
    choices: numpy.typing.NDArray[numpy.uint8]  #: shape (count): evod.v1's Choice, what each is about to do
    forces: numpy.typing.NDArray[numpy.float32]  #: shape (count, 2): what it is about to push with, kg px/s2
    targets: numpy.typing.NDArray[numpy.float32]  #: shape (count, 2): px

    def __len__(self) -> int:
        return len(self.genes)


def population_of(parts: Sequence[commands_pb2.Population]) -> Population:
    """Parts of one population, one after another."""

    def rows(field: str, kind: str, columns: int) -> Any:
        whole = [
            numpy.frombuffer(getattr(part, field), kind).reshape(columns, -1).T for part in parts if getattr(part, field)
        ]
        return numpy.concatenate(whole) if whole else numpy.zeros((0, columns), kind)

    gene_count = max((len(part.genes) // 4 // part.count for part in parts if part.count), default=6)
    return Population(
        generation=parts[-1].generation,
        generation_tick=parts[-1].generation_tick,
        genes=rows("genes", "<f4", gene_count),
        parents=rows("parents", "<u4", 2),
        founders=rows("founders", "<u4", 1)[:, 0],
        choices=rows("choices", "<u1", 1)[:, 0],
        forces=rows("forces", "<f4", 2),
        targets=rows("targets", "<f4", 2),
    )
