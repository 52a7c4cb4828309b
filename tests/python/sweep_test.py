"""Sweeps on executors of concurrent.futures, Dask and mpi4py give the bytes of `evod sweep`; tables of single runs."""
import asyncio
import concurrent.futures
import contextlib
import importlib.util
import multiprocessing
import os
import pathlib
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import unittest
from unittest import mock

import pandas

import evod
import evod.aio
import waiting
from evod import executor_sweep
from open_mpi import OPEN_MPI
from support import PROGRAM, Temporary

SMALL = {"population_size": 12, "generation_s": 2}
GRID = {"mutation_chance": {"from": 0.01, "to": 0.5, "steps": 3, "scale": "log"}, "shuffle_fitness": [True, False]}
LONG = {"generation_limit": 1_000_000}  # takes an hour
#: As for a process that mpirun has started.
IN_A_JOB = {"OMPI_COMM_WORLD_SIZE": "4", "OMPI_COMM_WORLD_RANK": "1", "PMIX_RANK": "1", "PMI_SIZE": "4",
            "PMI_RANK": "1"}


def read(path):
    return pandas.read_csv(path, comment="#", float_precision="round_trip")


def program(*arguments):
    return waiting.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def has(*modules):
    return all(importlib.util.find_spec(module) for module in modules)


def processes():
    """A ProcessPoolExecutor whose workers do not inherit the threads of this process."""
    return concurrent.futures.ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


def is_run(process):
    """Whether a process is a run of a sweep that has not ended."""
    with contextlib.suppress(OSError):
        return b"\0--run\0" in pathlib.Path(f"/proc/{process}/cmdline").read_bytes()
    return False


def runs_below():
    """The processes `evod sweep --run` that this process has started, also those of its workers."""
    return list(filter(is_run, waiting.descendants()))


class RunTable(Temporary):
    def test_the_table_is_that_of_the_program(self):
        path = self.file("small.json", {**SMALL, "seed": 9, "mutation_chance": {"1": 0.5, "3": 0.1}, "island_count": 2})
        for changes in ({}, {"selection": "random", "free_genes": 2}):
            changed = [word for name, value in changes.items() for word in ("--set", f"{name}={value}")]
            program("run", path, "--generations", 4, "--csv", self.folder / "x.csv", *changed)
            table = evod.run_table(path, generations=4, **changes)
            pandas.testing.assert_frame_equal(table, read(self.folder / "x.csv"), check_exact=True)
            self.assertEqual(len(table), 8)

    def test_threads_and_other_processes_compute_it(self):
        once = evod.run_table(SMALL, seed=5, generations=2)
        for executor in (concurrent.futures.ThreadPoolExecutor(2), processes()):
            with executor:
                tables = [executor.submit(evod.run_table, SMALL, seed=5, generations=2) for _ in range(3)]
                for table in tables:
                    pandas.testing.assert_frame_equal(table.result(), once)
                refused = executor.submit(evod.run_table, SMALL, generations=1, selection="best").exception()
                self.assertEqual([v.field for v in refused.violations], ["selection"])

        async def both():
            return await asyncio.gather(*(evod.aio.run_table(SMALL, seed=5, generations=2) for _ in range(2)))

        for table in asyncio.run(both()):
            pandas.testing.assert_frame_equal(table, once)

    def test_every_criterion_may_end_it(self):
        extinct = {**SMALL, "generation_s": 1000, "food_count": 0, "stop_at_extinction": True}
        for experiment in ({**SMALL, "stagnation_limit": 1}, extinct, {**SMALL, "generation_limit": 2},
                           {**SMALL, "stop_at_target_fitness": True, "target_fitness": 1}):
            self.assertGreater(len(evod.run_table(experiment, seed=1)), 0)
            sweep = {"list": [{"mutation_chance": 0.1}], "seed": 1}
            with concurrent.futures.ThreadPoolExecutor(1) as executor:
                self.assertEqual(evod.sweep(experiment, **sweep, executor=executor, out=self.folder / "a").csv,
                                 evod.sweep(experiment, **sweep, out=self.folder / "b").csv)
            part = "parts/cell-0-replicate-0.csv"
            self.assertEqual((self.folder / "a" / part).read_text(), (self.folder / "b" / part).read_text())
            shutil.rmtree(self.folder / "a"), shutil.rmtree(self.folder / "b")

    def test_wrong_arguments_are_named(self):
        self.refused(lambda: evod.run_table(SMALL), "generations")
        self.refused(lambda: evod.run_table(SMALL, generations=0), "generations")
        self.refused(lambda: evod.run_table(SMALL, generations=-1), "generations")
        self.refused(lambda: evod.run_table(SMALL, generations=1, seed="one"), "seed")
        self.refused(lambda: evod.run_table(SMALL, generations=1, threads=0), "threads")
        error = self.refused(lambda: evod.run_table(SMALL, generations=1, population_size=0, selektion="best",
                                                    colour=1),
                             "population_size", "selektion", "colour")
        copy = pickle.loads(pickle.dumps(error))
        self.assertEqual((type(copy), copy.violations), (evod.InvalidArgument, error.violations))
        with self.assertRaisesRegex(FileNotFoundError, "there is no file nowhere.json"):
            evod.run_table("nowhere.json", generations=1)

    def test_variables_of_mpirun_do_not_reach_the_program(self):
        script = self.folder / "evod"
        script.write_text(f'#!/bin/sh\nenv >>"{self.folder}/env"\nexec "{PROGRAM}" "$@"\n')
        script.chmod(0o700)
        with mock.patch.dict(os.environ, IN_A_JOB), concurrent.futures.ThreadPoolExecutor(1) as executor:
            for given in ({}, {"executor": executor}):
                evod.sweep(SMALL, grid={"mutation_chance": [0.1]}, generations=1, program=script, **given)
            evod.run_table(SMALL, seed=1, generations=2, program=script)
            evod.local(seed=1, experiment=SMALL, program=script).close()
        names = {line.partition("=")[0] for line in (self.folder / "env").read_text().splitlines()}
        self.assertIn("PATH", names)
        self.assertEqual(names & set(IN_A_JOB), set())


