"""Reads the tables of a run as pandas DataFrames."""
from __future__ import annotations

import io
from typing import Any

import numpy

from evod.errors import Error

GENE_NAMES = ("normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius")


def pandas() -> Any:
    """Returns the module pandas. Raises Error if pandas is not installed."""
    try:
        import pandas as module
    except ImportError:
        raise Error("tables need the package pandas: install it, python3-pandas on Debian") from None
    return module


def read_csv(text: str) -> Any:
    """Reads a table that evod wrote as CSV.

    Floats are read exactly. Text columns stay text even if they look like numbers. Genes become 32-bit floats.
    """
    kinds: dict[str, Any] = {name: str for name in ("client", "client_key", "kind", "request", "origin", "cause")}
    kinds |= {name: numpy.float32 for name in GENE_NAMES}
    return pandas().read_csv(io.StringIO(text), float_precision="round_trip", dtype=kinds)
