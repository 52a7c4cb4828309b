"""Snapshots: the state of an island at one tick, as numpy arrays.

The server sends positions and sizes as multiples of 1/16 px; these classes convert them to px on first use. Arrays that a
snapshot shares with later ones are read-only.
"""
from __future__ import annotations

import dataclasses
import functools
from typing import Any, Mapping

import numpy
import numpy.typing

from evod import plotting
from evod.v1 import world_pb2

Array = numpy.typing.NDArray[Any]
Columns = Mapping[str, Array]  # of one kind of entities: integers, rows in the order of the ids

STEPS_PER_PX = 16


class _Entities:
    """Entities of one kind: arrays of shape (count,), in the order of the ids."""

    def __init__(self, columns: Columns) -> None:
        self._columns = columns

    def __len__(self) -> int:
        return len(self._columns["x"])

    def __repr__(self) -> str:
        return f"<{len(self)} {type(self).__name__.lower()}>"

    def _px(self, column: str) -> Array:
        px: Array = self._columns[column] / STEPS_PER_PX
        return px

    @functools.cached_property
    def id(self) -> Array:
        """Identifies each entity within the generation; ascending."""
        ids = self._columns.get("id")
        return numpy.arange(len(self), dtype=numpy.uint32) if ids is None else ids

    @functools.cached_property
    def x_px(self) -> Array:
        """Centres: distance from the left wall, px."""
        return self._px("x")

    @functools.cached_property
    def y_px(self) -> Array:
        """Centres: distance from the upper wall, px."""
        return self._px("y")


class Items(_Entities):
    """The food or the poison on the island; arrays of shape (count,)."""


class Organisms(_Entities):
    """The organisms that are alive; arrays of shape (count,)."""

    @functools.cached_property
    def radius_px(self) -> Array:
        """Radii, px."""
        return self._px("radius")

    @functools.cached_property
    def health(self) -> Array:
        """Health, in steps of 1/16, at most 4095.9."""
        return self._px("health")


class Boxes(_Entities):
    """The crates or the obstacles; arrays of shape (count,). An id is an index among those of the island."""

    @functools.cached_property
    def half_width_px(self) -> Array:
        """Half of the widths, px."""
        return self._px("half_width")

    @functools.cached_property
    def half_height_px(self) -> Array:
        """Half of the heights, px."""
        return self._px("half_height")


@dataclasses.dataclass(frozen=True, eq=False)
class Tile:
    """A square of an island at one level of detail."""

    index: int  #: row by row from the upper left
    detail: int  #: evod.v1.Detail
    left_px: float  #: position of the upper left corner
    top_px: float
    side_px: int
    counts: Mapping[str, int]  #: entities by kind: "organisms", "food", "poison", "crates", "obstacles"
    dots: Mapping[str, Array] | None = None  #: at DETAIL_DOTS: by kind, shape (2, count): x and y in px, rounded to 1/256 of the side
    density: Mapping[str, Array] | None = None  #: at DETAIL_DENSITY: by kind, shape (cells, cells): entities per cell, by row and column


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
    run_id: str  #: identifies the run, in hexadecimal
    island: int  #: index of the island
    island_count: int
    tick: int  #: since the run began
    generation: int
    generation_tick: int  #: since the generation began
    simulated_s: float  #: simulated time since the run began
    state: int  #: evod.v1.RunState: evod.RUNNING, evod.PAUSED, …
    state_hash: str  #: of the whole world, in hexadecimal
    width_px: float  #: of the island
    height_px: float
    item_radius_px: float
    live: world_pb2.LiveStatistics  #: statistics of the island at this tick
    ticks_per_s: float  #: measured speed of the world
    slowed: bool  #: the world is slower than its set speed
    sequence: int  #: identifies this snapshot on the server
    dropped_count: int  #: snapshots that newer ones replaced before they were sent
    organisms: Organisms
    food: Items
    poison: Items
    crates: Boxes
    obstacles: Boxes
    tiles: tuple[Tile, ...] = ()  #: with a view: its tiles; the entities are then those of the tiles at DETAIL_FULL

    def plot(self, ax: Any = None) -> Any:
        """Plots the island with matplotlib into the axes given, or into new ones; returns the axes."""
        return plotting.plot_island(self, ax)

    def __repr__(self) -> str:
        return (
            f"<snapshot of {self.world}: island {self.island}, generation {self.generation}, tick {self.tick}, "
            f"{len(self.organisms)} organisms>"
        )
