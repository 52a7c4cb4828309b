"""Tables as pandas DataFrames, and as HTML for notebooks."""
from __future__ import annotations

import html
import io
from typing import Any, Collection, Iterable, Sequence

import numpy

from evod.errors import MissingPackage


def pandas() -> Any:
    """Returns the module pandas. Raises MissingPackage if pandas is not installed."""
    try:
        import pandas as module
    except ImportError:
        raise MissingPackage("tables need the package pandas: install it, python3-pandas on Debian") from None
    return module


def read_csv(text: str, choices: Collection[str] = (), **options: Any) -> Any:
    """Reads a table that evod wrote as CSV.

    Floats are read exactly. Text columns stay text even if they look like numbers. Genes become 32-bit floats, and
    those in `choices` text. Parents become whole numbers, <NA> for organisms without parents.
    """
    kinds: dict[str, Any] = {name: str for name in ("sender", "kind", "request", "origin", "cause")}
    kinds |= {name: numpy.float32 for name in _genes_in(text) if name not in choices}
    kinds |= {f"parent_{which}{part}": "Int64" for which in ("first", "second")
              for part in ("", "_generation", "_island")}
    chosen = {name: str for name in ("user", "program", "address", *choices)}  # text, also if it is empty or "NA"
    return pandas().read_csv(io.StringIO(text), float_precision="round_trip", dtype=kinds, converters=chosen, **options)


def _genes_in(text: str) -> Sequence[str]:
    """The names of the genes in a table of organisms: they begin after the origin, or after the organism if there is no
    origin, and end with the last column, or before the fitness."""
    columns = text[: text.find("\n")].rstrip("\r").split(",")
    last = "origin" if "origin" in columns else "organism"
    if last not in columns:
        return ()
    genes = columns[columns.index(last) + 1 :]
    return genes[: genes.index("fitness")] if "fitness" in genes else genes


def fitness_text(value: float) -> str:
    """Returns a fitness as text, by the rule of ``fitness_text`` in proto/text/number_text.h.

    >>> [fitness_text(value) for value in (337.62, 12.0, 0.95312, -0.004, 0.0, 1.5e9)]
    ['337.6', '12.0', '0.9531', '-0.004', '0.0', '1.5e+09']
    """
    value += 0.0  # no minus sign for 0
    text = f"{value:.1f}" if value == 0 or 10 <= abs(value) < 1e7 else f"{value:.4g}"
    return text if value == 0 or set(text) & set(".en") else text + ".0"


def html_table(heading: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "") -> str:
    """Returns a table as HTML. Without a heading, the first cell of each row is the heading of the row."""

    def row(cells: Sequence[object], kinds: Sequence[str]) -> str:
        return "<tr>" + "".join(f"<{kind}>{html.escape(str(cell))}</{kind}>" for cell,
                                kind in zip(cells, kinds)) + "</tr>"

    parts = [f"<caption>{html.escape(caption)}</caption>"] if caption else []
    parts += [row(heading, ["th"] * len(heading))] if heading else []
    parts += [row(cells, ["td" if heading else "th", *["td"] * (len(cells) - 1)]) for cells in rows]
    return f"<table>{''.join(parts)}</table>"
