"""Finds the program evod, runs its subcommands, and converts its error messages to exceptions."""
from __future__ import annotations

import json
import os
import re
import selectors
import shutil
import subprocess
import warnings
from typing import IO, Any, Callable, Container, Iterator, Mapping, Sequence

from evod.errors import Error, FileNotFound, InvalidArgument, ProgramFailed, Violation

_REFUSED = re.compile(r"^\s+(?P<field>.+?)(?: \(line \d+\))?: got (?P<got>.*?), allowed (?P<allowed>.*)$")
_REFUSED_OPTION = re.compile(r"^(?:evod: )?--(?P<field>[a-z-]+): got (?P<got>.*?), allowed (?P<allowed>.*)$")
_UNKNOWN = re.compile(
    r"^\s+(?P<field>.+?)(?: \(line \d+\))?: unknown name(?:; did you mean (?P<meant>.*)\?|, allowed (?P<allowed>.*))?$"
)
_WARNING = "evod: warning: "
_SEE_HELP = re.compile(r"^See evod( [a-z]+)? --help$")
_OPTION = re.compile(r"--([a-z][a-z-]*)")
# the first letters of the variables that mpirun and srun set for their processes
_OF_MPIRUN = ("OMPI_", "PMIX_", "PMI_")


def find_program(program: str | os.PathLike[str] | None) -> str:
    """Returns the path of `program`; by default the path in the environment variable EVOD, or of the evod found in
    PATH."""
    name = os.fspath(program) if program is not None else os.environ.get("EVOD") or "evod"
    found = shutil.which(name)
    if found is None:
        raise FileNotFound(f"the program {name} was not found: add its folder to PATH, or set the variable EVOD to its "
                           "path")
    return found


def environment(**more: str) -> Mapping[str, str]:
    """Returns the environment for the program: that of this process, without the variables of mpirun, and `more`.

    If mpirun has started this process, these variables would make the program a process of the same job: it would wait
    for the others, which do not start it.
    """
    return {**{name: value for name, value in os.environ.items() if not name.startswith(_OF_MPIRUN)}, **more}


def failure(output: str, hidden: str = "") -> Error:
    """Returns the error for what the program printed before it ended. Options are named like the arguments of this
    package.

    hidden  the path of a temporary file or folder that begins messages of the program; the result lacks it.
    """
    violations, others = [], []
    for line in output.splitlines():
        if line.startswith(_WARNING):
            continue
        if found := _REFUSED.match(line) or _REFUSED_OPTION.match(line):
            violations.append(Violation(_argument(found["field"]), found["allowed"], found["got"]))
        elif found := _UNKNOWN.match(line):
            violations.append(Violation(_argument(found["field"]), found["meant"] or found["allowed"] or "a known name",
                                        "an unknown name"))
        elif line.strip() and not _SEE_HELP.match(line):
            line = re.sub(r"^evod: ", "", line.strip())
            line = line.replace(hidden, "") if hidden else line
            others.append(_OPTION.sub(lambda option: _argument(option[1]), line))
    if violations:
        return InvalidArgument(" ".join(others) or "an argument is not allowed", violations)
    return ProgramFailed(" ".join(others) or "the program evod failed without a message")


def _argument(option: str) -> str:
    return option.replace("-", "_")


def result_in(printed: str) -> Any:
    """Returns the result that the program printed with --json: the last line. Raises ProgramFailed if there is none."""
    try:
        return json.loads(printed.rstrip("\n").rpartition("\n")[2])
    except ValueError as error:
        raise ProgramFailed(
            "cannot read the output of evod: the program and the package must have the same version") from error


class Program:
    """One execution of the program, with its output.

    If this process is killed, the standard output of the program has no reader, and the next line that it prints ends
    it. So `evod run` and `evod sweep --run --json` end soon after a generation.

    hidden       as for `failure`.
    on_progress  called with the finished share of the work, 0 to 1, which the program prints with --json.
    accepted     the statuses of success.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        hidden: str = "",
        on_progress: Callable[[float], None] | None = None,
        accepted: Container[int] = (0,),
    ) -> None:
        self._command, self._hidden, self._on_progress, self._accepted = command, hidden, on_progress, accepted
        self._process: subprocess.Popen[bytes] | None = None
        self._stopped = False

    def run(self) -> str:
        """Runs the program and returns its standard output. Raises `failure` if its status is not accepted."""
        printed, text, shown = b"", b"", 0
        with subprocess.Popen(
            self._command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment()
        ) as process:
            self._process = process
            assert process.stdout is not None and process.stderr is not None
            try:
                if self._stopped:
                    process.terminate()
                for file, part in _parts_of(process.stderr, process.stdout):
                    if file is process.stderr:
                        printed += part
                        continue
                    text += part
                    if self._on_progress and (end := text.rfind(b"\n") + 1) > shown:
                        self._report(text[shown:end])
                        shown = end
                process.wait()
            except BaseException:
                self.stop()
                raise
        if process.returncode not in self._accepted:
            raise failure(printed.decode(errors="replace"), self._hidden)
        for line in printed.decode(errors="replace").splitlines():
            if line.startswith(_WARNING):
                warnings.warn(line[len(_WARNING):], stacklevel=2)
        if self._on_progress:
            self._on_progress(1.0)
        return text.decode(errors="replace")

    def stop(self) -> None:
        """Stops the program if it runs, and waits for its end. Another thread than that of run() may call it."""
        self._stopped = True
        if self._process is not None:
            self._process.terminate()
            self._process.wait()

    def _report(self, lines: bytes) -> None:
        """Reports the last progress in some lines of the program."""
        progress = [line["progress"] for line in map(json.loads, lines.splitlines()) if "progress" in line]
        if self._on_progress and progress:
            self._on_progress(progress[-1])


def _parts_of(*files: IO[bytes]) -> Iterator[tuple[IO[bytes], bytes]]:
    """Yields what arrives at the files, until all of them have ended."""
    with selectors.DefaultSelector() as selector:
        for file in files:
            selector.register(file, selectors.EVENT_READ, file)
        while selector.get_map():
            for key, _ in selector.select():
                if part := os.read(key.fd, 1 << 16):
                    yield key.data, part
                else:
                    selector.unregister(key.data)
