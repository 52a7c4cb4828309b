"""Files that the caller names: read with a bound, and only regular files, because reading a pipe or a device may never
end."""
from __future__ import annotations

import errno
import os
import stat

EXPERIMENT_BYTES_MAX = 1 << 20
TOKEN_BYTES_MAX = 4096
PEM_BYTES_MAX = 4 << 20


def read_input(path: str | os.PathLike[str], kind: str, bytes_max: int) -> tuple[bytes, os.stat_result]:
    """Returns the contents of a file and its state when it was opened. Raises OSError.

    kind  what the file should contain, for messages: "an experiment file".
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    about = os.fstat(descriptor)
    if not stat.S_ISREG(about.st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, f"this is {_other_than_file(about.st_mode)}, not {kind}")
    with open(descriptor, "rb") as file:
        data = file.read(bytes_max + 1)
    if len(data) > bytes_max:
        raise OSError(errno.EFBIG, f"too large for {kind} ({bytes_max} bytes at most)")
    return data, about


def _other_than_file(mode: int) -> str:
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a pipe" if stat.S_ISFIFO(mode) else "a socket" if stat.S_ISSOCK(mode) else "a device"
