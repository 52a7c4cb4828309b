"""A private server, which this program starts and which stops when this program ends."""
from __future__ import annotations

import collections
import json
import os
import re
import signal
import subprocess
import tempfile
import threading
from typing import IO, Mapping

import numpy

from evod.errors import Error, wrong_argument
from evod.program import find_program

_STOP_TIMEOUT_S = 30  # time for the server to write its runs; after this time it is killed
_LISTENING = re.compile(r"listening on (127\.0\.0\.1:\d+)")
# A shell script that starts the server, and stops it when the standard input of the shell is closed. The kernel closes this
# input when the Python program ends, even if it is killed.
_SUPERVISOR = (
    '"$@" & evod=$!; exec >/dev/null 2>&1; read -r _; kill "$evod"; wait "$evod"; [ -z "$FOLDER" ] || rm -rf "$FOLDER"'
)


def start(
    seed: int | None,
    experiment: str | os.PathLike[str] | Mapping[str, object] | None,
    data: str | os.PathLike[str] | None,
    speed: float | str,
    threads: int | None,
    program: str | os.PathLike[str] | None,
) -> Server:
    """Starts a server with the options of evod.local() and waits until it accepts connections. Raises Error if it fails."""
    command = [find_program(program), "--port", "0"]
    temporary = tempfile.mkdtemp(prefix="evod-runs-") if data is None else ""
    # The data in a temporary folder need not survive a power failure. A new folder contains no worlds, so the speed of the
    # single world can be set by an option of the program.
    command += ["--data", temporary, "--durability", "relaxed", "--speed", str(speed)] if data is None else ["--data", os.fspath(data)]
    command += [] if seed is None else ["--seed", str(seed)]
    command += [] if threads is None else ["--threads", str(threads)]
    with tempfile.TemporaryDirectory(prefix="evod-") as folder:
        if isinstance(experiment, Mapping):
            path = os.path.join(folder, "default.json")  # the server gives the world the name of this file: default
            with open(path, "w", encoding="utf-8") as file:
                json.dump(dict(experiment), file, default=_json_value)
            command += ["--experiment", path]
        elif experiment is not None:
            command += ["--experiment", os.fspath(experiment)]
        return Server(command, temporary)


def _json_value(value: object) -> object:
    if isinstance(value, numpy.generic):
        return value.item()
    raise wrong_argument("experiment", "numbers, text, true and false", repr(value))


class Server:
    """A running server. It stops when this program ends. Its temporary folder, if it has one, is then deleted."""

    def __init__(self, command: list[str], temporary: str = "") -> None:
        self._supervisor: subprocess.Popen[str] = subprocess.Popen(
            ["/bin/sh", "-c", _SUPERVISOR, "sh", *command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env={**os.environ, "FOLDER": temporary},
            start_new_session=True,  # so that Ctrl-C on the terminal does not stop the server
        )
        self.lines: collections.deque[str] = collections.deque(maxlen=1000)
        assert self._supervisor.stdout is not None
        for line in self._supervisor.stdout:
            self.lines.append(line.rstrip())
            if found := _LISTENING.search(line):
                self.address = found[1]
                break
        else:
            self._supervisor.stdout.close()
            self.stop()
            raise Error("evod did not start: " + " ".join(self.lines))
        threading.Thread(target=self._read_log, args=(self._supervisor.stdout,), daemon=True).start()

    def _read_log(self, log: IO[str]) -> None:
        with log:
            for line in log:
                self.lines.append(line.rstrip())
        self._supervisor.wait()

    def end(self) -> None:
        """Asks the server to stop, without waiting for it."""
        if self._supervisor.stdin is not None and not self._supervisor.stdin.closed:
            self._supervisor.stdin.close()

    def stop(self) -> None:
        """Stops the server and waits until it has written its runs."""
        self.end()
        try:
            self._supervisor.wait(_STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            os.killpg(self._supervisor.pid, signal.SIGKILL)
            self._supervisor.wait()
