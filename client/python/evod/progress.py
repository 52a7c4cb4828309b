"""Progress bars, with the package tqdm if it is installed."""
from __future__ import annotations

import contextlib
from typing import Callable, Iterator

from evod.errors import MissingPackage


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
