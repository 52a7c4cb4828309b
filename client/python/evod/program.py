"""Finds the program evod."""
from __future__ import annotations

import os
import shutil

from evod.errors import Error


def find_program(program: str | os.PathLike[str] | None) -> str:
    """Returns `program`, or else the path in the environment variable EVOD, or else the path of the evod found in PATH."""
    name = os.fspath(program) if program is not None else os.environ.get("EVOD") or "evod"
    found = shutil.which(name)
    if found is None:
        raise Error(f"there is no program {name}: put evod on the path, or name it in the environment variable EVOD")
    return found
