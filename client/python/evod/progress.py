"""Progress bars, with the package tqdm if it is installed, and lines of progress."""
from __future__ import annotations

import contextlib
import sys
import time
from typing import Callable, Iterator

from evod.errors import MissingPackage
from evod.generations import Generation
from evod.notebook import in_notebook


@contextlib.contextmanager
def progress_bar(what: str, total: float | None, shown: bool | None) -> Iterator[Callable[[float], None] | None]:
    """Shows a progress bar. The value is a function that sets how much is done; None if no bar is shown.

    total  None: how much there is to do is not known.
    shown  None: a bar is shown if tqdm is installed and the output is a terminal or a notebook.
    """
    if shown is False:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        if shown:
            raise MissingPackage("progress bars need the package tqdm: install it, python3-tqdm on Debian") from None
        yield None
        return
    form = None if total is None else "{desc}: {percentage:3.0f} %|{bar}| {elapsed}<{remaining}"
    with tqdm(desc=what, total=total, bar_format=form, disable=False if shown else None) as bar:
        yield None if bar.disable else lambda done: bar.update(done - bar.n) and None


class ProgressLine:
    """The last ended generation in one line on standard error. A terminal and a notebook show each in place of the one
    before."""

    def __init__(self, last: int | None) -> None:
        self._last = last  # the number of the last generation, if it is known
        self._began = time.monotonic()
        self._width = 0  # of the line that is shown

    def show(self, generation: Generation) -> None:
        """Shows a generation."""
        which, numbers = str(generation).split(":", 1)
        of = "" if self._last is None else f" of {self._last}"
        line = f"{which}{of}:{numbers}, {time.monotonic() - self._began:.1f} s"
        is_terminal = sys.stderr.isatty() or in_notebook()
        sys.stderr.write(f"\r{line:<{self._width}}" if is_terminal else line + "\n")
        sys.stderr.flush()
        self._width = len(line) if is_terminal else 0

    def end(self) -> None:
        """Ends the line."""
        if self._width:
            sys.stderr.write("\n")
            self._width = 0
