"""evod run --run-file as a user meets it: kills, restarts, mpirun. EVOD names the program.

    EVOD=… [KILLS=5] [MPIRUN=…] run_test.py     MPIRUN: also under mpirun
"""
import contextlib
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import tempfile
import time
import unittest

import waiting
from open_mpi import OPEN_MPI

EVOD, KILLS, MPIRUN = os.environ["EVOD"], int(os.environ.get("KILLS", 5)), os.environ.get("MPIRUN", "")
# Four islands that exchange migrants, with a parameter that changes.
RING = {"population_size": 40, "generation_s": 4, "food_count": 100, "island_count": 4, "migration": "ring",
        "migration_epoch": 2,
        "mutation_chance": {"1": 0.3, "4": 0.05}, "generation_limit": 12, "seed": 7}


def evod(*arguments, status=0):
    done = waiting.run([EVOD, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == status, f"status {done.returncode}, wanted {status}\n{done.stdout}\n{done.stderr}"
    return done


def rows(output):
    """The rows of the table on stdout."""
    return [line for line in output.splitlines() if re.match(r" +\d+ +\d+ +\S+ ", line)]


def is_alive(pid):
    with contextlib.suppress(OSError):
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1][0] != "Z"
    return False


def state(output):
    return re.search(r"; state (\w+)", output)[1]


class Recorded(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.all = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.all.cleanup)
        cls.ring = pathlib.Path(cls.all.name) / "ring.json"
        cls.ring.write_text(json.dumps(RING))
        cls.plain_csv, cls.plain_file = cls.ring.with_suffix(".csv"), cls.ring.with_name("plain.evod")
        cls.plain = evod("run", cls.ring, "--csv", cls.plain_csv).stdout
        cls.recorded = evod("run", cls.ring, "--run-file", cls.plain_file, "--threads", 2).stdout

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.file, self.csv = self.folder / "ring.evod", self.folder / "ring.csv"

    def words(self, ranks=1, file=None):
        mpirun = [MPIRUN, "-n", str(ranks)] if ranks > 1 else []
        return [*mpirun, EVOD, "run", str(self.ring), "--threads", "1", "--run-file", str(file or self.file), "--csv",
                str(self.csv)]

    def run_to_end(self, ranks=1):
        done = waiting.run(self.words(ranks), capture_output=True, text=True, env={**os.environ, **OPEN_MPI})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def run_and_kill(self, ranks=1, rows_first=None, after_s=0.0):
        """Kills all processes of the run after so many rows and seconds. Returns its output until then."""
        process = subprocess.Popen(self.words(ranks), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                   env={**os.environ, **OPEN_MPI})
        with process.stdout:
            lines = []
            while rows_first is not None and len(rows("".join(lines))) < rows_first and (
                line := process.stdout.readline()):
                lines.append(line)
            time.sleep(after_s)  # the moment of the kill, not a wait
            below = list(waiting.descendants(process.pid))  # mpirun starts each rank in a group of its own
            for pid in [process.pid, *below]:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(int(pid), signal.SIGKILL)
            lines.append(process.stdout.read())
        process.wait()
        waiting.until(lambda: not any(is_alive(pid) for pid in below), "the end of all ranks")
        return "".join(lines)

    def tables(self, file):
        return [evod("export", file, "--what", what, *more).stdout
                for what, *more in (["generations"], ["organisms"], ["lineage"], ["population", "--generation", 12])]

    def expect_whole(self):
        """The file, and the table of the last run, equal those of an uninterrupted run."""
        self.assertEqual(self.csv.read_bytes(), self.plain_csv.read_bytes())
        verified = evod("verify", self.file).stdout
        self.assertEqual(re.search(r"everything agrees: (.*) compared", verified)[1],
                         re.search(r"everything agrees: (.*) compared", evod("verify", self.plain_file).stdout)[1])
        self.assertEqual(self.tables(self.file), self.tables(self.plain_file))
        # a reader leaves these
        beside = {path.name for path in self.folder.iterdir()} - {"ring.evod-shm", "ring.evod-wal"}
        self.assertEqual(beside, {"ring.csv", "ring.evod"})


class Run(Recorded):
    def test_a_run_with_a_file_has_the_same_results(self):
        self.assertEqual(rows(self.recorded), rows(self.plain))
        self.assertEqual(state(self.recorded), state(self.plain))
        self.assertIn("everything agrees: 12 generations", evod("verify", self.plain_file).stdout)
        self.assertEqual(evod("export", self.plain_file, "--what", "generations").stdout, self.plain_csv.read_text())

    def test_a_finished_run_is_complete(self):
        before = self.plain_file.read_bytes()
        done = evod("run", self.ring, "--run-file", self.plain_file, "--csv", self.csv)
        self.assertEqual(done.stdout, f"seed 7\n{self.plain_file} is complete: 12 generations\n")
        self.assertEqual(self.csv.read_bytes(), self.plain_csv.read_bytes())
        self.assertEqual(self.plain_file.read_bytes(), before)

    def test_an_export_may_leave_out_generations(self):
        for table in "generations", "organisms":
            lines = evod("export", self.plain_file, "--what", table, "--every", 5).stdout.splitlines()
            whole = evod("export", self.plain_file, "--what", table).stdout.splitlines()
            kept = [line for line in whole[1:] if int(line.split(",")[0]) in (5, 10, 12)]  # 12 is the last one
            self.assertEqual(lines, [whole[0], *kept])
        for words in ("--what", "events"), ("--bundle", self.ring.with_name("bundle")):
            refused = evod("export", self.plain_file, *words, "--every", 5, status=1).stderr
            self.assertIn("--every: got 5, allowed only with --what generations or organisms", refused)

    def test_more_generations_continue_a_finished_run(self):
        evod("run", self.ring, "--generations", 5, "--run-file", self.file)
        done = evod("run", self.ring, "--run-file", self.file, "--csv", self.csv)
        self.assertIn("continues at generation 5\n", done.stdout)
        self.assertEqual(state(done.stdout), state(self.plain))
        self.expect_whole()
        self.assertIn("its generation_limit is 12, not 11",
                      evod("run", self.ring, "--generations", 11, "--run-file", self.file, status=1).stderr)

    def test_a_seed_that_was_drawn_is_kept(self):
        words = ["run", "--set", "population_size=10", "--set", "generation_s=1", "--generations", "400", "--run-file",
                 self.file]
        process = subprocess.Popen([EVOD, *map(str, words)], stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        seed = process.stdout.readline()
        process.stdout.readline(), process.stdout.readline()
        # Meanwhile no other program writes to the file.
        self.assertIn("another program is writing to it", evod(*words, status=1).stderr)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(), 130)
        self.assertTrue(evod(*words).stdout.startswith(seed))

    def test_a_csv_file_has_its_name_when_it_is_complete(self):
        part = self.csv.with_name("ring.csv.part")
        words = [EVOD, "run", "--seed", "1", "--set", "population_size=10", "--set", "generation_s=1", "--csv",
                 str(self.csv)]
        for how, status in ((signal.SIGKILL, -signal.SIGKILL), (signal.SIGTERM, 130), (signal.SIGINT, 130)):
            self.csv.write_text("another run")
            with subprocess.Popen(words, stdout=subprocess.DEVNULL) as process:
                self.addCleanup(process.kill)
                waiting.until(lambda: part.exists() and part.read_text().count("\n") > 5, "rows")
                self.assertEqual(self.csv.read_text(), "another run")
                process.send_signal(how)
                self.assertEqual(waiting.ended(process), status)
            if how == signal.SIGKILL:
                self.assertEqual(self.csv.read_text(), "another run")
                part.write_text("what the ended program has left")
            else:
                self.assertGreater(self.csv.read_text().count("\n"), 5)
                self.assertFalse(part.exists())

    def test_a_run_that_was_killed_continues(self):
        chance = random.Random(1)
        for kill in range(KILLS):
            with self.subTest(kill=kill):
                for path in self.folder.iterdir():
                    path.unlink()
                # At a random moment: before the first generation, within one, or while its results are written.
                output = self.run_and_kill(rows_first=chance.choice([None, 0, 4, 16, 40]),
                                           after_s=chance.uniform(0, 0.05))
                printed = rows(output)
                self.assertEqual(printed, rows(self.plain)[:len(printed)])
                rest = self.run_to_end()
                if at := re.search(r"\ncontinues at generation (\d+)\n", rest):
                    first = int(at[1])
                    self.assertLessEqual(len(printed) // 4, first - 1, "every printed generation is in the file")
                    self.assertEqual(rows(rest), rows(self.plain)[4 * (first - 1):])
                    self.assertEqual(state(rest), state(self.plain))
                elif "is complete" not in rest:
                    self.assertEqual(rows(rest), rows(self.plain))
                    self.assertEqual(printed, [])
                self.expect_whole()


@unittest.skipUnless(MPIRUN, "evod was built without MPI")
class Processes(Recorded):
    def test_a_run_continues_on_another_number_of_processes(self):
        for ranks, rows_first in (1, 8), (2, 8), (4, 8):
            self.run_and_kill(ranks, rows_first)
        rest = self.run_to_end()
        self.assertRegex(rest, r"\ncontinues at generation ([789]|10)\n")
        self.expect_whole()

    def test_a_whole_run_of_processes_equals_one_process(self):
        self.assertEqual(rows(self.run_to_end(3)), rows(self.plain))
        self.expect_whole()

    def test_a_refusal_is_printed_once(self):
        self.file.write_text("generation,island\n" * 100)
        done = waiting.run(self.words(2), capture_output=True, text=True, env={**os.environ, **OPEN_MPI})
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(done.stderr.count("evod: "), 1, done.stderr)


if __name__ == "__main__":
    unittest.main()
