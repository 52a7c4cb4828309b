"""client/r/evod.R reads run files and tables exactly. EVOD names the program. It needs Rscript and RSQLite."""
import csv
import io
import json
import os
import pathlib
import re
import sqlite3
import struct
import subprocess
import tempfile
import unittest

import waiting

EVOD = os.environ["EVOD"]
LIBRARY = pathlib.Path(__file__).resolve().parents[2] / "client/r/evod.R"
SEED = 2**64 - 3  # a number of R cannot hold it
CHOICES = ["relu", "tanh", "1"]
LIST = [{"name": "free0", "min": 0, "max": 1}, {"name": "free1", "choices": CHOICES}]
SMALL = {"population_size": 12, "generation_s": 2, "island_count": 2}


def done(*words):
    ended = waiting.run([*map(str, words)], capture_output=True, text=True)
    assert ended.returncode == 0, f"{words}\n{ended.stdout}\n{ended.stderr}"
    return ended.stdout


def rows_of(text):
    return list(csv.DictReader(line for line in io.StringIO(text) if not line.startswith("#")))


class R(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        (cls.folder / "small.json").write_text(json.dumps({**SMALL, "free_genes": LIST}))
        cls.run_file = cls.folder / "small.evod"
        done(EVOD, "run", cls.folder / "small.json", "--seed", SEED, "--generations", 3, "--run-file", cls.run_file,
             "--csv", cls.folder / "run.csv")
        sweep = {"experiment": SMALL, "grid": {"selection": ["random", "tournament"]}, "replicates": 2, "seed": 7,
                 "generations": 3, "seeds": [SEED, SEED - 2]}
        (cls.folder / "sweep.json").write_text(json.dumps(sweep))
        subprocess.run([EVOD, "sweep", "sweep.json"], cwd=cls.folder, check=True, capture_output=True)

    def table(self, *lines):
        """The data frame of the last line as rows of texts, with all digits."""
        script = self.folder / "test.R"
        written = "write.csv(format_all(found), row.names = FALSE, quote = FALSE)"
        format_all = "format_all <- function(rows) { for (name in names(rows)) if (is.double(rows[[name]])) " \
                     "rows[[name]] <- sprintf('%.17g', rows[[name]]); rows }"
        script.write_text("\n".join([f"source('{LIBRARY}')", format_all, *lines[:-1], f"found <- {lines[-1]}",
                                     written]))  # fmt: skip
        return rows_of(done("Rscript", "--vanilla", script))

    def assert_equal_numbers(self, rows, expected, names):
        self.assertEqual(len(rows), len(expected))
        for name in names:
            self.assertEqual([float(row[name]) for row in rows], [float(row[name]) for row in expected], name)

    def test_a_run_file_is_read_exactly(self):
        rows = self.table(f"run <- open_run('{self.run_file}')", "as.data.frame(run_settings(run)['seed'])")
        self.assertEqual(rows, [{"seed": str(SEED)}])
        exported = rows_of(done(EVOD, "export", self.run_file, "--what", "generations"))
        rows = self.table(f"run <- open_run('{self.run_file}')", "run_generations(run)")
        self.assert_equal_numbers(rows, exported, [name for name in rows[0] if name in exported[0]])
        self.assertGreater(len(rows[0]), 30)

    def test_organisms_have_their_genes_and_parents(self):
        exported = [row for row in rows_of(done(EVOD, "export", self.run_file, "--what", "organisms"))
                    if row["generation"] == "2"]
        rows = self.table(f"run <- open_run('{self.run_file}')", "run_organisms(run, 2)")
        names = ("island", "organism", "body_size", "poison_radius", "free0", "fitness", "parent_first",
                 "parent_second")
        self.assertEqual([float(row["parent_first"]) for row in rows], [float(row["parent_first"]) for row in exported])
        for row in exported:  # genes are 32-bit floats, which the export writes with their shortest digits
            row.update((gene, self.as_float32(row[gene])) for gene in names[2:5])
        self.assert_equal_numbers(rows, exported, names)
        self.assertEqual([row["free1"] for row in rows], [row["free1"] for row in exported])
        self.assertLess(1, len({row["free1"] for row in rows} & set(CHOICES)))

    def as_float32(self, text):
        return struct.unpack("<f", struct.pack("<f", float(text)))[0]

    def test_hashes_of_64_bits_are_exact(self):
        with sqlite3.connect(self.run_file) as run:
            expected = [str(low) for low, in run.execute("SELECT low FROM state_hash ORDER BY tick")]
        rows = self.table(f"run <- open_run('{self.run_file}')",
                          "DBI::dbGetQuery(run, 'SELECT low FROM state_hash ORDER BY tick')")
        self.assertEqual([row["low"] for row in rows], expected)

    def test_tables_of_sweeps_and_runs_are_read_exactly(self):
        for path in self.folder / "sweep/runs.csv", self.folder / "run.csv":
            expected = rows_of(path.read_text())
            rows = self.table(f"read_evod_csv('{path}')")
            self.assert_equal_numbers(rows, expected, ("generation", "fitness_best", "fitness_mean", "diversity"))
            if "seed" in expected[0]:
                self.assertEqual({row["seed"] for row in rows}, {str(SEED), str(SEED - 2)})

    def test_the_script_prints_a_table_and_draws(self):
        for path, seed in ((self.run_file, f"seed {SEED}"),
                           (self.folder / "sweep/runs.csv", f"seeds {SEED}, {SEED - 2}"),
                           (self.folder / "run.csv", "fitness_mean")):
            figure = self.folder / "figure.png"
            printed = done("Rscript", "--vanilla", LIBRARY, path, figure)
            self.assertIn(seed, printed)
            self.assertRegex(printed, r"fitness_best +fitness_mean")
            self.assertTrue(figure.read_bytes().startswith(b"\x89PNG"))
            figure.unlink()
        best = max(float(row["fitness_best"]) for row in rows_of((self.folder / "run.csv").read_text())
                   if row["generation"] == "3")
        self.assertTrue(re.search(rf"^ +3 +{f'{best:.9f}'[:-7]}", printed, re.M), printed)

    def test_mistakes_are_named(self):
        for words, message in (([], "write: Rscript evod.R FILE"),
                               ([self.run_file, "x.bmp"], "ends in .png, .svg or .pdf")):
            command = ["Rscript", "--vanilla", str(LIBRARY), *map(str, words)]
            ended = waiting.run(command, capture_output=True, text=True)
            self.assertNotEqual(ended.returncode, 0)
            self.assertIn(message, ended.stderr)


if __name__ == "__main__":
    unittest.main()
