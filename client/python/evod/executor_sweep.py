"""Executes the runs of a sweep with an executor of concurrent.futures, or of a package with the same interface.

Each run is a task. A worker, which may be on another machine, executes `evod sweep --run` and returns the file with its
rows. This process writes it into the folder of the sweep, and `evod sweep --gather` makes the table. The folder is then
as if `evod sweep` had executed the runs, and both can resume it. The program evod alone decides which cells and seeds a
sweep has, which runs are missing, and what their files contain.

Threads      ExecutorSweep.run() waits for the tasks; any thread may call stop().
Determinism  a part depends only on its run, not on the executor and not on the order in which runs end.
"""
from __future__ import annotations

import concurrent.futures
import contextlib
import dataclasses
import os
import pathlib
import platform
import queue
import secrets
import tempfile
import threading
from typing import Any, Callable, Iterator, Mapping

from evod.errors import Error, ProgramFailed
from evod.experiment import write_json
from evod.program import Program, find_program, result_in

_STOP_TIMEOUT_S = 10  # after this time, runs that do not end continue without this process
# how often a worker checks whether the sweep has been stopped, and the sweep whether it has been interrupted
_LOOK_S = 0.2


@dataclasses.dataclass(frozen=True)
class Plan:
    """The runs of a sweep."""

    build: str  # of evod, and the version of its model
    seed: int
    seeds: tuple[int, ...]  # by replicate
    parameters: tuple[str, ...]  # names of the swept parameters
    cells: tuple[tuple[str, ...], ...]  # the values of each cell, as text

    @staticmethod
    def of(printed: Mapping[str, Any]) -> Plan:
        """Converts what `evod sweep --dry-run --json` prints."""
        build = f"evod: {printed['evod']}, model: {printed['model']}"
        cells = tuple(tuple(values) for values in printed["cells"])
        return Plan(build, printed["seed"], tuple(printed["seeds"]), tuple(printed["parameters"]), cells)


def plan_command(program: str | os.PathLike[str] | None, path: str) -> Program:
    """Returns the program that prints the plan of a sweep file."""
    return Program([find_program(program), "sweep", path, "--dry-run", "--json"], hidden=f"{path}: ")


# ---- in a worker
# ------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class SweepRun:
    """One run of a sweep, with everything that a worker needs."""

    index: int  # of the run in the sweep
    cell: int
    replicate: int
    values: Mapping[str, str]  # of the swept parameters
    design: Mapping[str, object]  # the sweep file, without its experiment
    experiment: str  # the text of the experiment file
    program: str | None  # None: the program that the worker finds
    build: str  # that the program must have
    #: Path of a file that exists until the sweep ends or is stopped. A worker on another machine may not see it.
    running: str

    def __str__(self) -> str:
        values = ", ".join(f"{name} {value}" for name, value in self.values.items())
        return f"cell {self.cell}{f' ({values})' if values else ''}, replicate {self.replicate}"


def execute(run: SweepRun) -> bytes:
    """Executes a run with the program evod. Every worker imports this function. Returns the file of the run."""
    program = find_program(run.program)
    with tempfile.TemporaryDirectory(prefix="evod-run-") as folder:
        (pathlib.Path(folder) / "experiment.json").write_text(run.experiment, encoding="utf-8")
        path = write_json(os.path.join(folder, "sweep.json"), {**run.design, "experiment": "experiment.json"})
        build = _build_of(program, path)
        if build != run.build:
            raise ProgramFailed(
                f"{program} on {platform.node()} is another build of evod ({build}) than that of the sweep "
                f"({run.build}): "
                "install the same build on all machines"
            )
        part = os.path.join(folder, "part.csv")
        command = [program, "sweep", path, "--run", str(run.index), "--part", part, "--json"]
        process = Program(command, hidden=f"{path}: ")
        with _stopped_with_the_sweep(run.running, process):
            process.run()
        return pathlib.Path(part).read_bytes()


def _build_of(program: str, path: str) -> str:
    return Plan.of(result_in(plan_command(program, path).run())).build


