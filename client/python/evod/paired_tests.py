"""Tests of paired differences: runs with the same seed in two worlds. The numbers are those of `evod compare`."""
from __future__ import annotations

import itertools
import math
from typing import Any, Sequence

import numpy
import numpy.typing

Array = numpy.typing.NDArray[Any]

EXACT_MAX = 16  # up to this number of differences, all patterns of signs are tried
_DRAWN = 2**EXACT_MAX - 1


def sign_flip_p(differences: Sequence[float] | Array, seed: int = 1) -> float:
    """The two-sided p-value of the sign-flip permutation test: how often the sum is as far from 0 with random signs.

    Up to 16 differences it is exact. Otherwise 65,535 patterns are drawn with the seed.
    """
    values = numpy.asarray(differences, float)
    least = abs(values.sum()) - 1e-12 * numpy.abs(values).sum()
    if len(values) <= EXACT_MAX:
        patterns = list(itertools.product((1.0, -1.0), repeat=len(values) - 1))
        signs = numpy.array(patterns).reshape(len(patterns), len(values) - 1)
        return float((numpy.abs(values[-1] + signs @ values[:-1]) >= least).mean())
    drawn = numpy.random.default_rng(seed).choice((1.0, -1.0), size=(_DRAWN, len(values)))
    return float((1 + (numpy.abs(drawn @ values) >= least).sum()) / (_DRAWN + 1))


def holm(p: Sequence[float]) -> list[float]:
    """Holm's adjustment of p-values for their number."""
    adjusted, largest = [0.0] * len(p), 0.0
    for rank, index in enumerate(sorted(range(len(p)), key=lambda i: p[i])):
        largest = max(largest, min(1.0, p[index] * (len(p) - rank)))
        adjusted[index] = largest
    return adjusted


def interval(sample: Sequence[float] | Array) -> tuple[float, float]:
    """The 95 % confidence interval of the mean by Student's t; (nan, nan) for fewer than two numbers."""
    values = numpy.asarray(sample, float)
    if len(values) < 2:
        return math.nan, math.nan
    half = student_quantile(len(values) - 1) * values.std(ddof=1) / math.sqrt(len(values))
    return float(values.mean() - half), float(values.mean() + half)


def student_quantile(freedom: int) -> float:
    """The 97.5 % quantile of Student's t distribution.

    With t = √freedom tan θ, the density of θ is proportional to cos θ to the power of freedom − 1.

    >>> [round(student_quantile(freedom), 4) for freedom in (1, 2, 9, 19)]
    [12.7062, 4.3027, 2.2622, 2.093]
    """
    angle = numpy.linspace(0, math.pi / 2, 200_001)
    density = numpy.maximum(numpy.cos(angle), 0.0) ** (freedom - 1)
    area = numpy.concatenate([[0.0], numpy.cumsum((density[1:] + density[:-1]) / 2)])
    return math.sqrt(freedom) * math.tan(float(numpy.interp(0.95, area / area[-1], angle)))


def hedges_g(differences: Sequence[float] | Array) -> float | None:
    """The effect size; None if there are fewer than three differences, or they do not vary."""
    values = numpy.asarray(differences, float)
    if len(values) < 3 or (values == values[0]).all():
        return None
    return float(values.mean() / values.std(ddof=1) * (1 - 3 / (4 * (len(values) - 1) - 1)))
