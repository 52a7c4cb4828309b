"""A private server: started for one program, and stopped with it."""
from __future__ import annotations

import collections
import json
import os
import re
import signal
import subprocess
import tempfile
import threading
import weakref
from typing import IO, Mapping

import numpy

from evod.errors import Error, wrong_argument
from evod.lab import Lab, connect
from evod.link import Link
from evod.program import program_of

_END_S = 30  # for a server to write down its runs; then it is killed
_LISTENING = re.compile(r"listening on (127\.0\.0\.1:\d+)")
# Stands between us and the server, and stops it when we are gone, however we went: our end of its input is closed then.
_KEEPER = (
    '"$@" & evod=$!; exec >/dev/null 2>&1; read -r _; kill "$evod"; wait "$evod"; [ -z "$FOLDER" ] || rm -rf "$FOLDER"'
)


def local(
    *,
    seed: int | None = None,
    experiment: str | os.PathLike[str] | Mapping[str, object] | None = None,
    data: str | os.PathLike[str] | None = None,
    speed: float | str = "max",
    threads: int | None = None,
    program: str | os.PathLike[str] | None = None,
    timeout_s: float = 30.0,
) -> LocalLab:
    """Starts a server of your own at a free port, and connects with it. close() stops it; so does who forgets it, and the end
    of the program.

    seed         of its world; otherwise drawn by chance.
    experiment   its parameters: an experiment file, or a mapping of names to values; otherwise the default world.
    data         folder where runs are kept; otherwise a temporary one that goes with the server.
    speed        of its worlds, also of those that are created: simulated seconds per second, or "max", as fast as the machine
                 can.
    threads      that simulate; otherwise as many as the machine has processors.
    program      the program evod; otherwise the one that the environment's EVOD names, or that is on the path.

    >>> import evod
    >>> with evod.local(experiment={"population_size": 20}) as lab:
    ...     lab.world().parameters.population_size
    20
    """
    server = start(seed, experiment, data, speed, threads, program)
    try:
        lab = connect(server.address, token="", ca="", timeout_s=timeout_s, client_name="evod.local")
        if data is not None:
            for found in lab.worlds():
                lab.world(found.name).set_speed(speed)
    except BaseException:
        server.stop()
        raise
    return LocalLab(lab._link, server, speed)


class LocalLab(Lab):
    """A Lab with a server of its own; made by local()."""

    def __init__(self, link: Link, server: Server, speed: float | str) -> None:
        super().__init__(link)
        self._server = server
        self._desk.speed_of_new_worlds = speed
        weakref.finalize(link, server.end)  # all that comes of the lab holds the link: nobody can use it any more

    def close(self) -> None:
        super().close()
        self._server.stop()

    @property
    def log(self) -> str:
        """The last lines that the server has written."""
        return "\n".join(self._server.lines)


def start(
    seed: int | None,
    experiment: str | os.PathLike[str] | Mapping[str, object] | None,
    data: str | os.PathLike[str] | None,
    speed: float | str,
    threads: int | None,
    program: str | os.PathLike[str] | None,
) -> Server:
    """Starts a server, as local() does, and waits until it listens."""
    command = [program_of(program), "--port", "0"]
    temporary = tempfile.mkdtemp(prefix="evod-runs-") if data is None else ""
    # What is temporary need not outlive the machine; and there is one world in it, whose speed can be said.
    command += ["--data", temporary, "--durability", "relaxed", "--speed", str(speed)] if data is None else ["--data", os.fspath(data)]
    command += [] if seed is None else ["--seed", str(seed)]
    command += [] if threads is None else ["--threads", str(threads)]
    with tempfile.TemporaryDirectory(prefix="evod-") as folder:
        if isinstance(experiment, Mapping):
            path = os.path.join(folder, "default.json")  # worlds are called after their file
            with open(path, "w", encoding="utf-8") as file:
                json.dump(dict(experiment), file, default=_plain)
            command += ["--experiment", path]
        elif experiment is not None:
            command += ["--experiment", os.fspath(experiment)]
        return Server(command, temporary)


def _plain(value: object) -> object:
    if isinstance(value, numpy.generic):
        return value.item()
    raise wrong_argument("experiment", "numbers, text, true and false", repr(value))


class Server:
    """One that ends when we do, and its temporary folder with it, if it has one."""

    def __init__(self, command: list[str], temporary: str = "") -> None:
        self._keeper: subprocess.Popen[str] = subprocess.Popen(
            ["/bin/sh", "-c", _KEEPER, "sh", *command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env={**os.environ, "FOLDER": temporary},
            start_new_session=True,  # an interrupt at the terminal is for us alone
        )
        self.lines: collections.deque[str] = collections.deque(maxlen=1000)
        assert self._keeper.stdout is not None
        for line in self._keeper.stdout:
            self.lines.append(line.rstrip())
            if found := _LISTENING.search(line):
                self.address = found[1]
                break
        else:
            self._keeper.stdout.close()
            self.stop()
            raise Error("evod did not start: " + " ".join(self.lines))
        threading.Thread(target=self._read_on, args=(self._keeper.stdout,), daemon=True).start()

    def _read_on(self, log: IO[str]) -> None:
        with log:
            for line in log:
                self.lines.append(line.rstrip())
        self._keeper.wait()

    def end(self) -> None:
        """Does not wait for it."""
        if self._keeper.stdin is not None and not self._keeper.stdin.closed:
            self._keeper.stdin.close()

    def stop(self) -> None:
        self.end()
        try:
            self._keeper.wait(_END_S)
        except subprocess.TimeoutExpired:
            os.killpg(self._keeper.pid, signal.SIGKILL)
            self._keeper.wait()
