"""Sweeps and comparisons of worlds that a function rates, in worker processes of this machine.

Threads      FunctionRuns.results() waits for the workers; any thread may call stop().
Determinism  a run depends on its parameters, its seed and the function, not on the worker or the number of workers.
"""
from __future__ import annotations

import csv
import io
import json
import os
import pickle
import subprocess
import sys
import threading
from typing import Any, Callable, Mapping, Sequence

import numpy

from evod.errors import ProgramFailed, wrong_argument
from evod.executor_sweep import Plan
from evod.shipping import Task, ship

Columns = Mapping[str, Any]


class FunctionRuns:
    """The runs of several tasks, each with a name for error messages."""

    def __init__(self, function: Callable[..., object], tasks: Sequence[tuple[str, Task]], *, jobs: int | None,
                 program: str | os.PathLike[str] | None, on_progress: Callable[[float], None] | None) -> None:
        if jobs is not None and (isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1):
            raise wrong_argument("jobs", "a whole number, at least 1", jobs)
        self._first = pickle.dumps((None if program is None else os.fspath(program), ship(function)))
        self._tasks, self._on_progress = tasks, on_progress
        self._jobs = min(jobs or len(os.sched_getaffinity(0)), len(tasks))
        self._lock = threading.Lock()  # guards what follows
        self._next = 0  # index of the next task
        self._results: dict[int, Columns] = {}
        self._failures: dict[int, str] = {}  # by task
        self._workers: list[subprocess.Popen[bytes]] = []
        self._stopped = False

    def results(self) -> list[Columns]:
        """Executes all tasks and returns the columns of each. Raises ProgramFailed if a task fails."""
        threads = [threading.Thread(target=self._work, daemon=True) for _ in range(self._jobs)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        if self._failures:
            index = min(self._failures)
            raise ProgramFailed(f"{self._tasks[index][0]}: {self._failures[index]}")
        return [self._results[index] for index in range(len(self._tasks))]

    def stop(self) -> None:
        """Stops all workers."""
        with self._lock:
            self._stopped = True
            for worker in self._workers:
                worker.kill()

    def _work(self) -> None:
        """Starts a worker, and gives it one task after another."""
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path or os.getcwd() for path in sys.path)}
        with self._lock:
            if self._stopped:
                return
            worker = subprocess.Popen([sys.executable, "-m", "evod.function_worker"], stdin=subprocess.PIPE,
                                      stdout=subprocess.PIPE, env=environment)
            self._workers.append(worker)
        assert worker.stdin is not None and worker.stdout is not None
        index = None
        try:
            worker.stdin.write(self._first)
            while (index := self._take()) is not None:
                pickle.dump(self._tasks[index][1], worker.stdin)
                worker.stdin.flush()
                columns, failure = pickle.load(worker.stdout)
                self._put(index, columns, failure)
        except (OSError, EOFError, pickle.UnpicklingError):
            self._put(index or 0, None, "the worker process ended: its messages are on standard error")
        finally:
            try:
                worker.stdin.close()
            except OSError:
                pass
            worker.wait()
            worker.stdout.close()

    def _take(self) -> int | None:
        """The index of the next task; None if there is none, or a task has failed."""
        with self._lock:
            if self._stopped or self._failures or self._next == len(self._tasks):
                return None
            self._next += 1
            return self._next - 1

    def _put(self, index: int, columns: Columns | None, failure: str | None) -> None:
        with self._lock:
            if columns is not None:
                self._results[index] = columns
            elif not self._stopped:
                self._failures[index] = failure or "it failed"
            done = len(self._results) / len(self._tasks)
            if self._on_progress is not None:
                self._on_progress(done)


# ---- worlds
# --------------------------------------------------------------------------------------------------------


def stand_in(values: Mapping[str, object]) -> dict[str, object]:
    """The parameters of an experiment for the program evod, which cannot call the function: it checks them, and derives
    seeds, cells and controls."""
    if values.get("fitness", "external") != "external":
        raise wrong_argument("fitness", "external, or nothing, if a function is given", values["fitness"])
    if values.get("external_bodies", False) is False:
        return {**values, "fitness": "gene_sum"}
    return {name: value for name, value in values.items() if name not in ("fitness", "external_bodies")}


