"""Finds the program evod, runs its subcommands, and converts its error messages to exceptions."""
from __future__ import annotations

import errno
import os
import re
import shutil
import subprocess
import tempfile
from typing import IO, Callable, Sequence

from evod.errors import Error, FileNotFound, InvalidArgument, ProgramFailed, Violation

_REFUSED = re.compile(r"^\s+(?P<field>.+?)(?: \(line \d+\))?: got (?P<got>.*?), allowed (?P<allowed>.*)$")
_REFUSED_OPTION = re.compile(r"^(?:evod: )?--(?P<field>[a-z-]+): got (?P<got>.*?), allowed (?P<allowed>.*)$")
_UNKNOWN = re.compile(r"^\s+(?P<field>.+?)(?: \(line \d+\))?: unknown name(?:; did you mean (?P<allowed>.*)\?)?$")
_OPTION = re.compile(r"^--(?P<field>[a-z-]+): must be (?P<allowed>.*), not (?P<got>.*?)$")
_REFUSED_USE = re.compile(r"^evod [a-z]+: --(?P<field>[a-z-]+): got (?P<got>.*?), allowed (?P<allowed>.*)$")
_SEE_HELP = re.compile(r"^See evod( [a-z]+)? --help$")
_OPTION = re.compile(r"--([a-z][a-z-]*)")
_PROGRESS = re.compile(r"\r *(?:(\d+) of (\d+) runs|(\d+) % of)")
_CLEARED = re.compile(r"\r[^\r\n]*\x1b\[K")  # a progress line, or its removal


def find_program(program: str | os.PathLike[str] | None) -> str:
    """Returns the path of `program`; by default the path in the environment variable EVOD, or of the evod found in PATH."""
    name = os.fspath(program) if program is not None else os.environ.get("EVOD") or "evod"
    found = shutil.which(name)
    if found is None:
        raise FileNotFound(f"the program {name} was not found: add its folder to PATH, or set the variable EVOD to its path")
    return found


def failure(output: str, hidden: str = "") -> Error:
    """Returns the error for what the program printed before it ended. Options are named like the arguments of this package.

    hidden  the path of a temporary file or folder, as it begins messages of the program; the result does not contain it.
    """
    violations, others = [], []
    for line in output.splitlines():
        if found := _REFUSED.match(line) or _REFUSED_OPTION.match(line):
            violations.append(Violation(_argument(found["field"]), found["allowed"], found["got"]))
        elif found := _UNKNOWN.match(line):
            violations.append(Violation(_argument(found["field"]), found["allowed"] or "a known name", "an unknown name"))
        elif line.strip() and not _SEE_HELP.match(line):
            line = re.sub(r"^evod: ", "", line.strip())
            line = line.replace(hidden, "") if hidden else line
            others.append(_OPTION.sub(lambda option: _argument(option[1]), line))
    if violations:
        return InvalidArgument(" ".join(others) or "an argument is not allowed", violations)
    return ProgramFailed(" ".join(others) or "the program evod failed without a message")


def _argument(option: str) -> str:
    return option.replace("-", "_")


class Program:
    """One execution of the program, with its output.

    hidden       as for `failure`.
    on_progress  called with the finished share of the work, 0 to 1. The program prints its progress only on a terminal, so
                 its standard error is then a pseudo-terminal.
    """

    def __init__(
        self, command: Sequence[str], *, hidden: str = "", on_progress: Callable[[float], None] | None = None
    ) -> None:
        self._command, self._hidden, self._on_progress = command, hidden, on_progress
        self._process: subprocess.Popen[bytes] | None = None
        self._stopped = False

    def run(self) -> str:
        """Runs the program and returns its standard output. Raises `failure` if its status is not 0."""
        reading_end, writing_end = os.openpty() if self._on_progress else os.pipe()
        printed = ""
        with os.fdopen(reading_end, "rb", buffering=0) as errors, tempfile.TemporaryFile() as output:
            try:
                self._process = process = subprocess.Popen(
                    self._command, stdin=subprocess.DEVNULL, stdout=output, stderr=writing_end
                )
            finally:
                os.close(writing_end)
            try:
                if self._stopped:
                    process.terminate()
                while part := _read(errors):
                    printed += part.decode(errors="replace")
                    self._report(part.decode(errors="replace"))
                process.wait()
            except BaseException:
                self.stop()
                raise
            output.seek(0)
            text = output.read().decode(errors="replace")
        if process.returncode != 0:
            raise failure(_CLEARED.sub("", printed.replace("\r\n", "\n")), self._hidden)
        if self._on_progress:
            self._on_progress(1.0)
        return text

    def stop(self) -> None:
        """Stops the program if it runs, and waits for its end. Another thread than that of run() may call it."""
        self._stopped = True
        if self._process is not None:
            self._process.terminate()
            self._process.wait()

    def _report(self, part: str) -> None:
        if self._on_progress and (reported := _PROGRESS.findall(part)):
            done, total, percent = reported[-1]
            self._on_progress(int(done) / int(total) if total else int(percent) / 100)


def _read(file: IO[bytes]) -> bytes:
    try:
        return file.read(1 << 16)
    except OSError as error:
        if error.errno == errno.EIO:  # the other end of the pseudo-terminal is closed
            return b""
        raise