class Sweeps(Temporary):
    def expected(self, sweep):
        """The table of `evod sweep` for a sweep file."""
        program("sweep", self.file("s.json", sweep), "--out", self.folder / "of-program", "--jobs", 2)
        return read(self.folder / "of-program" / "runs.csv")

    def test_threads_and_processes_give_the_same_table(self):
        arguments = {"grid": GRID, "replicates": 12, "seed": 4, "generations": 2}
        expected = self.expected({"experiment": SMALL, **arguments})
        without = evod.sweep(SMALL, **arguments)
        for executor in (concurrent.futures.ThreadPoolExecutor(2), processes()):
            with executor:
                sweep = evod.sweep(SMALL, executor=executor, **arguments)
            pandas.testing.assert_frame_equal(sweep.runs, expected, check_exact=True)
            self.assertEqual(sweep.csv, without.csv)
            self.assertEqual((sweep.cell_count, sweep.replicates, sweep.seed), (6, 12, 4))
            self.assertEqual(sweep.seeds, without.seeds)
            self.assertEqual(list(sweep.seeds), list(expected.seed[:24:2]))
            self.assertEqual(sweep.parameters, ("mutation_chance", "shuffle_fitness"))

    def test_lists_hypercubes_and_files_give_the_same_table(self):
        islands = self.file("islands.json", {**SMALL, "seed": 3, "island_count": 2, "stagnation_limit": 2,
                                             "mutation_chance": {"1": 0.5, "3": 0.1}})
        cells = [{"population_size": 8}, {"controller": "network"}, {"mutation_chance": 0.3, "free_genes": 1}]
        cube = {"samples": 3, "parameters": {"mutation_chance": {"from": 0.1, "to": 0.3},
                                             "selection": ["random", "roulette"]}}
        with concurrent.futures.ThreadPoolExecutor(2) as executor:
            for design in ({"list": cells}, {"latin_hypercube": cube}):
                expected = self.expected({"experiment": "islands.json", **design, "replicates": 2})
                sweep = evod.sweep(islands, **design, replicates=2, executor=executor)
                pandas.testing.assert_frame_equal(sweep.runs, expected, check_exact=True)
                self.assertEqual(sweep.csv, evod.sweep(islands, **design, replicates=2).csv)
                shutil.rmtree(self.folder / "of-program")

    def test_each_way_resumes_the_other(self):
        arguments = {"grid": {"mutation_chance": [0.1, 0.2]}, "replicates": 2, "generations": 2,
                     "out": self.folder / "out"}
        parts = self.folder / "out" / "parts"
        with concurrent.futures.ThreadPoolExecutor(1) as executor:
            whole = evod.sweep(SMALL, executor=executor, **arguments).csv
            kept = {path.name: path.read_bytes() for path in parts.iterdir()}
            for more in ({}, {"executor": executor}):
                for name in ("cell-0-replicate-1.csv", "cell-1-replicate-0.csv"):
                    (parts / name).unlink()
                (parts / "cell-1-replicate-1.csv").write_bytes(kept["cell-1-replicate-1.csv"][:-9])
                with mock.patch.object(executor, "submit", wraps=executor.submit) as submit:
                    self.assertEqual(evod.sweep(SMALL, **arguments, **more).csv, whole)
                self.assertEqual(submit.call_count, 3 if more else 0)
                self.assertEqual({path.name: path.read_bytes() for path in parts.iterdir()}, kept)
            evod.sweep(SMALL, executor=mock.Mock(spec=concurrent.futures.Executor), **arguments)  # submits nothing
            error = self.refused(lambda: evod.sweep(SMALL, executor=executor, **{**arguments, "generations": 3}),
                                 "parameters", "sweep file")
        self.assertIn("name another folder with out", str(error))

    def test_wrong_arguments_are_named(self):
        with concurrent.futures.ThreadPoolExecutor(1) as executor:
            self.refused(lambda: evod.sweep(SMALL, grid={"selecton": ["random"]}, generations=1, executor=executor),
                         "grid.selecton")
            self.refused(lambda: evod.sweep(SMALL, grid=GRID, generations=1, executor=executor, jobs=2), "jobs")
            self.refused(lambda: evod.sweep(SMALL, grid=GRID, executor=executor), "generations")
        self.refused(lambda: evod.sweep(SMALL, grid=GRID, generations=1, executor="threads"), "executor")

    def test_a_bar_shows_the_finished_runs(self):
        shown = []

        @contextlib.contextmanager
        def bar(what, total, wanted):
            yield shown.append

        with mock.patch("evod.experiments.progress_bar", bar), concurrent.futures.ThreadPoolExecutor(2) as executor:
            evod.sweep(SMALL, grid={"mutation_chance": [0.1, 0.2]}, replicates=2, generations=1, executor=executor)
        self.assertEqual(shown, [0, 0.25, 0.5, 0.75, 1])


