"""evod sweep as a user meets it: grids, kills, job arrays. EVOD names the program."""
import csv
import io
import json
import os
import pathlib
import re
import shutil
import signal
import sqlite3
import subprocess
import tempfile
import unittest

import waiting

EVOD = os.environ["EVOD"]
ROOT = pathlib.Path(__file__).resolve().parents[2]
SMALL = {
    "experiment": {"population_size": 12, "generation_s": 2, "food_count": 10},
    "grid": {"selection": ["roulette", "tournament"], "mutation_chance": [0.05, 0.5]},
    "replicates": 3,
    "seed": 7,
    "generations": 4,
}


def evod(*arguments, status=0, cwd=None):
    done = waiting.run([EVOD, *map(str, arguments)], capture_output=True, text=True, cwd=cwd)
    assert done.returncode == status, f"status {done.returncode}, wanted {status}\n{done.stdout}\n{done.stderr}"
    return done


def rows_of(table):
    text = table.read_text()
    comment = [line for line in text.splitlines() if line.startswith("#")]
    return comment, list(csv.DictReader(io.StringIO("\n".join(text.splitlines()[len(comment):]))))


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, sweep, name="small.json"):
        path = self.folder / name
        path.write_text(sweep if isinstance(sweep, str) else json.dumps(sweep, indent=2))
        return path

    def swept(self, sweep, *options):
        """runs.csv of a sweep that was not interrupted."""
        out = self.folder / f"undisturbed-{len(list(self.folder.iterdir()))}"
        evod("sweep", sweep, "--out", out, *options)
        return (out / "runs.csv").read_bytes()


class Sweep(Folder):
    def test_the_table_is_tidy_and_states_its_origin(self):
        sweep = self.file(SMALL)
        done = evod("sweep", sweep, "--jobs", 2, cwd=self.folder)
        self.assertIn("4 cells of 3 replicates, 12 runs, seed 7; into small\n", done.stdout)
        self.assertRegex(done.stdout, r"12 runs in [\d.]+ s, [\d.e+]+ per second; 2 at a time, each [\d.]+ % busy")
        self.assertIn("small/runs.csv: 48 rows; runs by outcome: generation_limit 12", done.stdout)
        comment, rows = rows_of(self.folder / "small/runs.csv")
        self.assertEqual((self.folder / "small/sweep.txt").read_text().splitlines(), comment)
        for words in ("# seed: 7", "# runs: 12: 4 cells of 3 replicates", "# model: ",
                      "# evod: " + evod("--version").stdout.split()[1]):
            self.assertTrue(any(line.startswith(words) for line in comment), words)
        said = [line[4:] for line in comment[comment.index("# sweep file: ") + 1:]]
        self.assertEqual(json.loads("\n".join(said)), SMALL)

        self.assertEqual([(r["cell"], r["replicate"], r["generation"], r["island"]) for r in rows],
                         [(str(c), str(r), str(g), "0") for c in range(4) for r in range(3) for g in range(1, 5)])
        self.assertEqual({(r["cell"], r["selection"], r["mutation_chance"]) for r in rows},
                         {("0", "roulette", "0.05"), ("1", "roulette", "0.5"), ("2", "tournament", "0.05"),
                          ("3", "tournament", "0.5")})
        seeds = dict((r["replicate"], r["seed"]) for r in rows)
        self.assertEqual(len(set(seeds.values())), 3)
        self.assertEqual({(r["replicate"], r["seed"]) for r in rows}, set(seeds.items()))  # in each cell the same
        self.assertIn("seeds of the replicates: " + " ".join(seeds[str(r)] for r in range(3)), done.stdout)

    def test_a_run_is_the_one_that_evod_run_makes(self):
        evod("sweep", self.file(SMALL), cwd=self.folder)
        _, rows = rows_of(self.folder / "small/runs.csv")
        mine = [row for row in rows if (row["cell"], row["replicate"]) == ("3", "1")]
        alone = self.folder / "alone.csv"
        evod("run", self.file(SMALL["experiment"], "experiment.json"), "--seed", mine[0]["seed"], "--generations", 4,
             "--set",
             "selection=tournament", "--set", "mutation_chance=0.5", "--csv", alone)
        _, expected = rows_of(alone)
        self.assertEqual(len(expected), 4)
        for row, other in zip(mine, expected, strict=True):
            self.assertEqual({name: row[name] for name in other}, other)

    def test_jobs_and_arrays_do_not_change_the_table(self):
        # Runs of very different lengths, islands, and runs that end by themselves.
        sweep = self.file({"experiment": {"generation_s": 2, "population_size": 10}, "replicates": 2, "list": [
            {"generation_limit": 6}, {"population_size": 60, "generation_limit": 3},
            {"island_count": 3, "generation_limit": 2, "migration": "ring"},
            {"food_count": 0, "stop_at_extinction": True, "health_loss_per_s": 200},
            {"fitness": "gene_sum", "mutation_chance": 0, "stagnation_limit": 2}]})
        one = self.swept(sweep, "--jobs", 1)
        self.assertEqual(one, self.swept(sweep, "--jobs", 2))
        self.assertEqual(one, self.swept(sweep, "--jobs", 30))
        out = self.folder / "array"
        for cell in (4, 0, 3, 1):  # in any order
            done = evod("sweep", sweep, "--out", out, "--array-index", cell, "--jobs", 2)
            self.assertIn(f"only cell {cell}", done.stdout)
            self.assertFalse((out / "runs.csv").exists())
        done = evod("sweep", sweep, "--out", out, "--gather", status=1)
        self.assertIn("2 of 10 runs are missing: cell-2-replicate-0, cell-2-replicate-1", done.stderr)
        self.assertFalse((out / "runs.csv").exists())
        evod("sweep", sweep, "--out", out, "--array-index", 2)
        done = evod("sweep", sweep, "--out", out, "--gather")
        self.assertIn("runs by outcome: extinction 2, stagnation_limit 2, generation_limit 6", done.stdout)
        self.assertEqual(one, (out / "runs.csv").read_bytes())
        again = evod("sweep", sweep, "--out", out)  # all is there: nothing is run
        self.assertIn("10 finished before", again.stdout)
        self.assertNotIn("busy", again.stdout)
        self.assertEqual(one, (out / "runs.csv").read_bytes())

    def test_tasks_of_an_array_may_run_at_once(self):
        sweep, out = self.file(SMALL), self.folder / "array"
        tasks = [subprocess.Popen([EVOD, "sweep", sweep, "--out", out, "--array-index", str(cell % 4)],
                                  stdout=subprocess.DEVNULL) for cell in range(8)]  # each of them twice
        self.assertEqual([waiting.ended(task) for task in tasks], [0] * 8)
        evod("sweep", sweep, "--out", out, "--gather")
        self.assertEqual((out / "runs.csv").read_bytes(), self.swept(sweep))


