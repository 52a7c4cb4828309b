"""Plots of islands and runs. Every function draws into the given matplotlib axes, or into new axes, and returns the
axes.

matplotlib is imported on first use, because the rest of the package works without it.
"""
from __future__ import annotations

import base64
import io
from typing import Any, Callable, Mapping, Protocol, Sequence

import numpy
import numpy.typing

from evod.errors import FailedPrecondition, InvalidArgument, MissingPackage
from evod.genes import ACCOUNT_PARTS

Array = numpy.typing.NDArray[Any]

_FOOD, _POISON, _WALL, _CRATE = "#2e8b57", "#b03060", "#555555", "#b8865b"
_HEALTH_SHOWN = 150.0  # the health at the end of the colour scale


def pyplot() -> Any:
    """Returns the module matplotlib.pyplot. Raises MissingPackage if matplotlib is not installed."""
    try:
        from matplotlib import pyplot as module
    except ImportError:
        raise MissingPackage("plots need the package matplotlib: install it, python3-matplotlib on Debian") from None
    return module


def _axes(ax: Any, **options: Any) -> Any:
    return ax if ax is not None else pyplot().subplots(**options)[1]


# ---- an island
# ----------------------------------------------------------------------------------------------------------


class _Items(Protocol):
    def __len__(self) -> int: ...
    @property
    def x_px(self) -> Array: ...
    @property
    def y_px(self) -> Array: ...


class _Organisms(_Items, Protocol):
    @property
    def radius_px(self) -> Array: ...
    @property
    def health(self) -> Array: ...


class _Boxes(_Items, Protocol):
    @property
    def half_width_px(self) -> Array: ...
    @property
    def half_height_px(self) -> Array: ...


class Island(Protocol):
    """The fields of Snapshot that are plotted. evod.snapshots imports this module, so this module cannot import
    Snapshot."""

    @property
    def world(self) -> str: ...
    @property
    def generation(self) -> int: ...
    @property
    def simulated_s(self) -> float: ...
    @property
    def width_px(self) -> float: ...
    @property
    def height_px(self) -> float: ...
    @property
    def item_radius_px(self) -> float: ...
    @property
    def organisms(self) -> _Organisms: ...
    @property
    def food(self) -> _Items: ...
    @property
    def poison(self) -> _Items: ...
    @property
    def crates(self) -> _Boxes: ...
    @property
    def obstacles(self) -> _Boxes: ...


class IslandPlot:
    """A plot of an island, true to scale, which later snapshots can update. The colour of an organism shows its
    health."""

    def __init__(self, snapshot: Island, ax: Any = None) -> None:
        width = 8.0
        self.axes = ax = _axes(ax, figsize=(width, width * snapshot.height_px / snapshot.width_px + 0.5))
        ax.set(xlim=(0, snapshot.width_px), ylim=(snapshot.height_px, 0), aspect="equal", xticks=[], yticks=[])
        self._obstacles = _boxes(ax, _WALL)
        self._crates = _boxes(ax, _CRATE)
        self._food = _discs(ax, color=_FOOD)
        self._poison = _discs(ax, color=_POISON)
        self._organisms = _discs(ax, cmap="cividis", clim=(0, _HEALTH_SHOWN), edgecolor="black", linewidth=0.4)
        self.artists = (self._obstacles, self._crates, self._food, self._poison, self._organisms)
        self.update(snapshot)

    def update(self, snapshot: Island) -> None:
        """Draws another snapshot of the same island."""
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
            f"{snapshot.world}, generation {snapshot.generation}, {len(organisms)} alive, {snapshot.simulated_s:.0f} s",
                            fontsize=10
        )


def plot_island(snapshot: Island, ax: Any = None) -> Any:
    """Plots a snapshot."""
    return IslandPlot(snapshot, ax).axes


def animate(snapshots: Sequence[Island], interval_ms: float) -> Any:
    """Returns a matplotlib animation of the snapshots. Notebooks can play it."""
    if not snapshots:
        raise InvalidArgument("there are no snapshots to animate")
    from matplotlib import animation

    plot = IslandPlot(snapshots[0])
    figure = plot.axes.figure

    def draw(snapshot: Island) -> Any:
        plot.update(snapshot)
        return plot.artists

    class Animation(animation.FuncAnimation):  # type: ignore[misc]
        def _repr_html_(self) -> str:
            return str(self.to_jshtml())

    animated = Animation(figure, draw, frames=list(snapshots), interval=interval_ms, init_func=lambda: plot.artists)
    pyplot().close(figure)  # otherwise notebooks also show the first frame as an image
    return animated