class Failures(Temporary):
    def fails_in_cell_1(self):
        """A program that fails in one run of a sweep of mutation_chance, and is evod otherwise."""
        path = self.folder / "evod"
        path.write_text(f'#!/bin/sh\ncase "$*" in\n  *"--run 1 "*) echo "evod: no memory is left" >&2; exit 1\n'
                        f'esac\nexec "{PROGRAM}" "$@"\n')
        path.chmod(0o700)
        return path

    def test_a_failed_run_is_named_and_the_others_end(self):
        for executor in (concurrent.futures.ThreadPoolExecutor(2), processes()):
            with executor, self.assertRaises(evod.ProgramFailed) as raised:
                evod.sweep(LONG, list=[{"mutation_chance": chance} for chance in (0.1, 0.2, 0.3, 0.4)],
                           executor=executor,
                           program=self.fails_in_cell_1())
            self.assertEqual(str(raised.exception), "cell 1 (mutation_chance 0.2), replicate 0: no memory is left")
            self.assertEqual(runs_below(), [])

    def test_finished_runs_are_kept(self):
        arguments = {"grid": {"mutation_chance": [0.1, 0.2]}, "generations": 1, "out": self.folder / "out"}
        with concurrent.futures.ThreadPoolExecutor(1) as executor:
            with self.assertRaises(evod.ProgramFailed):
                evod.sweep(SMALL, executor=executor, program=self.fails_in_cell_1(), **arguments)
            self.assertEqual(os.listdir(self.folder / "out" / "parts"), ["cell-0-replicate-0.csv"])
            self.assertEqual(len(evod.sweep(SMALL, executor=executor, **arguments).runs), 2)

    def test_a_lost_worker_is_an_error_with_the_run(self):
        executor, runs = processes(), []

        def kill():
            runs.extend(waiting.until(runs_below, "a run"))
            for worker in list(executor._processes.values()):
                worker.kill()

        killer = threading.Thread(target=kill)
        killer.start()
        with executor, self.assertRaisesRegex(evod.ProgramFailed,
                                              r"^cell 0 \(mutation_chance 0.1\), replicate 0: Broken"):
            evod.sweep(LONG, grid={"mutation_chance": [0.1]}, executor=executor)
        killer.join()
        waiting.until(lambda: not any(map(is_run, runs)), "the end of the run without its worker")

    def test_another_build_of_a_worker_is_refused(self):
        with mock.patch.object(executor_sweep, "_build_of", lambda *_: "evod: 9.9"), \
                concurrent.futures.ThreadPoolExecutor(1) as executor, \
                self.assertRaisesRegex(evod.ProgramFailed, r"^cell 0 .* is another build of evod \(evod: 9.9\) than "
                                                           r"that of the "
                                                           r"sweep \(evod: \d.*, model: \d+\): install the same build"):
            evod.sweep(SMALL, grid={"mutation_chance": [0.1]}, generations=1, executor=executor)

    def interrupted(self, executor, interrupt, before=""):
        """Starts a sweep in a process of its own. Asserts that it ends after interrupt(process), with its runs."""
        script = (f"import concurrent.futures, evod\n{before}with {executor} as executor:\n"
                  f"    evod.sweep({LONG!r}, grid={{'mutation_chance': [0.1, 0.2, 0.3]}}, executor=executor)\n")
        process = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        waiting.until(lambda: len(runs_below()) == 2, "two runs")
        interrupt(process)
        _, errors = waiting.communicate(process)
        self.assertEqual((process.returncode, errors.splitlines()[-1]), (-signal.SIGINT, "KeyboardInterrupt"), errors)
        self.assertEqual(runs_below(), [])

    def test_an_interrupted_sweep_stops_its_runs(self):
        for executor in ("concurrent.futures.ThreadPoolExecutor(2)", "concurrent.futures.ProcessPoolExecutor(2)"):
            # Only to this process, unlike Ctrl-C on a terminal.
            self.interrupted(executor, lambda process: process.send_signal(signal.SIGINT))

    def test_a_sweep_notices_a_signal_just_before_a_wait(self):
        # Such a signal does not interrupt the wait. Neither does one that another thread receives.
        before = ("import signal, sys, threading\n"
                  "def interrupt():\n    sys.stdin.readline()\n    signal.pthread_kill(threading.get_ident(), "
                  "signal.SIGINT)\n"
                  "threading.Thread(target=interrupt, daemon=True).start()\n")
        self.interrupted("concurrent.futures.ThreadPoolExecutor(2)",
                         lambda process: print(file=process.stdin, flush=True), before)

    def test_a_cancelled_task_stops_its_runs(self):
        async def cancel(executor):
            sweep = asyncio.create_task(evod.aio.sweep(LONG, grid={"mutation_chance": [0.1, 0.2]}, executor=executor))
            while not runs_below() and not sweep.done():
                await asyncio.sleep(0.01)
            sweep.cancel()
            with self.assertRaises(asyncio.CancelledError):
                await sweep

        with concurrent.futures.ThreadPoolExecutor(1) as executor:
            asyncio.run(cancel(executor))
        self.assertEqual(runs_below(), [])


