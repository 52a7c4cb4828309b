"""Executes the runs of a sweep with an executor of concurrent.futures, or of a package with the same interface.

Each run is a task. A worker, which may be on another machine, executes `evod run` and returns the rows of its table. This
process writes them into the folder of the sweep, and `evod sweep --gather` makes the table. The folder is then as if
`evod sweep` had executed the runs, and both can resume it. The program evod alone decides which cells and seeds a sweep has.

Threads      ExecutorSweep.run() waits for the tasks; any thread may call stop().
Determinism  a part depends only on its run, not on the executor and not on the order in which runs end.
"""
from __future__ import annotations

import concurrent.futures
import contextlib
import csv
import dataclasses
import functools
import io
import os
import pathlib
import platform
import queue
import re
import secrets
import tempfile
import threading
from typing import Callable, Iterator, Mapping

from evod.errors import Error, ProgramFailed
from evod.genes import GENE_NAMES
from evod.program import Program, find_program

#: The statuses of `evod run` if the run ended by itself: by a limit or a target, stagnation, extinction.
RUN_ENDED = (0, 3, 4)
_STOP_TIMEOUT_S = 10  # after this time, runs that do not end continue without this process
_LOOK_S = 0.2  # how often a worker checks whether the sweep has been stopped, and the sweep whether it has been interrupted

_PLAN = re.compile(r": (\d+) cells? of (\d+) replicates?, \d+ runs?, seed (\d+)$")
_MISSING = re.compile(r"\d+ of \d+ runs? are missing: ")
_BUILD = re.compile(r"^# (?:evod|model): .*$", re.MULTILINE)
#: The criteria of a part, and the sentences of `evod run`.
_ENDS = {
    "target_fitness": "ended: target_fitness was reached",
    "generation_limit": "ended: generation_limit was reached",
    "stagnation_limit": "ended: the best fitness did not improve for stagnation_limit generations",
    "extinction": "ended: all organisms died",
}
_END_MARK = b"# ended by "


@dataclasses.dataclass(frozen=True)
class Plan:
    """The runs of a sweep, as `evod sweep --dry-run` prints them."""

    seed: int
    seeds: tuple[int, ...]  # by replicate
    parameters: tuple[str, ...]  # names of the swept parameters
    cells: tuple[tuple[str, ...], ...]  # the values of each cell, as text

    @staticmethod
    def parse(printed: str) -> Plan:
        """Raises ProgramFailed if the text has another form."""
        try:
            head, seeds, cells = (part.splitlines() for part in printed.strip("\n").split("\n\n"))
            found = _PLAN.search(head[-1])
            heading, *rows = (line.split("\t") for line in cells)
            if found is not None and len(rows) == int(found[1]) and len(seeds) == 1 + int(found[2]):
                values = tuple(tuple(row[1:]) for row in rows)
                return Plan(int(found[3]), tuple(int(line.split("\t")[1]) for line in seeds[1:]), tuple(heading[1:]), values)
        except (ValueError, IndexError):
            pass
        raise unreadable("sweep --dry-run")

    def name_of(self, cell: int, replicate: int) -> str:
        """The name of a run in the folder of the sweep: "cell-07-replicate-2"."""
        return f"cell-{_padded(cell, len(self.cells))}-replicate-{_padded(replicate, len(self.seeds))}"


def unreadable(command: str) -> ProgramFailed:
    """Returns the error for output in an unknown form."""
    return ProgramFailed(f"cannot read the output of evod {command}: the program and the package must have the same version")


# ---- in a worker ------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class SweepRun:
    """One run of a sweep, with everything that a worker needs."""

    cell: int
    replicate: int
    seed: int
    values: Mapping[str, str]  # of the swept parameters
    experiment: str  # the text of the experiment file
    generations: int | None
    program: str | None  # None: the program that the worker finds
    build: str  # that the program must have
    #: Path of a file that exists until the sweep ends or is stopped. A worker on another machine may not see it.
    running: str

    def __str__(self) -> str:
        values = ", ".join(f"{name} {value}" for name, value in self.values.items())
        return f"cell {self.cell}{f' ({values})' if values else ''}, replicate {self.replicate}"


