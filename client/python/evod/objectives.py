"""Several objectives: the front of a population, and the hypervolume of a front."""
from __future__ import annotations

import dataclasses
from typing import Any

import numpy
import numpy.typing

from evod import plotting
from evod.errors import wrong_argument
from evod.genes import Genes
from evod.tables import fitness_text, html_table, pandas

Array = numpy.typing.NDArray[Any]


def nondominated(objectives: numpy.typing.ArrayLike, *, minimize: bool = False) -> numpy.typing.NDArray[numpy.bool_]:
    """Returns which rows are dominated by no other row: a mask of shape (count,).

    A row dominates another if it is worse in no objective and better in at least one.

    Parameters
    ----------
    objectives
        Shape (count, objectives).
    minimize
        Less is better in all objectives.

    Examples
    --------
    >>> import evod
    >>> evod.nondominated([[1, 4], [2, 2], [1, 3], [4, 1]])
    array([ True,  True, False,  True])
    """
    rows = _rows(objectives, minimize)
    mask = numpy.ones(len(rows), bool)
    for i, row in enumerate(rows):
        mask[i] = not ((rows >= row).all(axis=1) & (rows > row).any(axis=1)).any()
    return mask


def hypervolume(
    objectives: numpy.typing.ArrayLike, reference: numpy.typing.ArrayLike, *, minimize: bool = False
) -> float:
    """Returns the hypervolume of a set: the area, or volume, that its rows dominate and that dominates the reference.

    Parameters
    ----------
    objectives
        Shape (count, objectives). Rows that do not dominate the reference add nothing.
    reference
        A point that is worse than the rows: shape (objectives,).
    minimize
        Less is better in all objectives.

    Notes
    -----
    Zitzler & Thiele 1999, IEEE Trans. Evol. Comput. 3(4), doi:10.1109/4235.797969. The time is O(n log n) for two
    objectives, and grows with a further factor n for each other one.

    Examples
    --------
    >>> import evod
    >>> evod.hypervolume([[1, 3], [2, 2], [3, 1]], reference=[4, 4], minimize=True)
    6.0
    """
    rows = _rows(objectives, minimize)
    point = numpy.asarray(reference, float) * (-1 if minimize else 1)
    if point.shape != rows.shape[1:]:
        raise wrong_argument("reference", f"{rows.shape[1]} numbers, one for each objective", reference)
    return _volume(rows[(rows > point).all(axis=1)] - point)


def _volume(rows: Array) -> float:
    """The volume between 0 and rows of positive numbers; larger is better."""
    if not len(rows):
        return 0.0
    if rows.shape[1] == 1:
        return float(rows.max())
    rows = rows[numpy.argsort(-rows[:, -1], kind="stable")]
    if rows.shape[1] == 2:
        widths = numpy.diff(numpy.maximum.accumulate(rows[:, 0]), prepend=0.0)
        return float(widths @ rows[:, 1])
    depths = rows[:, -1] - numpy.append(rows[1:, -1], 0.0)
    return sum((float(depth) * _volume(rows[: i + 1, :-1]) for i, depth in enumerate(depths) if depth > 0), 0.0)


def _rows(objectives: numpy.typing.ArrayLike, minimize: bool) -> Array:
    rows = numpy.asarray(objectives, float)
    if rows.ndim != 2 or not rows.shape[1] or numpy.isnan(rows).any():
        raise wrong_argument("objectives", "numbers of the shape (count, objectives)", f"the shape {rows.shape}")
    return -rows if minimize else rows


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Front:
    """The organisms of a generation that no other organism of the generation dominates: `Generation.front`."""

    generation: int
    genes: Genes  #: shape (count, genes)
    objectives: numpy.typing.NDArray[numpy.float64]  #: shape (count, objectives), in the sign of the function
    minimize: bool = False  #: whether less is better

    def __len__(self) -> int:
        return len(self.genes)

    def hypervolume(self, reference: numpy.typing.ArrayLike) -> float:
        """Returns the hypervolume of this front: `evod.hypervolume`."""
        return hypervolume(self.objectives, reference, minimize=self.minimize)

    def to_pandas(self) -> Any:
        """Returns a DataFrame with one row per organism: objective1, objective2, … and the genes."""
        return pandas().DataFrame(self._columns())

    def plot(self, ax: Any = None) -> Any:
        """Plots the second objective over the first with matplotlib; returns the axes."""
        return plotting.plot_front(self.objectives, self.generation, ax)

    def _columns(self) -> dict[str, Any]:
        numbers = {f"objective{i + 1}": column for i, column in enumerate(self.objectives.T)}
        return {**numbers, **self.genes.to_texts()}

    def __repr__(self) -> str:
        return f"<front of {len(self)} organisms in generation {self.generation}>"

    def _repr_html_(self) -> str:
        columns = self._columns()
        rows = [tuple(cell if isinstance(cell, str) else fitness_text(cell) for cell in row)
                for row in zip(*columns.values())]
        return html_table(tuple(columns), rows, repr(self)[1:-1])


def front_of(generation: int, genes: Genes, objectives: Array, minimize: bool) -> Front:
    """The front of a generation."""
    mask = nondominated(objectives, minimize=minimize)
    order = numpy.lexsort(objectives[mask].T[::-1])
    return Front(generation, Genes(genes[mask][order], genes.names or ()), objectives[mask][order], minimize)