@unittest.skipUnless(has("dask", "distributed"), "Dask is not installed: scripts/setup mpi")
class Dask(Temporary):
    def test_a_cluster_gives_the_same_table(self):
        import distributed

        arguments = {"grid": GRID, "replicates": 2, "seed": 4, "generations": 2}
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, \
                distributed.Client(cluster) as client:
            self.refused(lambda: evod.sweep(SMALL, executor=client, **arguments), "executor")
            sweep = evod.sweep(SMALL, executor=client.get_executor(), **arguments)
            self.assertEqual(sweep.csv, evod.sweep(SMALL, **arguments).csv)
            table = client.submit(evod.run_table, SMALL, seed=5, generations=2).result()
            pandas.testing.assert_frame_equal(table, evod.run_table(SMALL, seed=5, generations=2))
            failing = {"list": [{"mutation_chance": 0.1}, {"mutation_chance": 0.2}], "program": "/nowhere/evod"}
            with self.assertRaises(evod.FileNotFound):
                evod.sweep(SMALL, generations=1, executor=client.get_executor(), **failing)
            waiting.until(lambda: not runs_below(), "the end of all runs")


OF_MPI = """
import sys, evod, mpi4py.futures
if __name__ == "__main__":
    with mpi4py.futures.MPIPoolExecutor() as executor:
        sweep = evod.sweep({small}, executor=executor, **{arguments})
        print(executor.submit(evod.run_table, {small}, seed=5, generations=2).result().fitness_mean.tolist())
    open(sys.argv[1], "w").write(sweep.csv)
"""


@unittest.skipUnless(has("mpi4py") and shutil.which("mpirun"), "mpi4py is not installed: scripts/setup mpi")
class Mpi(Temporary):
    def test_processes_of_mpirun_give_the_same_table(self):
        arguments = {"grid": GRID, "replicates": 2, "seed": 4, "generations": 2}
        script = self.folder / "sweep.py"
        script.write_text(OF_MPI.format(small=SMALL, arguments=arguments))
        command = ["mpirun", "-n", "3", sys.executable, "-m", "mpi4py.futures", str(script),
                   str(self.folder / "runs.csv")]
        done = waiting.run(command, capture_output=True, text=True, env={**os.environ, **OPEN_MPI})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual((self.folder / "runs.csv").read_text(), evod.sweep(SMALL, **arguments).csv)
        self.assertEqual(done.stdout.strip(), str(evod.run_table(SMALL, seed=5, generations=2).fitness_mean.tolist()))


if __name__ == "__main__":
    unittest.main()
