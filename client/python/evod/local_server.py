"""A private server, which this program starts and which stops when this program ends."""
from __future__ import annotations

import collections
import contextlib
import os
import re
import signal
import subprocess
import tempfile
import threading
from typing import IO, Mapping

from evod.experiment import Experiment, file_of, write_json
from evod.notebook import LOCAL_ORIGINS, in_notebook
from evod.program import environment, failure, find_program

_STOP_TIMEOUT_S = 30  # time for the server to write its runs; after this time it is killed
_LISTENING = re.compile(r"listening on (127\.0\.0\.1:\d+)")
# A shell script that starts the server, and stops it when the standard input of the shell is closed. The kernel closes
# this input when the Python program ends, even if it is killed.
_SUPERVISOR = (
    '"$@" & evod=$!; exec >/dev/null 2>&1; read -r _; kill "$evod"; wait "$evod"; [ -z "$FOLDER" ] || rm -rf "$FOLDER"'
)


def start(
    seed: int | None,
    experiment: Experiment,
    data: str | os.PathLike[str] | None,
    speed: float | str,
    threads: int | None,
    program: str | os.PathLike[str] | None,
) -> Server:
    """Starts a server with the options of evod.local() and waits until it accepts connections. Raises Error if it
    fails."""
    command = [find_program(program), "--port", "0", "--web", "--http-port", "0"]
    command += [word for origin in LOCAL_ORIGINS for word in ("--embed-in", origin)] if in_notebook() else []
    command += [] if seed is None else ["--seed", str(seed)]
    command += [] if threads is None else ["--threads", str(threads)]
    with tempfile.TemporaryDirectory(prefix="evod-") as folder:
        hidden = ""
        if isinstance(experiment, Mapping):
            # The server gives the world the name of this file: default.
            path = write_json(os.path.join(folder, "default.json"), experiment)
            hidden = f"{path}: "
            command += ["--experiment", path]
        elif experiment is not None:
            command += ["--experiment", file_of(experiment)]
        if data is not None:
            return Server([*command, "--data", os.fspath(data)], hidden=hidden)
        # The data in a temporary folder need not survive a power failure. A new folder contains no worlds, so an option
        # of the program can set the speed of the single world.
        temporary = tempfile.mkdtemp(prefix="evod-runs-")
        command += ["--data", temporary, "--durability", "relaxed", "--speed", str(speed)]
        return Server(command, temporary, hidden)


class Server:
    """A running server. It stops when this program ends. Its temporary folder, if it has one, is then deleted."""

    def __init__(self, command: list[str], temporary: str = "", hidden: str = "") -> None:
        self._supervisor: subprocess.Popen[str] = subprocess.Popen(
            ["/bin/sh", "-c", _SUPERVISOR, "sh", *command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env=environment(FOLDER=temporary),
            start_new_session=True,  # so that Ctrl-C on the terminal does not stop the server
        )
        self._process = os.getpid()
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
            raise failure("\n".join(self.lines), hidden)
        threading.Thread(target=self._read_log, args=(self._supervisor.stdout,), daemon=True).start()

    def _read_log(self, log: IO[str]) -> None:
        with log:
            for line in log:
                self.lines.append(line.rstrip())
        self._supervisor.wait()

    def end(self) -> None:
        """Asks the server to stop, without waiting for it. Does nothing in a forked process."""
        if os.getpid() == self._process and self._supervisor.stdin is not None and not self._supervisor.stdin.closed:
            with contextlib.suppress(BrokenPipeError):  # the server has ended
                # The line ends the server even if a forked process has inherited this end of the pipe.
                self._supervisor.stdin.write("stop\n")
                self._supervisor.stdin.flush()
            with contextlib.suppress(BrokenPipeError):
                self._supervisor.stdin.close()

    def stop(self) -> None:
        """Stops the server and waits until it has written its runs. Does nothing in a forked process."""
        if os.getpid() != self._process:
            return
        self.end()
        try:
            self._supervisor.wait(_STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            os.killpg(self._supervisor.pid, signal.SIGKILL)
            self._supervisor.wait()