class Interrupted(Folder):
    LONG = {**SMALL, "experiment": {"population_size": 40, "generation_s": 20}, "replicates": 10, "generations": 30}

    def killed_once(self, parts, out, sweep, how, *options):
        """Ends a sweep after `parts` runs, while others run; returns the number of finished runs."""
        process = subprocess.Popen([EVOD, "sweep", sweep, "--out", out, "--jobs", "2", *options],
                                   stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True)

        def enough():
            self.assertIsNone(process.poll(), "it ended before it could be ended")
            return len(list((out / "parts").glob("*.csv"))) >= parts
        waiting.until(enough, "some runs", pause_s=0.001)
        process.send_signal(how)
        said = waiting.communicate(process)[0]
        self.assertEqual(process.returncode, 130 if how != signal.SIGKILL else -how)
        self.assertFalse((out / "runs.csv").exists())
        there = list((out / "parts").glob("*.csv"))
        self.assertLess(len(there), 40)
        return len(there), said

    def test_a_killed_and_resumed_sweep_gives_the_same_bytes(self):
        sweep, out = self.file(self.LONG), self.folder / "killed"
        there = 0
        for _ in range(3):
            there, _ = self.killed_once(there + 5, out, sweep, signal.SIGKILL)
        unfinished = list((out / "parts").glob("*unfinished*"))
        done = evod("sweep", sweep, "--out", out, "--jobs", 1)
        self.assertIn(f", {there} finished before", done.stdout)
        self.assertIn(f"\n{40 - there} run", done.stdout)
        self.assertTrue(unfinished)  # a kill does leave them
        self.assertEqual(list((out / "parts").glob("*unfinished*")), [])
        self.assertEqual((out / "runs.csv").read_bytes(), self.swept(sweep))

    def test_the_same_command_resumes_after_a_signal(self):
        sweep, out = self.file(self.LONG), self.folder / "stopped"
        there = 0
        for how in (signal.SIGINT, signal.SIGTERM):
            there, said = self.killed_once(there + 3, out, sweep, how)
            self.assertIn(f"interrupted: {40 - there} runs left; the same command resumes the sweep", said)
            self.assertEqual(list((out / "parts").glob("*unfinished*")), [])
        evod("sweep", sweep, "--out", out)
        self.assertEqual((out / "runs.csv").read_bytes(), self.swept(sweep))

    def test_run_files_agree_also_after_a_kill(self):
        sweep, out = self.file(self.LONG), self.folder / "kept"
        self.killed_once(4, out, sweep, signal.SIGKILL, "--run-files")
        evod("sweep", sweep, "--out", out, "--run-files")
        files = sorted((out / "run-files").iterdir())
        self.assertEqual([file.name for file in files],
                         [f"cell-{cell}-replicate-{replicate}.evod" for cell in range(4) for replicate in range(10)])
        _, rows = rows_of(out / "runs.csv")
        names = set()
        for file in files[::7]:
            self.assertIn("everything agrees: 30 generations", evod("verify", file).stdout)
            _, cell, _, replicate = file.stem.split("-")
            mine = [row for row in rows if (row["cell"], row["replicate"]) == (cell, replicate)]
            exported = io.StringIO(evod("export", file, "--what", "generations").stdout)
            for row, other in zip(mine, csv.DictReader(exported), strict=True):
                self.assertEqual({name: row[name] for name in other}, other)
            with sqlite3.connect(f"file:{file}?immutable=1", uri=True) as database:
                values = dict(database.execute("SELECT key, value FROM run"))
            self.assertEqual((values["name"], values["seed"]), (file.stem, mine[0]["seed"]))
            names.add(values["run_id"])
        self.assertEqual(len(names), len(files[::7]))
        self.assertEqual((out / "runs.csv").read_bytes(), self.swept(sweep))

    def test_run_files_that_are_missing_are_made(self):
        sweep, out = self.file(SMALL), self.folder / "later"
        evod("sweep", sweep, "--out", out)
        table = (out / "runs.csv").read_bytes()
        self.assertFalse((out / "run-files").exists())
        evod("sweep", sweep, "--out", out, "--run-files")
        (out / "run-files/cell-2-replicate-0.evod").unlink()
        done = evod("sweep", sweep, "--out", out, "--run-files")
        self.assertIn("11 finished before", done.stdout)
        self.assertIn("everything agrees", evod("verify", out / "run-files/cell-2-replicate-0.evod").stdout)
        self.assertEqual((out / "runs.csv").read_bytes(), table)

    def test_a_write_error_stops_it_with_the_reason(self):
        sweep, out = self.file(SMALL), self.folder / "shut"
        evod("sweep", sweep, "--out", out, "--array-index", 0)
        shutil.rmtree(out / "parts")
        (out / "parts").write_text("in the way")
        done = evod("sweep", sweep, "--out", out, status=1)
        self.assertRegex(done.stderr, "cannot create the folder .*/parts: ")
        (out / "parts").unlink()
        (out / "runs.csv").mkdir()
        done = evod("sweep", sweep, "--out", out, status=1)
        self.assertIn("runs.csv cannot be written: Is a directory", done.stderr)
        self.assertEqual(len(list((out / "parts").glob("*.csv"))), 12)  # nothing is lost by it