def rated_world(values: Mapping[str, object], changes: Mapping[str, str]) -> dict[str, object]:
    """The parameters of a world that the function rates; by default without bodies. `changes` are values as text."""
    rest = {name: value for name, value in values.items() if name not in ("seed", "description", *changes)}
    return {"external_bodies": False, **rest, "fitness": "external",
            **{name: _value(text) for name, text in changes.items()}}


def _value(text: str) -> object:
    try:
        return json.loads(text)
    except ValueError:
        return text


def table_of(rows: Sequence[tuple[Mapping[str, object], Columns]]) -> str:
    """Returns a CSV table: for each run the leading columns, then its history."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for number, (leading, columns) in enumerate(rows):
        if number == 0:
            writer.writerow([*leading, *columns])
        for line in zip(*(column.tolist() for column in columns.values())):
            writer.writerow([*leading.values(), *("" if cell != cell else cell for cell in line)])
    return text.getvalue()


# ---- sweeps and comparisons
# --------------------------------------------------------------------------------------------------------


class FunctionSweep(FunctionRuns):
    """The runs of a sweep."""

    def __init__(self, function: Callable[..., object], plan: Plan, values: Mapping[str, object],
                 generations: int | None, *, minimize: bool, **options: Any) -> None:
        self._leading: list[dict[str, object]] = []
        tasks = []
        for cell, texts in enumerate(plan.cells):
            changes = dict(zip(plan.parameters, texts))
            for replicate, seed in enumerate(plan.seeds):
                self._leading.append({"cell": cell, "replicate": replicate, "seed": seed, **changes})
                swept = ", ".join(f"{name} {text}" for name, text in changes.items())
                task = Task(rated_world(values, changes), seed, generations, minimize)
                tasks.append((f"cell {cell} ({swept}), replicate {replicate}", task))
        super().__init__(function, tasks, **options)

    def run(self) -> str:
        """Executes the runs and returns the table."""
        return table_of(list(zip(self._leading, self.results())))


class FunctionComparison(FunctionRuns):
    """The runs of a comparison: those of the first worlds, then those of the controls, which change the first world."""

    def __init__(self, function: Callable[..., object], worlds: Sequence[Mapping[str, Any]],
                 values: Sequence[Mapping[str, object]], seeds: Sequence[int], generations: int, *, minimize: bool,
                 **options: Any) -> None:
        self._leading: list[dict[str, object]] = []
        tasks = []
        for number, world in enumerate(worlds):
            changes = {}
            if number >= len(values):
                changes = dict(change.split("=", 1) for change in world["changes"].split())
            own = values[number] if number < len(values) else values[0]
            for replicate, seed in enumerate(seeds):
                self._leading.append({"arm": world["name"], "replicate": replicate, "seed": seed})
                task = Task(rated_world(own, changes), seed, generations, minimize)
                tasks.append((f"{world['name']}, replicate {replicate}", task))
        super().__init__(function, tasks, **options)

    def run(self) -> str:
        """Executes the runs and returns the fitness of every run and generation, for all islands together."""
        return table_of([(leading, _fitness_of(columns)) for leading, columns in zip(self._leading, self.results())])


def _fitness_of(columns: Columns) -> Columns:
    generation, first = numpy.unique(columns["generation"], return_index=True)
    organisms = numpy.add.reduceat(columns["organism_count"], first)
    is_minimized = (columns["fitness_best"] < columns["fitness_mean"]).any()
    better: Any = numpy.minimum if is_minimized else numpy.maximum
    return {
        "generation": generation,
        "fitness_mean": numpy.add.reduceat(columns["fitness_mean"] * columns["organism_count"], first) / organisms,
        "fitness_best": better.reduceat(columns["fitness_best"], first),
        "organism_count": organisms,
        "alive_count": numpy.add.reduceat(columns["alive_count"], first),
    }


def seeds_in(text: str) -> tuple[int, ...]:
    """The seeds of the replicates in the table of `evod compare --csv`."""
    rows = csv.DictReader(io.StringIO(text))
    return tuple(dict((int(row["replicate"]), int(row["seed"])) for row in rows).values())
