"""Finds the program evod."""
from __future__ import annotations

import os
import shutil

from evod.errors import Error


def find_program(program: str | os.PathLike[str] | None) -> str:
    """Returns the path of `program`; by default the path in the environment variable EVOD, or of the evod found in PATH."""
    name = os.fspath(program) if program is not None else os.environ.get("EVOD") or "evod"
    found = shutil.which(name)
    if found is None:
        raise Error(f"the program {name} was not found: add its folder to PATH, or set the variable EVOD to its path")
    return found
