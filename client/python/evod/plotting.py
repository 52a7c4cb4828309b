"""Pictures of worlds and runs with matplotlib: every function draws into the axes it is given, or into new ones, and returns
them."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy
import numpy.typing

from evod.errors import Error
from evod.generations import ACCOUNT_PARTS, account_part

if TYPE_CHECKING:
    from evod.generations import Generation
    from evod.snapshots import Snapshot

Array = numpy.typing.NDArray[Any]

_FOOD, _POISON, _WALL, _CRATE = "#2e8b57", "#b03060", "#555555", "#b8865b"
_HEALTH_SHOWN = 150.0  # and more has the last colour


def pyplot() -> Any:
    try:
        from matplotlib import pyplot as module
    except ImportError:
        raise Error("pictures need the package matplotlib: install it, python3-matplotlib on Debian") from None
    return module


def axes_of(ax: Any, **how: Any) -> Any:
    return ax if ax is not None else pyplot().subplots(**how)[1]


# ---- a world ------------------------------------------------------------------------------------------------------------


class WorldPicture:
    """A picture of an island that can be brought up to date: an organism is as large as it is, its colour is its health."""

    def __init__(self, snapshot: Snapshot, ax: Any = None) -> None:
        width = 8.0
        self.axes = ax = axes_of(ax, figsize=(width, width * snapshot.height_px / snapshot.width_px + 0.5))
        ax.set(xlim=(0, snapshot.width_px), ylim=(snapshot.height_px, 0), aspect="equal", xticks=[], yticks=[])
        self._obstacles = _boxes(ax, _WALL)
        self._crates = _boxes(ax, _CRATE)
        self._food = _discs(ax, color=_FOOD)
        self._poison = _discs(ax, color=_POISON)
        self._organisms = _discs(ax, cmap="cividis", clim=(0, _HEALTH_SHOWN), edgecolor="black", linewidth=0.4)
        self.artists = (self._obstacles, self._crates, self._food, self._poison, self._organisms)
        self.show(snapshot)

    def show(self, snapshot: Snapshot) -> None:
        for artist, boxes in ((self._obstacles, snapshot.obstacles), (self._crates, snapshot.crates)):
            x, y, half_width, half_height = boxes.x_px, boxes.y_px, boxes.half_width_px, boxes.half_height_px
            corners = ((x - half_width, y - half_height), (x + half_width, y - half_height),
                       (x + half_width, y + half_height), (x - half_width, y + half_height))  # fmt: skip
            artist.set_verts(numpy.stack([numpy.stack(corner, axis=1) for corner in corners], axis=1))
        for artist, items in ((self._food, snapshot.food), (self._poison, snapshot.poison)):
            _place(artist, items.x_px, items.y_px, numpy.full(len(items), snapshot.item_radius_px))
        organisms = snapshot.organisms
        _place(self._organisms, organisms.x_px, organisms.y_px, organisms.radius_px)
        self._organisms.set_array(organisms.health)
        self.axes.set_title(
            f"{snapshot.world}, generation {snapshot.generation}, {len(organisms)} alive, {snapshot.simulated_s:.0f} s", fontsize=10
        )


def plot_snapshot(snapshot: Snapshot, ax: Any = None) -> Any:
    return WorldPicture(snapshot, ax).axes


def animation_of(snapshots: Sequence[Snapshot], interval_ms: float) -> Any:
    """A matplotlib animation, which notebooks play."""
    if not snapshots:
        raise Error("there are no snapshots to be shown")
    from matplotlib import animation

    picture = WorldPicture(snapshots[0])
    figure = picture.axes.figure

    def show(snapshot: Snapshot) -> Any:
        picture.show(snapshot)
        return picture.artists

    class Shown(animation.FuncAnimation):  # type: ignore[misc]
        def _repr_html_(self) -> str:
            return str(self.to_jshtml())

    made = Shown(figure, show, frames=list(snapshots), interval=interval_ms, init_func=lambda: picture.artists)
    pyplot().close(figure)  # notebooks would show it once more, standing still
    return made


def _discs(ax: Any, **how: Any) -> Any:
    from matplotlib.collections import EllipseCollection

    clim = how.pop("clim", None)
    discs = EllipseCollection([], [], [], units="xy", offsets=numpy.zeros((0, 2)), offset_transform=ax.transData, **how)
    if clim is not None:
        discs.set_clim(*clim)
    return ax.add_collection(discs)


def _place(discs: Any, x: Array, y: Array, radius: Array) -> None:
    discs.set_offsets(numpy.stack((x, y), axis=1))
    # EllipseCollection has no word for another size: it keeps half of the widths and heights.
    discs._widths, discs._heights, discs._angles = radius, radius, numpy.zeros(len(radius))


def _boxes(ax: Any, color: str) -> Any:
    from matplotlib.collections import PolyCollection

    return ax.add_collection(PolyCollection([], facecolor=color))


# ---- a run --------------------------------------------------------------------------------------------------------------


def columns_of(generations: Sequence[Generation], gene_names: Sequence[str]) -> dict[str, Array]:
    """Statistics by the names that tables have, a row for each generation and island."""
    rows = [island for g in generations for island in g.islands]
    columns = {
        name: numpy.array([getattr(row, name) for row in rows], float)
        for name in ("generation", "island", "organism_count", "fitness_best", "fitness_mean", "fitness_deviation")
    }
    for index, gene in enumerate(gene_names):
        for what in ("mean", "deviation", "min", "max"):
            columns[f"{gene}_{what}"] = numpy.array([getattr(row.genes[index], what) for row in rows], float)
        for what in ACCOUNT_PARTS:
            columns[f"{gene}_{what}"] = numpy.array([account_part(row.genes[index], what) for row in rows], float)
    return columns


def plot_fitness(columns: Mapping[str, Any], ax: Any = None) -> Any:
    """The best and the mean fitness of all islands, and how far organisms are from the mean (one standard deviation)."""
    ax = axes_of(ax)
    generation, best = _by_generation(columns, "fitness_best", numpy.maximum)
    _, mean, deviation = _spread(columns, "fitness")
    ax.fill_between(generation, mean - deviation, mean + deviation, alpha=0.2, linewidth=0)
    ax.plot(generation, mean, label="mean")
    ax.plot(generation, best, label="best")
    ax.set(xlabel="generation", ylabel="fitness")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.legend(frameon=False)
    return ax


def plot_genes(columns: Mapping[str, Any], gene_names: Sequence[str], ax: Any = None) -> Any:
    """The mean of every gene and its spread (one standard deviation)."""
    ax = axes_of(ax)
    for gene in gene_names:
        generation, mean, deviation = _spread(columns, gene)
        (line,) = ax.plot(generation, mean, label=gene)
        ax.fill_between(generation, mean - deviation, mean + deviation, alpha=0.12, linewidth=0, color=line.get_color())
    ax.set(xlabel="generation", ylabel="gene")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.legend(frameon=False, fontsize="small", ncols=2)
    return ax


def plot_selection(columns: Mapping[str, Any], gene_names: Sequence[str], gene: str, ax: Any = None) -> Any:
    """What moved the mean of one gene in each generation, over all islands: selection, transmission and migration, which are
    together its change."""
    if gene not in gene_names:
        raise Error(f"there is no gene {gene!r}; allowed: {', '.join(gene_names)}")
    ax = axes_of(ax)
    ax.axhline(0, color="0.7", linewidth=0.8)
    for part in ACCOUNT_PARTS:
        moved, count = (numpy.asarray(columns[name], float) for name in (f"{gene}_{part}", "organism_count"))
        weighted = {"generation": columns["generation"], "moved": moved * count, "count": count}
        generation, total = _by_generation(weighted, "moved", numpy.add)
        _, organisms = _by_generation(weighted, "count", numpy.add)
        how = {"color": "black", "linestyle": "--"} if part == "change" else {}
        ax.plot(generation, total / organisms, label=part, **how)
    ax.set(xlabel="generation", ylabel=f"{gene}: gene units a generation")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.legend(frameon=False, fontsize="small", ncols=2)
    return ax


def plot_lineage(lineage: Any, ax: Any = None) -> Any:
    """Who came of whom, as RunFile.lineage() tells it: a point for each organism, coloured by its fitness, a line to each
    parent. Islands stand beside each other."""
    ax = axes_of(ax, figsize=(8, 6))
    from matplotlib.collections import LineCollection

    width = 1 + int(max(lineage["organism"].max(), lineage["parent_first"].max(), lineage["parent_second"].max()))
    x = lineage["island"] * (width + 1) + lineage["organism"]
    lines = []
    for parent in ("parent_first", "parent_second"):
        has = lineage[parent].notna()
        above = lineage[f"{parent}_island"][has] * (width + 1) + lineage[parent][has]
        begin = numpy.stack((above, lineage[f"{parent}_generation"][has]), axis=1)
        lines.append(numpy.stack((begin, numpy.stack((x[has], lineage["generation"][has]), axis=1)), axis=1))
    ax.add_collection(LineCollection(numpy.concatenate(lines).astype(float), colors="0.6", linewidths=0.6, zorder=1))
    points = ax.scatter(x, lineage["generation"], c=lineage["fitness"], s=14, cmap="viridis", zorder=2)
    ax.figure.colorbar(points, ax=ax, label="fitness")
    ax.set(xlabel="organism" if lineage["island"].max() == 0 else "island and organism", ylabel="generation")
    ax.yaxis.get_major_locator().set_params(integer=True)
    ax.invert_yaxis()
    return ax


def _by_generation(columns: Mapping[str, Any], name: str, over: Any) -> tuple[Array, Array]:
    generation, first = numpy.unique(numpy.asarray(columns["generation"]), return_index=True)
    if not len(generation):
        raise Error("no generation has ended yet")
    return generation, over.reduceat(numpy.asarray(columns[name], float), first)


def _spread(columns: Mapping[str, Any], name: str) -> tuple[Array, Array, Array]:
    """Generations, and of the organisms of all islands together the mean and the standard deviation."""
    count = numpy.asarray(columns["organism_count"], float)
    mean, deviation = (numpy.asarray(columns[f"{name}_{what}"], float) for what in ("mean", "deviation"))
    sums = {"count": count, "sum": count * mean, "square": count * (deviation**2 + mean**2)}
    generation, organisms = _by_generation({**sums, "generation": columns["generation"]}, "count", numpy.add)
    _, total = _by_generation({**sums, "generation": columns["generation"]}, "sum", numpy.add)
    _, square = _by_generation({**sums, "generation": columns["generation"]}, "square", numpy.add)
    together = total / organisms
    return generation, together, numpy.sqrt(numpy.maximum(square / organisms - together**2, 0))