def _discs(ax: Any, **options: Any) -> Any:
    from matplotlib.collections import EllipseCollection

    clim = options.pop("clim", None)
    discs = EllipseCollection([], [], [], units="xy", offsets=numpy.zeros((0, 2)), offset_transform=ax.transData,
                              **options)
    if clim is not None:
        discs.set_clim(*clim)
    return ax.add_collection(discs)


def _place(discs: Any, x: Array, y: Array, radius: Array) -> None:
    discs.set_offsets(numpy.stack((x, y), axis=1))
    # EllipseCollection has no function to set sizes. These attributes contain half of the widths and heights.
    discs._widths, discs._heights, discs._angles = radius, radius, numpy.zeros(len(radius))


def _boxes(ax: Any, color: str) -> Any:
    from matplotlib.collections import PolyCollection

    return ax.add_collection(PolyCollection([], facecolor=color))


# ---- a run
# --------------------------------------------------------------------------------------------------------------


def plot_fitness(columns: Mapping[str, Any], ax: Any = None) -> Any:
    """Plots the best and the mean fitness over all islands. A band around the mean shows one standard deviation."""
    ax = _axes(ax)
    is_minimized = bool(numpy.any(numpy.asarray(columns["fitness_best"]) < numpy.asarray(columns["fitness_mean"])))
    generation, best = _by_generation(columns, "fitness_best", numpy.minimum if is_minimized else numpy.maximum)
    _, mean, deviation = _spread(columns, "fitness")
    ax.fill_between(generation, mean - deviation, mean + deviation, alpha=0.2, linewidth=0)
    ax.plot(generation, mean, label="mean")
    ax.plot(generation, best, label="best")
    ax.set(xlabel="generation", ylabel="fitness")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.legend(frameon=False)
    return ax


GENES_PLOTTED_MAX = 12


def plot_genes(columns: Mapping[str, Any], gene_names: Sequence[str], ax: Any = None) -> Any:
    """Plots the mean of each gene over all islands. A band around the mean shows one standard deviation.

    Of more than 12 genes, it plots the 12 whose means changed most, in units of their first standard deviation.
    """
    ax = _axes(ax)
    curves = {gene: _spread(columns, gene) for gene in gene_names}
    if len(curves) > GENES_PLOTTED_MAX:
        changes = {gene: float(abs(mean[-1] - mean[0]) / (deviation[0] or 1)) for gene,
                   (_, mean, deviation) in curves.items()}
        most_changed = sorted(curves, key=lambda gene: -changes[gene])[:GENES_PLOTTED_MAX]
        curves = {gene: curves[gene] for gene in most_changed}
    for gene, (generation, mean, deviation) in curves.items():
        (line,) = ax.plot(generation, mean, label=gene)
        ax.fill_between(generation, mean - deviation, mean + deviation, alpha=0.12, linewidth=0, color=line.get_color())
    ax.set(xlabel="generation", ylabel="gene")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.legend(frameon=False, fontsize="small", ncols=2)
    return ax


def plot_selection(columns: Mapping[str, Any], gene_names: Sequence[str], gene: str, ax: Any = None) -> Any:
    """Plots how selection, transmission and migration changed the mean of a gene in each generation, and the total
    change."""
    if gene not in gene_names:
        raise InvalidArgument(f"gene: got {gene!r}, allowed {', '.join(gene_names)}")
    ax = _axes(ax)
    ax.axhline(0, color="0.7", linewidth=0.8)
    for part in ACCOUNT_PARTS:
        moved, count = (numpy.asarray(columns[name], float) for name in (f"{gene}_{part}", "organism_count"))
        weighted = {"generation": columns["generation"], "moved": moved * count, "count": count}
        generation, total = _by_generation(weighted, "moved", numpy.add)
        _, organisms = _by_generation(weighted, "count", numpy.add)
        style = {"color": "black", "linestyle": "--"} if part == "change" else {}
        ax.plot(generation, total / organisms, label=part, **style)
    ax.set(xlabel="generation", ylabel=f"{gene}: gene units per generation")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.legend(frameon=False, fontsize="small", ncols=2)
    return ax


