"""The results of a comparison, and their computation for worlds that a function rates."""
from __future__ import annotations

import dataclasses
import functools
from typing import Any, Mapping, Sequence

from evod.paired_tests import hedges_g, holm, interval, sign_flip_p
from evod.tables import fitness_text, html_table, pandas, read_csv


@dataclasses.dataclass(frozen=True)
class ComparedWorld:
    """A world of a comparison."""

    name: str
    first: float  #: mean fitness of the first generation
    last: float  #: mean fitness of the last generation
    rise: float  #: last - first
    rise_low: float  #: 95 % confidence interval of the rise
    rise_high: float
    extinct: int  #: generations in which all organisms died
    changes: str  #: the parameters in which it differs from the first world: "selection=random"


@dataclasses.dataclass(frozen=True)
class Difference:
    """The rise of the first world minus the rise of another one, seed by seed."""

    other: str
    difference: float
    low: float  #: 95 % confidence interval of the difference
    high: float
    g: float | None  #: effect size, Hedges' g; None if the differences do not vary
    p: float  #: p-value of the sign-flip permutation test
    adjusted: float  #: p with Holm's adjustment for the number of differences


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """The results of a comparison, returned by `evod.compare`."""

    worlds: tuple[ComparedWorld, ...]  #: the first world, then its controls or the other worlds
    differences: tuple[Difference, ...]  #: of the first world to each other world
    verdict: str  #: the conclusions in sentences
    report: str  #: everything that `evod compare` prints
    csv: str  #: the fitness of every run and generation

    @functools.cached_property
    def fitness(self) -> Any:
        """A DataFrame with the fitness of every run and generation.

        Its columns are arm (name of the world), replicate, seed, generation, fitness_mean, fitness_best, organism_count
        and alive_count.
        """
        return read_csv(self.csv)

    def to_pandas(self) -> Any:
        """Returns `worlds` and `differences` as one DataFrame with one row per world; the index is its name."""
        frame = pandas().DataFrame([vars(world) for world in self.worlds]).set_index("name")
        columns = [field.name for field in dataclasses.fields(Difference)]
        differences = pandas().DataFrame([vars(d) for d in self.differences], columns=columns)
        return frame.join(differences.astype({"g": float}).set_index("other"))

    def __str__(self) -> str:
        return self.report

    def __repr__(self) -> str:
        return f"<comparison of {', '.join(world.name for world in self.worlds)}: {self.verdict}>"

    def _repr_html_(self) -> str:
        heading = [field.name for field in dataclasses.fields(Difference)]
        return html_table(heading, (vars(d).values() for d in self.differences), self.verdict)  # type: ignore[misc]


def comparison_of(csv: str, printed: Mapping[str, Any], seeds: Sequence[int], generations: int) -> Comparison:
    """Compares the worlds of a table of fitness, the first with each of the others, as `evod compare` does.

    printed  what `evod compare --json` has printed for worlds with the same names and changes
    """
    table = read_csv(csv)
    mean = table.pivot_table(index=["arm", "replicate"], columns="generation", values="fitness_mean", sort=False)
    # A termination criterion may end a run before the last generation.
    ends = mean.ffill(axis=1).iloc[:, [0, -1]].to_numpy()
    extinct = table.alive_count.eq(0).groupby(table.arm).sum()
    worlds, rises = [], []
    for number, world in enumerate(printed["worlds"]):
        first, last = ends[number * len(seeds) : (number + 1) * len(seeds)].T
        rises.append(last - first)
        low, high = interval(last - first)
        dead = int(extinct[world["name"]]) if table.alive_count.any() else 0
        worlds.append(ComparedWorld(world["name"], float(first.mean()), float(last.mean()),
                                    float((last - first).mean()), low, high, dead, world["changes"]))
    p = [sign_flip_p(rises[0] - other, int(printed["seed"])) for other in rises[1:]]
    differences = []
    for world, other, chance, adjusted in zip(worlds[1:], rises[1:], p, holm(p)):
        low, high = interval(rises[0] - other)
        differences.append(Difference(world.name, float((rises[0] - other).mean()), low, high,
                                      hedges_g(rises[0] - other), chance, adjusted))
    verdict = " ".join(
        f"The rise of {worlds[0].name} minus that of {d.other} is {fitness_text(d.difference)} (adjusted p = "
        f"{d.adjusted:.2g})." for d in differences)
    lines = [f"{len(seeds)} replicates of {generations} generations, from seed {printed['seed']}", ""]
    lines += [f"{w.name}: mean fitness {fitness_text(w.first)} to {fitness_text(w.last)}, rise {fitness_text(w.rise)}"
              f" ({fitness_text(w.rise_low)} to {fitness_text(w.rise_high)})" for w in worlds]
    return Comparison(tuple(worlds), tuple(differences), verdict, "\n".join([*lines, "", verdict, ""]), csv)
