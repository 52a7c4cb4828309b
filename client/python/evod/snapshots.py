"""Snapshots: the state of an island at one tick, as numpy arrays.

The server sends positions and sizes as multiples of 1/16 px. These classes convert them to px on first use. Arrays that
several snapshots share are read-only.
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
Columns = Mapping[str, Array]  # the fields of one kind of entity: integers, in the order of the ids

STEPS_PER_PX = 16


class _Entities:
    """The entities of one kind. All fields are arrays of shape (count,), in the order of the ids."""

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


class Items(_Entities):
    """The food or the poison on the island. All fields are arrays of shape (count,)."""


class Organisms(_Entities):
    """The living organisms. All fields are arrays of shape (count,)."""

    @functools.cached_property
    def radius_px(self) -> Array:
        """The radius of each organism, in px."""
        return self._px("radius")

    @functools.cached_property
    def health(self) -> Array:
        """The health of each organism: a multiple of 1/16, at most 4095.9."""
        return self._px("health")


class Boxes(_Entities):
    """The crates or the obstacles of an island. All fields are arrays of shape (count,). An id is the index of the box."""

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
    detail: int  #: level of detail: evod.v1.Detail
    left_px: float  #: distance from the left wall
    top_px: float
    side_px: int
    counts: Mapping[str, int]  #: number of entities of each kind: "organisms", "food", "poison", "crates", "obstacles"
    #: At DETAIL_DOTS, the positions by kind of entity: shape (2, count), x and y in px, rounded to 1/256 of the tile's side.
    dots: Mapping[str, Array] | None = None
    #: At DETAIL_DENSITY, the number of entities per cell, by kind of entity: shape (cells, cells), indexed by row and column.
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
    state: int  #: evod.v1.RunState: evod.RUNNING, evod.PAUSED, …
    state_hash: str  #: the hash of the state of the whole world, in hexadecimal
    width_px: float  #: the width of the island
    height_px: float
    item_radius_px: float
    live: world_pb2.LiveStatistics  #: statistics of the island at this tick
    ticks_per_s: float  #: the measured speed of the world
    slowed: bool  #: whether the world is slower than the requested speed
    sequence: int  #: the number of this snapshot on the server
    dropped_count: int  #: number of snapshots that the server did not send because newer ones replaced them
    organisms: Organisms
    food: Items
    poison: Items
    crates: Boxes
    obstacles: Boxes
    tiles: tuple[Tile, ...] = ()  #: the tiles of the view, if there is one; only tiles at DETAIL_FULL contain entities

    def plot(self, ax: Any = None) -> Any:
        """Plots the island with matplotlib into the given axes, or into new axes; returns the axes."""
        return plotting.plot_island(self, ax)

    def __repr__(self) -> str:
        return (
            f"<snapshot of {self.world}: island {self.island}, generation {self.generation}, tick {self.tick}, "
            f"{len(self.organisms)} organisms>"
        )