def plot_lineage(lineage: Any, ax: Any = None) -> Any:
    """Plots the family tree of the last generation in a table from RunFile.lineage(), with generations from top to
    bottom.

    Organisms without a descendant in the last generation are left out. Lines lead to first parents, which gave a child
    at least half of its genes; these lines never cross. If the last generation in the table is a single organism, thin
    lines lead to the second parents of its ancestors. Otherwise the axis begins shortly before the lines meet in one
    organism, the common ancestor. Points are coloured by fitness; grey: not known yet.
    """
    ax = _axes(ax, figsize=(8, 6))
    import matplotlib
    from matplotlib.collections import LineCollection

    rows, parents = _family_tree(lineage)
    both = len(rows[0]) == 1
    x = _positions(rows, parents)
    children: dict[_Name, int] = {}
    first_lines: list[list[tuple[float, float]]] = []
    second_lines: list[list[tuple[float, float]]] = []
    for organism in (organism for row in rows for organism in row):
        for number, parent in enumerate(parents[organism]):
            begin, end = (x[parent], parent[0]), (x[organism], organism[0])
            lines = second_lines if number else first_lines
            lines.append([begin, end] if both else [begin, (x[organism], parent[0]), end])
            children[parent] = children.get(parent, 0) + 1
    ax.add_collection(LineCollection(second_lines, colors="0.8", linewidths=0.6, zorder=1))
    ax.add_collection(LineCollection(first_lines, colors="0.4", linewidths=1.2, zorder=2))
    fitness = dict(zip(_names(lineage), lineage["fitness"]))
    shown = [organism for row in rows for organism in row if both or row is rows[0] or children.get(organism, 0) > 1]
    points = ax.scatter([x[organism] for organism in shown], [organism[0] for organism in shown],
                        c=[fitness[organism] for organism in shown], s=14, zorder=3, plotnonfinite=True,
                        cmap=matplotlib.colormaps["viridis"].with_extremes(bad="0.6"))  # fmt: skip
    ax.figure.colorbar(points, ax=ax, label="fitness")
    last, top = rows[0][0][0], rows[-1][0][0]
    if meeting := [row[0] for row in rows if len(row) == 1 and not both]:
        common = meeting[0]
        ax.scatter([x[common]], [common[0]], s=90, facecolors="none", edgecolors="black", zorder=4,
                   label=f"common ancestor: organism {common[2]} of generation {common[0]}")  # fmt: skip
        ax.legend(frameon=False, loc="upper right")
        top = max(top, common[0] - max(2, (last - common[0]) // 4))
    ax.set(ylabel="generation", xticks=[], ylim=(last + 0.5, top - 0.5))
    ax.yaxis.get_major_locator().set_params(integer=True)
    return ax


def plot_front(objectives: Array, generation: int, ax: Any) -> Any:
    """Plots the second objective of a front over the first."""
    ax = _axes(ax)
    ax.scatter(objectives[:, 0], objectives[:, 1], s=16)
    ax.set(xlabel="objective 1", ylabel="objective 2", title=f"front of generation {generation}")
    return ax


#: generation, island and id of an organism
_Name = tuple[int, int, int]


def _names(table: Any, column: str = "organism", island: str = "island", generation: str = "generation") -> list[_Name]:
    return list(zip(*(table[name].fillna(-1).astype(int) for name in (generation, island, column))))


def _family_tree(lineage: Any) -> tuple[list[list[_Name]], dict[_Name, list[_Name]]]:
    """Returns the rows of the tree from the last generation to the first, and the parents of each organism in the tree.

    If the last generation has several organisms, only first parents are in the tree.
    """
    known, last = _names(lineage), lineage["generation"].max()
    first, second = (
        _names(lineage, f"parent_{which}", f"parent_{which}_island", f"parent_{which}_generation")
        for which in ("first", "second")
    )
    rows = [[name for name in known if name[0] == last]]
    both = len(rows[0]) == 1
    parents_of = {
        name: list(dict.fromkeys((one, other) if both else (one,))) for name, one, other in zip(known, first, second)
    }
    parents: dict[_Name, list[_Name]] = {}
    while rows[-1]:
        for name in rows[-1]:
            parents[name] = [parent for parent in parents_of[name] if parent in parents_of]
        rows.append(list(dict.fromkeys(parent for name in rows[-1] for parent in parents[name])))
    return rows[:-1], parents


def _positions(rows: list[list[_Name]], parents: dict[_Name, list[_Name]]) -> dict[_Name, float]:
    """Orders the rows so that lines of first parents do not cross, and returns the position of each organism."""
    x: dict[_Name, float] = {}
    for row in reversed(rows):
        row.sort(key=lambda name: ([x[parent] for parent in parents[name]], name))
        x.update((name, i - (len(row) - 1) / 2) for i, name in enumerate(row))
    if len(rows[0]) > 1:  # every parent is above the middle of its children
        for row in rows:
            spans: dict[_Name, list[float]] = {}
            for name in row:
                for parent in parents[name]:
                    spans.setdefault(parent, []).append(x[name])
            x.update((parent, (min(span) + max(span)) / 2) for parent, span in spans.items())
    return x


# ---- a sweep
# ------------------------------------------------------------------------------------------------------------


def plot_sweep(totals: Any, parameters: Sequence[str], measure: str, ax: Any = None) -> Any:
    """Plots a measure of a sweep of one or two parameters. `totals` is Sweep.totals.

    One parameter: a curve over the generations for each value, the mean of the replicates with a band of one standard
    error. Two: the mean of the replicates in their last generations, as a heat map, or as points if the values are not
    a grid.
    """
    if len(parameters) not in (1, 2):
        swept = f"{len(parameters)} swept parameters: {', '.join(parameters)}"
        raise FailedPrecondition(f"plot: got {swept}, allowed one or two: plot sweep.totals with functions of yours")
    ax = _axes(ax)
    if len(parameters) == 1:
        for value, rows in totals.groupby(parameters[0], sort=False):
            replicates = rows.groupby("generation")[measure]
            mean, error = replicates.mean(), replicates.sem().fillna(0)
            (line,) = ax.plot(mean.index, mean, label=str(value))
            ax.fill_between(mean.index, mean - error, mean + error, alpha=0.2, linewidth=0, color=line.get_color())
        ax.set(xlabel="generation", ylabel=measure)
        ax.xaxis.get_major_locator().set_params(integer=True)
        ax.legend(frameon=False, title=parameters[0])
        return ax
    down, across = parameters
    newest = totals.groupby(["cell", "replicate"]).generation.transform("max")
    last = totals[totals.generation == newest].groupby([down, across], sort=False)[measure].mean()
    grid = last.unstack()
    if grid.isna().any(axis=None) and all(numpy.issubdtype(values.dtype, numpy.number)
                                          for values in (grid.index, grid.columns)):
        shown = ax.scatter(last.index.get_level_values(1), last.index.get_level_values(0), c=last, cmap="viridis")
    else:
        shown = ax.imshow(grid, cmap="viridis", aspect="auto", origin="lower")
        ax.set_xticks(range(grid.shape[1]), [_label(value) for value in grid.columns])
        ax.set_yticks(range(grid.shape[0]), [_label(value) for value in grid.index])
    ax.set(xlabel=across, ylabel=down)
    ax.figure.colorbar(shown, ax=ax, label=f"{measure} in the last generation")
    return ax


def _label(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def image_html(plot: Callable[[], Any]) -> str:
    """Returns the figure that a function draws, as HTML for notebooks; empty without matplotlib, or if there is nothing
    to draw."""
    try:
        figure = plot().figure
    except (MissingPackage, FailedPrecondition):
        return ""
    png = io.BytesIO()
    figure.savefig(png, format="png", bbox_inches="tight")
    pyplot().close(figure)  # otherwise notebooks show it twice
    return f'<img alt="" src="data:image/png;base64,{base64.b64encode(png.getvalue()).decode()}">'


def _by_generation(columns: Mapping[str, Any], name: str, over: Any) -> tuple[Array, Array]:
    generation, first = numpy.unique(numpy.asarray(columns["generation"]), return_index=True)
    if not len(generation):
        raise FailedPrecondition("no generation has ended yet")
    return generation, over.reduceat(numpy.asarray(columns[name], float), first)


def _spread(columns: Mapping[str, Any], name: str) -> tuple[Array, Array, Array]:
    """Returns arrays of generation numbers, means and standard deviations. They combine the organisms of all
    islands."""
    count = numpy.asarray(columns["organism_count"], float)
    mean, deviation = (numpy.asarray(columns[f"{name}_{what}"], float) for what in ("mean", "deviation"))
    sums = {"count": count, "sum": count * mean, "square": count * (deviation**2 + mean**2)}
    generation, organisms = _by_generation({**sums, "generation": columns["generation"]}, "count", numpy.add)
    _, total = _by_generation({**sums, "generation": columns["generation"]}, "sum", numpy.add)
    _, square = _by_generation({**sums, "generation": columns["generation"]}, "square", numpy.add)
    together = total / organisms
    return generation, together, numpy.sqrt(numpy.maximum(square / organisms - together**2, 0))
