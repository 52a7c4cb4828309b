"""Snapshots: the state of an island at one tick, as numpy arrays.

The server sends positions and sizes as multiples of 1/16 px. These classes convert them to px on first use. Arrays that
several snapshots share are read-only.
"""
from __future__ import annotations

import dataclasses
import functools
from typing import Any, Generic, Iterator, Mapping, NamedTuple, TypeVar, overload

import numpy
import numpy.typing

from evod import plotting
from evod.errors import FailedPrecondition
from evod.genes import Genes
from evod.results import Detail, LiveStatistics, RunState
from evod.tables import html_table, pandas

Array = numpy.typing.NDArray[Any]
Columns = Mapping[str, Array]  # the fields of one kind of entity: integers, in the order of the ids

STEPS_PER_PX = 16
HEADING_STEPS = 256  # of a full turn


class Item(NamedTuple):
    """One food or poison item."""

    id: int
    x_px: float
    y_px: float


class Organism(NamedTuple):
    """One living organism in a snapshot."""

    id: int
    x_px: float
    y_px: float
    radius_px: float
    health: float


class Box(NamedTuple):
    """One crate or obstacle."""

    id: int
    x_px: float
    y_px: float
    half_width_px: float
    half_height_px: float


One = TypeVar("One", Item, Organism, Box)
Self = TypeVar("Self", bound="_Entities[Any]")


class _Entities(Generic[One]):
    """The entities of one kind, in the order of the ids. All fields are arrays of shape (count,).

    Indexing with a number, or iterating, returns one entity. Indexing with a slice, a mask or an array of indices
    returns the selected entities.
    """

    _one: type[One]

    def __init__(self, columns: Columns) -> None:
        self._columns = columns

    def __len__(self) -> int:
        return len(self._columns["x"])

    @overload
    def __getitem__(self, key: int) -> One: ...
    @overload
    def __getitem__(self: Self, key: slice | Array) -> Self: ...
    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, (int, numpy.integer)):
            return self._one(*(getattr(self, field)[key].item() for field in self._one._fields))
        return self._selected({"id": self.id, **self._columns}, key)

    def _selected(self: Self, columns: Columns, key: Any) -> Self:
        return type(self)({name: column[key] for name, column in columns.items()})

    def __iter__(self) -> Iterator[One]:
        return (self[index] for index in range(len(self)))

    def __repr__(self) -> str:
        return f"<{len(self)} {type(self).__name__.lower()}>"

    def _table(self) -> dict[str, Any]:
        return {field: getattr(self, field) for field in self._one._fields}

    def to_pandas(self) -> Any:
        """Returns a DataFrame with one row per entity and one column per field."""
        return pandas().DataFrame(self._table())

    def _repr_html_(self) -> str:
        table, shown = self._table(), min(len(self), 10)
        rows = ([f"{column[row]:.6g}" for column in table.values()] for row in range(shown))
        more = f", the first {shown}" if shown < len(self) else ""
        return html_table(tuple(table), rows, f"{len(self)} {type(self).__name__.lower()}{more}")

    @functools.cached_property
    def positions(self) -> Array:
        """The centres in px, shape (count, 2): x from the left wall, y from the upper wall."""
        return numpy.stack((self.x_px, self.y_px), axis=1)

    def _px(self, column: str) -> Array:
        px: Array = self._columns[column] / STEPS_PER_PX
        return px

    @functools.cached_property
    def id(self) -> Array:
        """The id of each entity, unique within the generation; in ascending order."""
        ids = self._columns.get("id")
        return numpy.arange(len(self), dtype=numpy.uint32) if ids is None else ids

    @functools.cached_property
    def x_px(self) -> Array:
        """The distance of each centre from the left wall, in px."""
        return self._px("x")

    @functools.cached_property
    def y_px(self) -> Array:
        """The distance of each centre from the upper wall, in px."""
        return self._px("y")


class Items(_Entities[Item]):
    """The food or the poison on the island. All fields are arrays of shape (count,)."""

    _one = Item


