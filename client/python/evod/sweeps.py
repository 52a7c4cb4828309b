"""The results of a parameter sweep."""
from __future__ import annotations

import dataclasses
import functools
import os
import pathlib
import re
from typing import Any

import numpy

from evod import plotting
from evod.errors import DamagedData, FileNotFound, wrong_argument
from evod.paired_tests import hedges_g, holm, interval, sign_flip_p
from evod.tables import html_table, pandas, read_csv

_SUMS = ("food_eaten", "poison_eaten")
_SAME = ("end_tick", "simulated_s", "evaluations")  # equal on all islands
_WEIGHTED = ("_mean", "_selection", "_transmission", "_migration", "_change")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """The results of a parameter sweep, returned by `evod.sweep` and `evod.open_sweep`."""

    cell_count: int  #: number of different sets of values
    replicates: int  #: number of runs of each cell
    seed: int  #: the seed of the sweep
    seeds: tuple[int, ...]  #: the seed of each replicate; it is the same in every cell
    parameters: tuple[str, ...]  #: names of the swept parameters
    csv: str  #: the table as text, with comments that state how to repeat the sweep
    minimize: bool = False  #: whether less fitness is better: the numbers of a function that is minimized

    @functools.cached_property
    def runs(self) -> Any:
        """A DataFrame with one row per run, generation and island.

        Its columns are cell, replicate, seed, the swept parameters, and those of ``world.table("generations")``.
        """
        return read_csv(self.csv, comment="#")

    @property
    def last(self) -> Any:
        """The rows of `runs` for the last generation of each run."""
        newest = self.runs.groupby(["cell", "replicate"]).generation.transform("max")
        return self.runs[self.runs.generation == newest]

    @functools.cached_property
    def totals(self) -> Any:
        """A DataFrame with one row per run and generation, for all islands together.

        Means are weighted by the number of organisms, and counts are added. Columns that cannot be computed from those
        of the islands are missing: medians, deviations and the id of the best organism.
        """
        runs = self.runs
        keys = [*self._run_columns, "generation"]
        groups = [runs[key] for key in keys]
        organisms = runs.organism_count.groupby(groups, sort=False).sum()
        made = {}
        for name in runs.columns:
            column = runs[name].groupby(groups, sort=False)
            if name in keys or name == "island":
                continue
            if name in _SUMS or name.endswith("_count"):
                made[name] = column.sum()
            elif name in _SAME or name.endswith("_max") or name == self._extreme("fitness_best", "fitness_worst"):
                made[name] = column.max()
            elif name.endswith("_min") or name == self._extreme("fitness_worst", "fitness_best"):
                made[name] = column.min()
            elif name == "diversity" or name.endswith(_WEIGHTED):
                weighted = (runs[name] * runs.organism_count).groupby(groups, sort=False)
                made[name] = weighted.sum(min_count=1) / organisms
        return pandas().DataFrame(made).reset_index()

    def time_to(self, measure: str, value: float, *, below: bool | None = None) -> Any:
        """Returns when each run first reached a value, over all islands.

        Parameters
        ----------
        measure
            A column of `totals`: "fitness_mean", "diversity", "body_size_mean".
        value
            The value to reach.
        below
            Whether the measure must be at most the value. By default only for the fitness of a function that is
            minimized; otherwise it must be at least the value.

        Returns
        -------
        DataFrame
            One row per run: cell, replicate, seed, the swept parameters, and `generation`; <NA> if it was not reached.

        Examples
        --------
        >>> import evod
        >>> methods = {"selection": ["random", "tournament"]}
        >>> sweep = evod.sweep(grid=methods, replicates=3, seed=1, generations=20)
        >>> sweep.time_to("fitness_mean", 150).groupby("selection").generation.count().to_dict()
        {'random': 0, 'tournament': 3}
        """
        totals = self.totals
        column = totals[self._checked(measure)]
        is_below = (self.minimize and measure.startswith("fitness")) if below is None else below
        reached = totals.generation.where(column <= value if is_below else column >= value)
        keys = [totals[key] for key in self._run_columns]
        return reached.groupby(keys, sort=False).min().astype("Int64").reset_index()

    def paired_test(self, measure: Any = "fitness_mean", by: str | None = None) -> Any:
        """Tests whether a measure differs between the values of a swept parameter: the test of `evod.compare`.

        Runs with the same seed and the same values of the other parameters are a pair. The p-value is that of the
        sign-flip permutation test; `adjusted` is p with Holm's adjustment for the number of rows.

        Parameters
        ----------
        measure
            A column of `totals`, in the last generation of each run; or a table with one row per run and the column
            "generation", as `time_to` returns it.
        by
            The swept parameter. By default the only one.

        Returns
        -------
        DataFrame
            One row for each value of the parameter but the first: the mean difference to the first value, its 95 %
            confidence interval, the effect size g, p, adjusted, and the number of pairs. Pairs with a missing number
            are left out.

        Examples
        --------
        >>> import evod
        >>> methods = {"selection": ["tournament", "random"]}
        >>> sweep = evod.sweep(grid=methods, replicates=6, seed=1, generations=20)
        >>> sweep.paired_test("fitness_mean")[["selection", "p", "pairs"]].values.tolist()
        [['random', 0.03125, 6]]
        """
        if by is None and len(self.parameters) == 1:
            by = self.parameters[0]
        if by not in self.parameters:
            raise wrong_argument("by", ", ".join(self.parameters), by)
        if isinstance(measure, str):
            totals = self.totals
            newest = totals.groupby(["cell", "replicate"]).generation.transform("max")
            table, name = totals[totals.generation == newest], self._checked(measure)
        else:
            table, name = measure, "generation"
        pair = [key for key in ("replicate", *self.parameters) if key != by]
        wide = table.pivot_table(index=pair, columns=by, values=name, aggfunc="first", sort=False).astype(float)
        values = list(dict.fromkeys(self.runs[by]))
        found = []
        for other in values[1:]:
            both = wide.reindex(columns=[values[0], other]).dropna()
            differences = (both[other] - both[values[0]]).to_numpy()
            if not len(differences):
                found.append({by: other, "p": 1.0, "pairs": 0})
                continue
            low, high = interval(differences)
            found.append({by: other, "difference": differences.mean(), "low": low, "high": high,
                          "g": hedges_g(differences), "p": sign_flip_p(differences, self.seed),
                          "pairs": len(differences)})  # fmt: skip
        result = pandas().DataFrame(found, columns=[by, "difference", "low", "high", "g", "p", "pairs"])
        result.insert(6, "adjusted", holm(list(result.p)))
        return result

    def plot(self, measure: str = "fitness_mean", ax: Any = None) -> Any:
        """Plots a column of `totals` with matplotlib, and returns the axes.

        One swept parameter: a curve over the generations for each value, the mean of the replicates with a band of one
        standard error. Two: the mean of the replicates in their last generations, as a heat map, or as points if the
        values are not a grid.
        """
        return plotting.plot_sweep(self.totals, self.parameters, self._checked(measure), ax)

    @property
    def _run_columns(self) -> list[str]:
        return ["cell", "replicate", "seed", *self.parameters]

    def _extreme(self, greatest: str, if_minimized: str) -> str:
        return if_minimized if self.minimize else greatest

    def _checked(self, measure: str) -> str:
        if measure not in self.totals.columns or not numpy.issubdtype(self.totals[measure].dtype, numpy.number):
            known = [name for name in self.totals.columns if name not in self._run_columns]
            raise wrong_argument("measure", ", ".join(known[:12]) + ", …", measure)
        return measure

    def __repr__(self) -> str:
        swept = ", ".join(self.parameters)
        return f"<sweep of {swept}: {self.cell_count} cells of {self.replicates} replicates, seed {self.seed}>"

    def _repr_html_(self) -> str:
        fields = (("parameters", ", ".join(self.parameters)), ("cells", self.cell_count),
                  ("replicates", self.replicates),
                  ("seed", self.seed))  # fmt: skip
        return html_table((), fields, "sweep") + plotting.image_html(self.plot)


def open_sweep(path: str | os.PathLike[str]) -> Sweep:
    """Opens the results of `evod sweep`: its folder, or the runs.csv in it.

    Raises
    ------
    FileNotFound
        There is no such file. `evod sweep` writes it when all runs have finished.
    DamagedData
        The file is not the table of a sweep.
    """
    file = pathlib.Path(path)
    file = file / "runs.csv" if file.is_dir() else file
    try:
        csv = file.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise FileNotFound(f"there is no file {file}") from None
    seed = re.search(r"^# seed: (\d+)$", csv, re.MULTILINE)
    heading = re.search(r"^cell,replicate,seed,(.*?),?generation,", csv, re.MULTILINE)
    if seed is None or heading is None:
        raise DamagedData(f"{file} is not the table of a sweep")
    parameters = tuple(filter(None, heading[1].split(",")))
    seeds: dict[str, str] = dict(re.findall(r"^\d+,(\d+),(\d+),", csv, re.MULTILINE))  # by replicate
    cell_count = len(set(re.findall(r"^(\d+),\d+,\d+,", csv, re.MULTILINE)))
    return Sweep(cell_count, len(seeds), int(seed[1]), tuple(map(int, seeds.values())), parameters, csv)