@dataclasses.dataclass(frozen=True)
class RunResult:
    """What a worker returns."""

    rows: str  # as in runs.csv
    row_count: int
    end: str  # the criterion that ended the run


def execute(run: SweepRun) -> RunResult:
    """Executes a run with the program evod. Every worker imports this function."""
    program = find_program(run.program)
    build = _build_of(program, os.stat(program).st_mtime_ns)
    if build != run.build:
        raise ProgramFailed(
            f"{program} on {platform.node()} is another build of evod ({build}) than that of the sweep ({run.build}): "
            "install the same build on all machines"
        )
    with tempfile.TemporaryDirectory(prefix="evod-run-") as folder:
        experiment, table = os.path.join(folder, "experiment.json"), os.path.join(folder, "run.csv")
        pathlib.Path(experiment).write_text(run.experiment, encoding="utf-8")
        command = [program, "run", experiment, "--seed", str(run.seed), "--threads", "1", "--csv", table]
        command += [] if run.generations is None else ["--generations", str(run.generations)]
        for name, value in run.values.items():
            command += ["--set", f"{name}={value}"]
        process = Program(command, hidden=f"{experiment}: ", accepted=RUN_ENDED)
        with _stopped_with_the_sweep(run.running, process):
            printed = process.run()
        rows, row_count = _rows(run, pathlib.Path(table).read_text(encoding="utf-8"))
    for end, sentence in _ENDS.items():
        if sentence in printed.splitlines():
            return RunResult(rows, row_count, end)
    raise unreadable("run")


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


def _rows(run: SweepRun, table: str) -> tuple[str, int]:
    """Returns the rows of a run with the columns of runs.csv, and their number.

    The table of a run has columns for all genes, but that of a sweep only for those of the body, because the cells of a sweep
    may have different genes.
    """
    heading, *rows = csv.reader(io.StringIO(table))
    first = heading.index(f"{GENE_NAMES[0]}_mean")
    of_body = tuple(f"{name}_" for name in GENE_NAMES)
    kept = [i for i, name in enumerate(heading) if i < first or name.startswith(of_body)]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for row in rows:
        writer.writerow([run.cell, run.replicate, run.seed, *run.values.values(), *(row[i] for i in kept)])
    return text.getvalue(), len(rows)


@functools.lru_cache(maxsize=8)
def _build_of(program: str, modified_ns: int) -> str:
    """Returns the build of the program and the version of its model, which it writes into the folder of every sweep."""
    with tempfile.TemporaryDirectory(prefix="evod-build-") as folder:
        smallest = '{"list": [{"population_size": 2, "generation_s": 1}], "generations": 1}'
        path = pathlib.Path(folder) / "smallest.json"
        path.write_text(smallest, encoding="utf-8")
        Program([program, "sweep", str(path), "--out", folder, "--jobs", "1"], hidden=f"{path}: ").run()
        return _build_in(pathlib.Path(folder))


def _build_in(folder: pathlib.Path) -> str:
    lines = _BUILD.findall((folder / "sweep.txt").read_text(encoding="utf-8"))
    return ", ".join(line.removeprefix("# ") for line in lines[:2])


# ---- in the process of the caller -------------------------------------------------------------------------------------


