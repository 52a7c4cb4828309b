"""Pictures of islands as numpy arrays.

Whole numbers of 1/16 px travel; these classes show them as px. Arrays that a picture shares with the next ones cannot be
written to.
"""
from __future__ import annotations

import dataclasses
import functools
from typing import Any, Mapping

import numpy
import numpy.typing

from evod.v1 import world_pb2

Array = numpy.typing.NDArray[Any]
Columns = Mapping[str, Array]  # of one kind of entities: whole numbers, rows in the order of the ids

STEPS_PER_PX = 16


class _Entities:
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
        """Names each as long as the generation lasts; rising."""
        ids = self._columns.get("id")
        return numpy.arange(len(self), dtype=numpy.uint32) if ids is None else ids

    @functools.cached_property
    def x_px(self) -> Array:
        """Centres, from the left wall to the right."""
        return self._px("x")

    @functools.cached_property
    def y_px(self) -> Array:
        """Centres, from the upper wall down."""
        return self._px("y")


class Items(_Entities):
    """Food or poison that is there."""


class Organisms(_Entities):
    """The living."""

    @functools.cached_property
    def radius_px(self) -> Array:
        return self._px("radius")

    @functools.cached_property
    def health(self) -> Array:
        """To 1/16, at most 4095.9."""
        return self._px("health")


class Boxes(_Entities):
    """Crates or obstacles; an id is an index among the island's."""

    @functools.cached_property
    def half_width_px(self) -> Array:
        return self._px("half_width")

    @functools.cached_property
    def half_height_px(self) -> Array:
        return self._px("half_height")


@dataclasses.dataclass(frozen=True, eq=False)
class Tile:
    """A square of an island, as closely as it is shown. What `detail` does not tell is None."""

    index: int
    detail: int  #: evod.v1's Detail
    left_px: float
    top_px: float
    side_px: int
    counts: Mapping[str, int]  #: by kind: "organisms", "food", "poison", "crates", "obstacles"
    dots: Mapping[str, Array] | None = None  #: DETAIL_DOTS: by kind, shape (2, count): x and y in px, to 1/256 of the side
    density: Mapping[str, Array] | None = None  #: DETAIL_DENSITY: by kind, shape (cells, cells): how many, by row and column


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Snapshot:
    """A picture of one island after `tick`.

    >>> import evod
    >>> with evod.local(seed=1) as lab:
    ...     snapshot = lab.world().snapshot()
    >>> snapshot
    <snapshot of default: island 0, generation 1, tick 0, 50 organisms>
    >>> snapshot.organisms.x_px.shape, float(snapshot.width_px)
    ((50,), 1280.0)
    """

    world: str
    run_id: str
    island: int
    island_count: int
    tick: int  #: since the run began
    generation: int
    generation_tick: int  #: since the generation began
    simulated_s: float
    state: int  #: evod.v1's RunState
    state_hash: str  #: of the whole world
    width_px: float
    height_px: float
    item_radius_px: float
    live: world_pb2.LiveStatistics
    ticks_per_s: float
    slowed: bool
    sequence: int  #: names this picture among all that the server has made
    dropped_count: int  #: pictures that newer ones replaced before they were sent
    organisms: Organisms
    food: Items
    poison: Items
    crates: Boxes
    obstacles: Boxes
    tiles: tuple[Tile, ...] = ()  #: of a view; entities are then those of the tiles at DETAIL_FULL

    def plot(self, ax: Any = None) -> Any:
        """Draws it with matplotlib, into new axes or those that are given; returns them."""
        from evod import plotting

        return plotting.plot_snapshot(self, ax)

    def __repr__(self) -> str:
        return (
            f"<snapshot of {self.world}: island {self.island}, generation {self.generation}, tick {self.tick}, "
            f"{len(self.organisms)} organisms>"
        )