class Refused(Folder):
    def test_experiment_paths_are_relative_to_the_sweep_file(self):
        (self.folder / "deep").mkdir()
        sweep = self.file('{"list": [{}], "experiment": "../mine.json"}', "deep/small.json")
        self.file('{"generation_limit": 1, "generation_s": 1}', "mine.json")
        evod("sweep", sweep, "--out", self.folder / "out")
        self.file('{"generation_limit": 1,\n"generation_s": -1}', "mine.json")
        said = evod("sweep", sweep, "--out", self.folder / "out", status=1).stderr
        self.assertIn("experiment ../mine.json: generation_s (line 2): got -1, allowed 0.001 to 86400", said)
        # With another experiment it is another sweep.
        self.file('{"generation_limit": 2, "generation_s": 1}', "mine.json")
        said = evod("sweep", sweep, "--out", self.folder / "out", status=1).stderr
        self.assertRegex(said, r"another sweep.*\n  parameters: got \{.*\"generation_limit\": 1\}, allowed \{.*: 2\}")

    def test_wrong_usage_ends_with_status_2(self):
        sweep = self.file(SMALL)
        for arguments in ((), (sweep, "--jobs", "0"), (sweep, "--jobs", "many"), (sweep, "--array-index", "-1"),
                          (sweep, "--array-index", "x"), (sweep, "--array-index"), (sweep, "--gather", "--run-files"),
                          (sweep, "--gather", "--array-index", "0"), (sweep, "--dry-run", "--gather"),
                          (sweep, "--seed", "1"),
                          (sweep, "--gather", "--jobs", "2"), (sweep, sweep)):
            with self.subTest(arguments):
                evod("sweep", *arguments, status=2)
        said = evod("sweep", sweep, "--array-index", 4, status=1, cwd=self.folder).stderr
        self.assertIn("--array-index: got 4, allowed 0 to 3", said)
        said = evod("sweep", sweep, "--gather", status=1, cwd=self.folder).stderr
        self.assertIn("small: no such folder, so there are no results to gather", said)
        self.assertFalse((self.folder / "small").exists())
        self.assertTrue(re.search(r"--array-index.*--gather.*docs/CLUSTER\.md", evod("sweep", "--help").stdout, re.S))


if __name__ == "__main__":
    unittest.main()