@contextlib.contextmanager
def _stopped_with_the_sweep(running: str, process: Program) -> Iterator[None]:
    """Stops the process if the file `running` vanishes, or is missing in a folder that exists."""
    ended = threading.Event()

    def watch() -> None:
        seen = False
        while True:
            if os.path.exists(running):
                seen = True
            elif seen or os.path.exists(os.path.dirname(running)):
                return process.stop()
            if ended.wait(_LOOK_S):
                return

    watcher = threading.Thread(target=watch, name="evod sweep", daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()


# ---- in the process of the caller
# -------------------------------------------------------------------------------------


class ExecutorSweep:
    """One execution of a sweep with an executor. It has the interface of Program."""

    def __init__(
        self,
        executor: concurrent.futures.Executor,
        plan: Plan,
        *,
        path: str,  # of the sweep file
        design: Mapping[str, object],  # contents of the sweep file
        experiment: str,  # text of the experiment file
        results: pathlib.Path,  # the folder of the sweep
        program: str | os.PathLike[str] | None,
        on_progress: Callable[[float], None] | None = None,
    ) -> None:
        self._executor, self._plan, self._path, self._experiment = executor, plan, path, experiment
        self._design, self._results, self._given, self._on_progress = design, results, program, on_progress
        self._ended: queue.SimpleQueue[concurrent.futures.Future[bytes] | None] = queue.SimpleQueue()
        self._lock = threading.Lock()  # guards the two members below
        self._begun = self._stopped = False
        self._over = threading.Event()

    def run(self) -> str:
        """Executes the missing runs and writes runs.csv. Raises the error of the first run that fails, after it has
        cancelled the others. Returns what `evod sweep --gather --json` prints."""
        with self._lock:
            if self._stopped:
                raise concurrent.futures.CancelledError
            self._begun = True
        try:
            self._results.mkdir(parents=True, exist_ok=True)
            printed = self._gather()
            if missing := result_in(printed)["missing"]:
                self._execute(missing)
                printed = self._gather()
            return printed
        finally:
            self._over.set()

    def stop(self) -> None:
        """Stops the runs and waits for the end of run(). Another thread than that of run() may call it."""
        with self._lock:
            self._stopped = True
            self._ended.put(None)
            begun = self._begun
        if begun:
            self._over.wait()

    def _gather(self) -> str:
        command = [find_program(self._given), "sweep", self._path, "--out", str(self._results), "--gather", "--json"]
        return Program(command, hidden=f"{self._path}: ").run()

    def _execute(self, missing: list[dict[str, Any]]) -> None:
        with tempfile.TemporaryDirectory(prefix="evod-running-") as folder:
            running = pathlib.Path(folder) / "running"
            running.touch()
            futures: dict[concurrent.futures.Future[bytes], tuple[SweepRun, str]] = {}
            try:
                for missing_run in missing:
                    run = self._run(missing_run, str(running))
                    future = self._executor.submit(execute, run)
                    futures[future] = run, missing_run["part"]
                    future.add_done_callback(self._ended.put)
                for count in range(1, len(futures) + 1):
                    self._report(count - 1, len(futures))
                    ended = self._next_ended()
                    if ended is None:
                        raise concurrent.futures.CancelledError
                    run, part = futures[ended]
                    _write_file(pathlib.Path(part), _result_of(ended, run))
                self._report(len(futures), len(futures))
            except BaseException:
                running.unlink()
                left = [future for future in futures if not future.cancel()]
                concurrent.futures.wait(left, _STOP_TIMEOUT_S)
                raise

    def _next_ended(self) -> concurrent.futures.Future[bytes] | None:
        """Waits for the end of a run and returns its future; returns None after stop().

        A signal that arrives just before a wait does not interrupt it, so each wait is short: Ctrl-C then has its
        effect.
        """
        while True:
            with contextlib.suppress(queue.Empty):
                return self._ended.get(timeout=_LOOK_S)

    def _run(self, missing: dict[str, Any], running: str) -> SweepRun:
        program = None if self._given is None else os.fspath(self._given)
        cell = missing["cell"]
        values = dict(zip(self._plan.parameters, self._plan.cells[cell]))
        return SweepRun(missing["run"], cell, missing["replicate"], values, self._design, self._experiment, program,
                        self._plan.build, running)  # fmt: skip

    def _report(self, done: int, total: int) -> None:
        if self._on_progress:
            self._on_progress(done / total)


def _write_file(path: pathlib.Path, content: bytes) -> None:
    """Writes a file that is complete, or that does not exist under its name, even after a power failure."""
    temporary = path.with_name(f"{path.name}.unfinished-{secrets.token_hex(8)}")  # evod deletes files with such names
    try:
        with open(temporary, "xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _result_of(future: concurrent.futures.Future[bytes], run: SweepRun) -> bytes:
    """Returns the result of a task. Names the run in its error."""
    try:
        return future.result()
    except Error as error:
        raise type(error)(f"{run}: {error.message}", error.violations, error.code) from error
    except Exception as error:  # of the executor: a worker died, for example
        raise ProgramFailed(f"{run}: {type(error).__name__}: {error}") from error
