"""evod under mpirun: shared runs, shared sweeps, refusals, lost processes. EVOD names the program."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

import mpi_jobs as jobs
import waiting
from mpi_jobs import EVOD

ISLANDS = {"island_count": 8, "population_size": 10, "food_count": 10, "poison_count": 10, "generation_s": 2,
           "migration_epoch": 1, "migrant_count": 2, "generation_limit": 4}
EXPERIMENTS = {
    "ring": {**ISLANDS, "migration": "ring"},
    "fully connected": {**ISLANDS, "migration": "fully_connected", "migrant_count": 1},
    "random": {**ISLANDS, "migration": "random", "emigrants": "random", "immigrants_replace": "random"},
    "a schedule": {**ISLANDS, "migration": "ring", "mutation_chance": {"1": 0.5, "3": 0.01},
                   "food_count": {"1": 20, "2": 5}},
    # Islands die out at different ticks, and some generations end before their time.
    "extinctions": {**ISLANDS, "migration": "ring", "food_count": 2, "health_loss_per_s": 45},
}


def mpirun(processes, *words, **options):
    return [*jobs.mpirun(processes), *map(str, words)], {
        "text": True, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "env": jobs.ENVIRONMENT, **options}


def run(command, status=0):
    words, options = command
    done = waiting.run(words, **options)
    assert done.returncode == status, f"status {done.returncode}, wanted {status}\n{done.stdout}\n{done.stderr}"
    return done


def evod(*words, **options):
    """A command of one process, without mpirun."""
    return list(map(str, [EVOD, *words])), {"text": True, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE,
                                            **options}


def results(output):
    """The output without the lines that state durations."""
    lines = output.splitlines()
    last = next(number for number, line in enumerate(lines) if "; state " in line)
    return lines[:last + 1]


class Folder(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, content, name="experiment.json"):
        path = self.folder / name
        path.write_text(json.dumps(content))
        return path

    def script(self, text):
        """A program that mpirun starts in the place of evod."""
        path = self.folder / "started"
        path.write_text("#!/bin/sh\n" + text)
        path.chmod(0o755)
        return path

    def started(self, command):
        words, options = command
        job = subprocess.Popen(words, **options)

        def end():
            jobs.kill(job)
            job.communicate()
        self.addCleanup(end)
        return job


class Run(Folder):
    def test_any_number_of_processes_and_threads_gives_the_same(self):
        csv = self.folder / "statistics.csv"
        for name, content in EXPERIMENTS.items():
            file = self.file(content)
            words = ["run", file, "--seed", 7, "--csv", csv, "--threads"]
            expected, table = results(run(evod(*words, 1)).stdout), csv.read_bytes()
            self.assertEqual(table.count(b"\n"), 1 + 4 * 8)
            for processes, threads in (1, 2), (2, 1), (2, 2), (4, 1), (4, 2), (8, 1):
                with self.subTest(name, processes=processes, threads=threads):
                    csv.unlink()
                    done = run(mpirun(processes, EVOD, *words, threads))
                    self.assertEqual(results(done.stdout), expected)
                    self.assertEqual(csv.read_bytes(), table)
                    self.assertEqual(done.stderr, "")

    def test_all_processes_end_with_a_world_that_ends_by_itself(self):
        for status, changes in (3, {"fitness": "gene_sum", "mutation_chance": 0, "stagnation_limit": 2}), \
                (4, {"stop_at_extinction": True, "food_count": 0, "health_loss_per_s": 300}):
            with self.subTest(status):
                file = self.file({**ISLANDS, **changes, "generation_limit": 0})
                expected = results(run(evod("run", file, "--seed", 7), status).stdout)
                self.assertEqual(results(run(mpirun(3, EVOD, "run", file, "--seed", 7), status).stdout), expected)

    def test_only_rank_0_reads_files(self):
        file = self.file(EXPERIMENTS["ring"])
        expected = results(run(evod("run", file, "--seed", 7)).stdout)
        script = self.script(f'mkdir "{self.folder}/$OMPI_COMM_WORLD_RANK" && cd "{self.folder}/$OMPI_COMM_WORLD_RANK" '
                             '&& '
                             f'[ $OMPI_COMM_WORLD_RANK = 0 ] && cp "{file}" .\n'
                             f'exec "{EVOD}" run experiment.json --seed 7\n')
        self.assertEqual(results(run(mpirun(3, script)).stdout), expected)

    def test_a_run_without_a_seed_can_be_repeated(self):
        done = run(mpirun(2, EVOD, "run", self.file(EXPERIMENTS["ring"])))
        seed = done.stdout.split()[1]
        again = run(evod("run", self.folder / "experiment.json", "--seed", seed))
        self.assertEqual(results(again.stdout), results(done.stdout))


class Sweep(Folder):
    # Runs of very different lengths, islands, and runs that end by themselves.
    MIXED = {"experiment": {"generation_s": 2, "population_size": 10}, "replicates": 2, "list": [
        {"generation_limit": 6}, {"population_size": 60, "generation_limit": 3},
        {"island_count": 3, "generation_limit": 2, "migration": "ring"},
        {"food_count": 0, "stop_at_extinction": True, "health_loss_per_s": 200},
        {"fitness": "gene_sum", "mutation_chance": 0, "stagnation_limit": 2}]}
    # Twenty short runs, and one that takes some seconds and begins first, so that no interrupted sweep is complete.
    LONG = {"experiment": {"population_size": 40, "generation_s": 20}, "replicates": 1, "seed": 7, "list":
            [{"generation_limit": 10, "mutation_chance": chance / 100} for chance in range(1, 21)] +
            [{"generation_limit": 300, "population_size": 240}]}

    def table(self, sweep):
        """runs.csv of a sweep by one process."""
        run(evod("sweep", sweep, "--out", self.folder / "alone", "--jobs", 2))
        return (self.folder / "alone/runs.csv").read_bytes()

    def test_any_number_of_processes_writes_the_same_table(self):
        sweep = self.file(self.MIXED)
        expected = self.table(sweep)
        for processes, jobs in (2, 1), (2, 2), (4, 1):
            with self.subTest(processes=processes, jobs=jobs):
                out = self.folder / f"{processes}-{jobs}"
                done = run(mpirun(processes, EVOD, "sweep", sweep, "--out", out, "--jobs", jobs))
                self.assertEqual((out / "runs.csv").read_bytes(), expected)
                self.assertRegex(done.stdout,
                                 rf"10 runs in [\d.]+ s, [\d.e+]+ per second; {processes * jobs} at a time")
                self.assertEqual(sorted(file.name for file in out.iterdir()), ["parts", "runs.csv", "sweep.txt"])

    def test_other_numbers_of_processes_resume_a_sweep(self):
        sweep, out = self.file(self.LONG), self.folder / "interrupted"
        parts = 0
        for processes in 2, 3:
            job = self.started(mpirun(processes, EVOD, "sweep", sweep, "--out", out, "--jobs", 1))

            def enough():
                self.assertIsNone(job.poll(), "it ended before it could be ended")
                return len(list((out / "parts").glob("*.csv"))) >= parts + 2
            waiting.until(enough, "some runs", pause_s=0.001)
            job.send_signal(signal.SIGTERM)
            waiting.communicate(job)
            self.assertNotEqual(job.returncode, 0)
            self.assertFalse((out / "runs.csv").exists())
            parts = len(list((out / "parts").glob("*.csv")))
            self.assertLess(parts, 21)
        done = run(mpirun(4, EVOD, "sweep", sweep, "--out", out, "--jobs", 1))
        self.assertIn(f", {parts} finished before", done.stdout)
        self.assertEqual((out / "runs.csv").read_bytes(), self.table(sweep))

    def test_a_folder_that_is_not_shared_is_refused(self):
        sweep = self.file(self.MIXED)
        for rank in range(2):
            (self.folder / f"{rank}").mkdir()
        script = self.script(f'cd "{self.folder}/$OMPI_COMM_WORLD_RANK" && exec "{EVOD}" sweep "{sweep}" --out mine\n')
        done = run(mpirun(2, script), status=1)
        self.assertRegex(done.stderr, "evod: rank 1 on .*: mine is not the same folder as that of rank 0: name a "
                                      "folder of a "
                                      "shared file system with --out\n")
        self.assertEqual([file.name for file in self.folder.glob("*/mine/*") if file.is_file()], ["sweep.txt"] * 2)


class Refused(Folder):
    def refused(self, command, status, sentence):
        """Nothing was simulated, and no table was written."""
        done = run(command, status)
        self.assertRegex(done.stderr, sentence)
        self.assertEqual(done.stdout, "")
        self.assertEqual(list(self.folder.rglob("*.csv")), [])

    def test_more_processes_than_islands(self):
        file = self.file({**ISLANDS, "island_count": 2})
        self.refused(mpirun(3, EVOD, "run", file, "--csv", self.folder / "x.csv"), 2,
                     "evod: 3 processes cannot share 2 islands: start at most one process per island, or set "
                     "island_count\n")

    def test_processes_with_different_commands(self):
        self.file(ISLANDS, "0.json")
        self.file(ISLANDS, "1.json")
        script = self.script(f'cd "{self.folder}" && exec "{EVOD}" run "$OMPI_COMM_WORLD_RANK.json" --csv x.csv\n')
        self.refused(mpirun(2, script), 1, "evod: rank 1 on .* has read other files or options, or is another build of "
                                           "evod, "
                                           "than rank 0 on .*: start all processes with the same program and files\n")

    def test_a_missing_experiment_is_named_once(self):
        self.refused(mpirun(3, EVOD, "run", "0.json"), 1, r"^evod: .*0\.json.*\n(?!.*evod: )")

    def test_a_missing_component(self):
        alone = self.folder / "evod"
        shutil.copy(EVOD, alone)
        file = self.file(ISLANDS)
        self.refused(mpirun(2, alone, "run", file), 1,
                     "evod: this process is one of several that mpirun has started, but the component evod_mpi cannot "
                     "be "
                     "loaded: .*evod_mpi.so: .*")
        sweep = self.file(Sweep.MIXED, "sweep.json")
        self.refused(mpirun(2, alone, "sweep", sweep, "--out", self.folder / "out"), 1,
                     "Build evod with -DEVOD_BUILD_MPI=ON")
        self.assertFalse((self.folder / "out").exists())
        options = {"text": True, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        self.assertIn("ended: generation_limit", run(([str(alone), "run", str(file)], options)).stdout)
        self.assertIn("ended: generation_limit", run(mpirun(1, alone, "run", file)).stdout)

    def test_questions_and_parts_of_a_sweep(self):
        self.refused(mpirun(2, EVOD, "run", "--ask"), 2,
                     "evod: --ask: not possible with several processes; start evod run without mpirun\n")
        sweep = self.file(Sweep.MIXED)
        for option in ["--dry-run"], ["--gather"], ["--array-index", 0]:
            with self.subTest(option):
                self.refused(mpirun(2, EVOD, "sweep", sweep, *option), 1,
                             "are for one process: start it without mpirun\n")

    def test_all_other_commands(self):
        for name, words in {"evod verify": ["verify", "no.evod"], "evod compare": ["compare", "no.json", "--controls"],
                            "evod check": ["check"], "evod replay": ["replay", "no.evod"]}.items():
            with self.subTest(name):
                self.refused(mpirun(2, EVOD, *words), 2, f"evod: {name} cannot share its work among processes: start "
                                                         "it "
                                                         "without mpirun\n")
        self.assertIn("Experiments", run(mpirun(2, EVOD, "--help")).stdout)


class Lost(Folder):
    def running(self, *options):
        """A run of four processes that has ended a generation, and the processes by rank."""
        file = self.file({**EXPERIMENTS["ring"], "generation_limit": 0})
        job = self.started(mpirun(4, EVOD, "run", file, "--seed", 7, "--threads", 1, *options))
        while not (line := job.stdout.readline()).split()[:2] == ["1", "7"]:  # generation, island
            self.assertTrue(line, "it ended")
        ranks = jobs.processes_by_rank(job)
        self.assertEqual(sorted(ranks), [0, 1, 2, 3])
        return job, ranks

    def test_a_killed_process_ends_the_job(self):
        job, ranks = self.running("--rank-timeout", 600)
        os.kill(ranks[2], signal.SIGKILL)
        errors = waiting.communicate(job)[1]
        self.assertEqual(job.returncode, 128 + signal.SIGKILL)
        self.assertRegex(errors, r"process rank 2 with PID \d+ on node \S+ exited on\s+signal 9 \(Killed\)")
        self.assertNotIn("--rank-timeout", errors)

    def test_a_stopped_process_is_named(self):
        job, ranks = self.running("--rank-timeout", 1)
        os.kill(ranks[3], signal.SIGSTOP)
        errors = waiting.communicate(job)[1]
        self.assertRegex(errors, jobs.LOST.format(3, 1))
        self.assertEqual(job.returncode, jobs.EXIT_RANK_LOST)

    def test_a_stopped_rank_0_is_named_by_the_others(self):
        job, ranks = self.running("--rank-timeout", 1)
        os.kill(ranks[0], signal.SIGSTOP)
        errors = waiting.communicate(job)[1]
        self.assertRegex(errors, jobs.LOST.format(0, 1))
        self.assertEqual(job.returncode, jobs.EXIT_RANK_LOST)

    def test_rank_0_ends_all_when_it_is_interrupted(self):
        job, ranks = self.running()
        os.kill(ranks[2], signal.SIGTERM)  # the others leave signals to rank 0
        os.kill(ranks[0], signal.SIGTERM)
        output, _ = waiting.communicate(job)
        self.assertIn("ended: interrupted\n", output)
        self.assertEqual(job.returncode, 130)


if __name__ == "__main__":
    unittest.main()