class ExecutorSweep:
    """One execution of a sweep with an executor. It has the interface of Program."""

    def __init__(
        self,
        executor: concurrent.futures.Executor,
        plan: Plan,
        *,
        path: str,  # of the sweep file
        experiment: str,  # text of the experiment file
        generations: int | None,
        results: pathlib.Path,  # the folder of the sweep
        program: str | os.PathLike[str] | None,
        on_progress: Callable[[float], None] | None = None,
    ) -> None:
        self._executor, self._plan, self._path, self._experiment = executor, plan, path, experiment
        self._generations, self._results, self._given, self._on_progress = generations, results, program, on_progress
        self._ended: queue.SimpleQueue[concurrent.futures.Future[RunResult] | None] = queue.SimpleQueue()
        self._lock = threading.Lock()  # guards the two members below
        self._begun = self._stopped = False
        self._over = threading.Event()

    def run(self) -> str:
        """Executes the missing runs and writes runs.csv. Raises the error of the first run that fails, after it has cancelled
        the others. Returns what `evod sweep --gather` prints."""
        with self._lock:
            if self._stopped:
                raise concurrent.futures.CancelledError
            self._begun = True
        try:
            self._results.mkdir(parents=True, exist_ok=True)
            try:
                return self._gather()
            except ProgramFailed as error:
                if not _MISSING.match(error.message):
                    raise
            self._execute_missing_runs()
            return self._gather()
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
        command = [find_program(self._given), "sweep", self._path, "--out", str(self._results), "--gather"]
        return Program(command, hidden=f"{self._path}: ").run()

    def _execute_missing_runs(self) -> None:
        with tempfile.TemporaryDirectory(prefix="evod-running-") as folder:
            running = pathlib.Path(folder) / "running"
            running.touch()
            futures: dict[concurrent.futures.Future[RunResult], SweepRun] = {}
            try:
                self._submit(str(running), futures)
                for count in range(1, len(futures) + 1):
                    self._report(count - 1, len(futures))
                    future = self._next_ended()
                    if future is None:
                        raise concurrent.futures.CancelledError
                    run = futures[future]
                    self._write_part(run, _result_of(future, run))
                self._report(len(futures), len(futures))
            except BaseException:
                running.unlink()
                left = [future for future in futures if not future.cancel()]
                concurrent.futures.wait(left, _STOP_TIMEOUT_S)
                raise

    def _next_ended(self) -> concurrent.futures.Future[RunResult] | None:
        """Waits for the end of a run and returns its future; returns None after stop().

        A signal that arrives just before a wait does not interrupt it, so each wait is short: Ctrl-C then has its effect.
        """
        while True:
            with contextlib.suppress(queue.Empty):
                return self._ended.get(timeout=_LOOK_S)

    def _submit(self, running: str, futures: dict[concurrent.futures.Future[RunResult], SweepRun]) -> None:
        program = None if self._given is None else os.fspath(self._given)
        build = _build_in(self._results)
        for cell, values in enumerate(self._plan.cells):
            for replicate, seed in enumerate(self._plan.seeds):
                if _is_finished(self._part_of(cell, replicate)):
                    continue
                named = dict(zip(self._plan.parameters, values))
                run = SweepRun(
                    cell, replicate, seed, named, self._experiment, self._generations, program, build, running
                )
                future = self._executor.submit(execute, run)
                futures[future] = run
                future.add_done_callback(self._ended.put)

    def _part_of(self, cell: int, replicate: int) -> pathlib.Path:
        return self._results / "parts" / f"{self._plan.name_of(cell, replicate)}.csv"

    def _write_part(self, run: SweepRun, result: RunResult) -> None:
        """Writes a file that is complete, or that does not exist under its name, even after a power failure."""
        part = self._part_of(run.cell, run.replicate)
        temporary = part.with_name(f"{part.name}.unfinished-{secrets.token_hex(8)}")  # evod deletes files with such names
        try:
            with open(temporary, "xb") as file:
                file.write(result.rows.encode() + _END_MARK + f"{result.end}, rows: {result.row_count}\n".encode())
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, part)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise

    def _report(self, done: int, total: int) -> None:
        if self._on_progress:
            self._on_progress(done / total)


def _result_of(future: concurrent.futures.Future[RunResult], run: SweepRun) -> RunResult:
    """Returns the result of a task. Names the run in its error."""
    try:
        return future.result()
    except Error as error:
        raise type(error)(f"{run}: {error.message}", error.violations, error.code) from error
    except Exception as error:  # of the executor: a worker died, for example
        raise ProgramFailed(f"{run}: {type(error).__name__}: {error}") from error


def _is_finished(part: pathlib.Path) -> bool:
    """Whether the last line of a part is that of a finished run. `evod sweep --gather` checks the whole file."""
    try:
        with open(part, "rb") as file:
            file.seek(max(0, os.fstat(file.fileno()).st_size - 128))
            end = file.read()
    except FileNotFoundError:
        return False
    return end.endswith(b"\n") and end.splitlines()[-1].startswith(_END_MARK)


def _padded(number: int, count: int) -> str:
    return str(number).zfill(len(str(count - 1)))
