"""Where the program evod is."""
from __future__ import annotations

import os
import shutil

from evod.errors import Error


def program_of(program: str | os.PathLike[str] | None) -> str:
    """The one that is named; otherwise the one that the environment's EVOD names, or that is on the path."""
    name = os.fspath(program) if program is not None else os.environ.get("EVOD") or "evod"
    found = shutil.which(name)
    if found is None:
        raise Error(f"there is no program {name}: put evod on the path, or name it in the environment's EVOD")
    return found
