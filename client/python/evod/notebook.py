"""Notebooks: whether this program is one, and the page of a server in a frame."""
from __future__ import annotations

import dataclasses
import html
import sys

#: The origins of a Jupyter of this machine: it has any free port.
LOCAL_ORIGINS = ("http://localhost:*", "http://127.0.0.1:*")


def in_notebook() -> bool:
    """Whether this program is the kernel of a notebook."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None


@dataclasses.dataclass(frozen=True)
class PageFrame:
    """A link to the page, returned by `World.show`. Notebooks show the page itself."""

    link: str
    width: int | str  #: px, or a length of CSS
    height: int | str

    def __repr__(self) -> str:
        return self.link

    def _repr_html_(self) -> str:
        link, width, height = (html.escape(str(value)) for value in (self.link, self.width, self.height))
        return (f'<iframe src="{link}" width="{width}" height="{height}" allow="clipboard-write; fullscreen" '
                f'style="border: 0"></iframe>')  # fmt: skip
