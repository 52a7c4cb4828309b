"""Tables of a run as pandas DataFrames."""
from __future__ import annotations

import io
from typing import Any

from evod.errors import Error


def pandas() -> Any:
    try:
        import pandas as module
    except ImportError:
        raise Error("tables need the package pandas: install it, python3-pandas on Debian") from None
    return module


def frame_of(text: str) -> Any:
    """Of CSV as evod writes it."""
    # The parser that reads every digit; a name may be "NA" or a number.
    words = {name: str for name in ("client", "client_key", "kind", "request", "origin", "cause")}
    return pandas().read_csv(io.StringIO(text), float_precision="round_trip", dtype=words)