class Organisms(_Entities[Organism]):
    """The living organisms. All fields are arrays of shape (count,).

    Examples
    --------
    >>> import evod
    >>> with evod.local(seed=1) as lab:
    ...     organisms = lab.world().snapshot(genes=True).organisms
    >>> organisms.positions.shape, organisms.genes["body_size"].shape, organisms[0].id
    ((50, 2), (50,), 0)
    >>> organisms[organisms.x_px < 640]
    <25 organisms>
    """

    _one = Organism

    def __init__(self, columns: Columns, genes: Genes | None = None, interval_s: float = 0.0) -> None:
        super().__init__(columns)
        self._genes, self._interval_s = genes, interval_s

    def with_genes(self, genes: Genes) -> Organisms:
        """Returns a copy with genes, shape (count, genes)."""
        return Organisms(self._columns, genes, self._interval_s)

    def _selected(self, columns: Columns, key: Any) -> Organisms:
        selected = {name: column[key] for name, column in columns.items()}
        genes = None if self._genes is None else self._genes[numpy.arange(len(self))[key]]
        return Organisms(selected, genes, self._interval_s)

    def _table(self) -> dict[str, Any]:
        genes = {} if self._genes is None else self._genes.to_texts()
        optional = {"heading": self.headings} if "heading" in self._columns else {}
        optional |= {"species": self.species} if "species" in self._columns else {}
        return super()._table() | optional | {"velocity_x_px_s": self.velocities[:, 0],
                                              "velocity_y_px_s": self.velocities[:, 1]} | genes

    @property
    def genes(self) -> Genes:
        """The genes, shape (count, genes): ``organisms.genes["body_size"]``.

        Raises
        ------
        FailedPrecondition
            The snapshot was not requested with ``genes=True``.
        """
        if self._genes is None:
            raise FailedPrecondition("the genes were not requested: call snapshot(genes=True) or snapshots(genes=True)")
        return self._genes

    @functools.cached_property
    def velocities(self) -> Array:
        """The mean velocity of each organism since the previous snapshot of the stream, shape (count, 2), in px/s.

        Computed from the displacements in the stream, which are multiples of 1/16 px. nan if the stream has none: in
        the first snapshot of a world that does not run, and in snapshots with a view.
        """
        if not self._interval_s or "dx" not in self._columns:
            return numpy.full((len(self), 2), numpy.nan)
        return numpy.stack((self._px("dx"), self._px("dy")), axis=1) / self._interval_s

    @functools.cached_property
    def headings(self) -> Array:
        """The direction in which each organism heads: radians, -pi to pi, from +x (right) toward +y (down).

        Multiples of 1/256 of a full turn; ``world.organism()`` has the exact heading of one organism. nan if organisms
        have no heading, that is, unless the parameter ``controller`` of the world is ``network``.
        """
        if "heading" not in self._columns:
            return numpy.full(len(self), numpy.nan)
        headings: Array = self._columns["heading"].astype(numpy.int8) * (2 * numpy.pi / HEADING_STEPS)
        return headings

    @functools.cached_property
    def species(self) -> Array:
        """The species of each organism, a number of ``Species``: 0 for prey, 1 for predators.

        All are 0 in a world without predators.
        """
        return self._columns.get("species", numpy.zeros(len(self), numpy.int32))

    @functools.cached_property
    def radius_px(self) -> Array:
        """The radius of each organism, in px."""
        return self._px("radius")

    @functools.cached_property
    def health(self) -> Array:
        """The health of each organism: a multiple of 1/16, at most 4095.9."""
        return self._px("health")


class Boxes(_Entities[Box]):
    """The crates or the obstacles of an island. All fields are arrays of shape (count,). An id is the index of the
    box."""

    _one = Box

    @functools.cached_property
    def half_width_px(self) -> Array:
        """Half of the width of each box, in px."""
        return self._px("half_width")

    @functools.cached_property
    def half_height_px(self) -> Array:
        """Half of the height of each box, in px."""
        return self._px("half_height")


@dataclasses.dataclass(frozen=True, eq=False)
class Tile:
    """A square of an island at one level of detail."""

    index: int  #: index of the tile, counted row by row from the upper left corner of the island
    detail: Detail
    left_px: float  #: distance from the left wall
    top_px: float
    side_px: int
    counts: Mapping[str, int]  #: number of entities of each kind: "organisms", "food", "poison", "crates", "obstacles"
    #: At Detail.DOTS, the positions by kind of entity: shape (2, count), x and y in px, rounded to 1/256 of the tile's
    #: side.
    dots: Mapping[str, Array] | None = None
    #: At Detail.DENSITY, the number of entities per cell, by kind of entity: shape (cells, cells), indexed by row and
    #: column.
    density: Mapping[str, Array] | None = None


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Snapshot:
    """The state of one island after `tick`.

    Examples
    --------
    >>> import evod
    >>> with evod.local(seed=1) as lab:
    ...     snapshot = lab.world().snapshot()
    >>> snapshot
    <snapshot of default: island 0, generation 1, tick 0, 50 organisms>
    >>> snapshot.organisms.x_px.shape, float(snapshot.width_px)
    ((50,), 1280.0)
    """

    world: str
    run_id: str  #: the id of the run, in hexadecimal
    island: int  #: index of the island
    island_count: int
    tick: int  #: ticks since the run began
    generation: int
    generation_tick: int  #: ticks since the generation began
    simulated_s: float  #: simulated time since the run began
    state: RunState
    state_hash: str  #: the hash of the state of the whole world, in hexadecimal
    width_px: float  #: the width of the island
    height_px: float
    item_radius_px: float
    live: LiveStatistics  #: statistics of the island at this tick
    ticks_per_s: float  #: the measured speed of the world
    slowed: bool  #: whether the world is slower than the requested speed
    sequence: int  #: the number of this snapshot on the server
    dropped_count: int  #: number of snapshots that the server did not send because newer ones replaced them
    organisms: Organisms
    food: Items
    poison: Items
    crates: Boxes
    obstacles: Boxes
    tiles: tuple[Tile, ...] = ()  #: the tiles of the view, if there is one; only tiles at Detail.FULL contain entities

    def plot(self, ax: Any = None) -> Any:
        """Plots the island with matplotlib into the given axes, or into new axes; returns the axes."""
        return plotting.plot_island(self, ax)

    def with_genes(self, genes: Genes) -> Snapshot:
        """Returns a copy whose organisms have genes. Row i of `genes` is the organism with id i."""
        return dataclasses.replace(self, organisms=self.organisms.with_genes(genes[self.organisms.id]))

    def to_pandas(self) -> Any:
        """Returns the organisms as a DataFrame, with the columns tick, generation and island before their fields."""
        table = self.organisms.to_pandas()
        for index, column in enumerate(("tick", "generation", "island")):
            table.insert(index, column, getattr(self, column))
        return table

    def _repr_html_(self) -> str:
        counts = ((kind, len(getattr(self, kind))) for kind in ("organisms", "food", "poison", "crates", "obstacles"))
        moment = ((name, getattr(self, name)) for name in ("world", "island", "generation", "tick", "simulated_s",
                                                           "state"))
        return html_table((), (*moment, *counts), "snapshot")

    def __repr__(self) -> str:
        return (
            f"<snapshot of {self.world}: island {self.island}, generation {self.generation}, tick {self.tick}, "
            f"{len(self.organisms)} organisms>"
        )
