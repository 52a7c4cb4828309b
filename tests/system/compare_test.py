"""evod compare, as a user meets it: tables, verdict, CSV, plot, refusals. EVOD names the program."""
import csv
import io
import json
import os
import pathlib
import re
import signal
import statistics
import subprocess
import unittest
import xml.etree.ElementTree

import waiting
from console_test import EVOD, Folder, evod

SMALL = ["--set", "generation_s=2", "--set", "population_size=12", "--set", "food_count=60"]
ARMS = ["random_selection", "mutation_off", "harmless_poison", "shuffled_fitness"]
SVG = "{http://www.w3.org/2000/svg}"


class Compare(Folder):
    def compare(self, *words, **how):
        return evod("compare", *words, **how)

    def outputs(self, *words, name="a"):
        """What is printed, and the rows."""
        table = f"{self.folder.name}/{name}.csv"
        done = self.compare(*words, "--csv", table)
        return done.stdout, pathlib.Path(table).read_text()

    def test_the_table_agrees_with_the_csv(self):
        text, table = self.outputs("--controls", "--replicates", "8", "--generations", "6", "--seed", "3", *SMALL)
        rows = list(csv.DictReader(io.StringIO(table)))
        self.assertEqual(len(rows), 5 * 8 * 6)
        fitness = {(r["arm"], r["replicate"], int(r["generation"])): float(r["fitness_mean"]) for r in rows}
        seeds = {(r["replicate"], r["seed"]) for r in rows}
        self.assertEqual((len(seeds), len({seed for _, seed in seeds})), (8, 8))
        replicates = sorted({r["replicate"] for r in rows})
        rises = {arm: [fitness[arm, k, 6] - fitness[arm, k, 1] for k in replicates] for arm in ["default", *ARMS]}
        for arm, rise in rises.items():
            line = re.search(rf"^{arm} +\S+ +\S+ +(\S+)  (\S+) to (\S+) ", text, re.M)
            self.assertAlmostEqual(float(line[1]), statistics.mean(rise), delta=0.051)
            half = 2.3646 * statistics.stdev(rise) / 8 ** 0.5  # t(0.975, 7)
            self.assertAlmostEqual(float(line[2]), statistics.mean(rise) - half, delta=0.06)
            self.assertAlmostEqual(float(line[3]), statistics.mean(rise) + half, delta=0.06)
        found = text.split("seed by seed")[1]
        for arm in ARMS:
            differences = [a - b for a, b in zip(rises["default"], rises[arm])]
            line = re.search(rf"^{arm} +(\S+)  (\S+) to (\S+) +(\S+) +(\S+) +(\S+)$", found, re.M)
            self.assertAlmostEqual(float(line[1]), statistics.mean(differences), delta=0.051)
            g = statistics.mean(differences) / statistics.stdev(differences) * (1 - 3 / 27)
            self.assertAlmostEqual(float(line[4]), g, delta=0.0051)
            total = abs(sum(differences))
            sums = [abs(sum(d if signs >> i & 1 else -d for i, d in enumerate(differences))) for signs in range(256)]
            p = sum(s >= total - 1e-9 for s in sums) / 256
            self.assertAlmostEqual(float(line[5]), p, delta=0.01 * p)
            self.assertGreaterEqual(float(line[6]), float(line[5]))

    def test_a_control_is_a_world_that_can_be_run_alone(self):
        _, table = self.outputs("--controls", "--replicates", "2", "--generations", "4", "--seed", "3", *SMALL)
        rows = [r for r in csv.DictReader(io.StringIO(table)) if r["replicate"] == "1"]
        for arm, change in ("default", []), ("shuffled_fitness", ["--set", "shuffle_fitness=true"]), \
                ("random_selection", ["--set", "selection=random"]):
            mine = [r for r in rows if r["arm"] == arm]
            path = f"{self.folder.name}/alone.csv"
            evod("run", "--seed", mine[0]["seed"], "--generations", "4", "--csv", path, *SMALL, *change)
            alone = list(csv.DictReader(io.StringIO(pathlib.Path(path).read_text())))
            for row, expected in zip(mine, alone, strict=True):
                self.assertAlmostEqual(float(row["fitness_mean"]), float(expected["fitness_mean"]), places=9)
                self.assertEqual((row["fitness_best"], row["alive_count"]),
                                 (expected["fitness_best"], expected["alive_count"]))

    def test_the_plot_has_a_curve_and_a_band_for_each_world(self):
        files = [f"{self.folder.name}/{name}.svg" for name in "ab"]
        for file, option in zip(files, ("--plot", "--picture")):  # the second is the older name
            self.compare("--controls", "--replicates", "3", "--generations", "5", "--seed", "3", *SMALL, option, file)
        plot = pathlib.Path(files[0]).read_text()
        self.assertEqual(plot, pathlib.Path(files[1]).read_text())
        root = xml.etree.ElementTree.fromstring(plot)
        self.assertEqual(root.tag, SVG + "svg")
        groups = [group.get("id") for group in root.iter(SVG + "g")]
        for i in range(5):
            self.assertIn(f"curve-{i}", groups)
            self.assertIn(f"band-{i}", groups)
        words = [text.text for text in root.iter(SVG + "text")]
        for name in ["default", *ARMS, "generation", "default and its controls",
                     "mean fitness (seconds lived + health at the end)"]:
            self.assertIn(name, words)

    def test_a_plot_without_matplotlib_is_refused_at_once(self):
        hidden = pathlib.Path(self.folder.name) / "matplotlib.py"
        hidden.write_text("raise ImportError\n")
        done = waiting.run([EVOD, "compare", "--controls", "--plot", f"{self.folder.name}/a.svg"], capture_output=True,
                           text=True, env={**os.environ, "PYTHONPATH": self.folder.name})
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("plot_compare needs matplotlib: apt-get install python3-matplotlib", done.stderr)
        self.assertFalse(pathlib.Path(f"{self.folder.name}/a.svg").exists())

    def test_worlds_are_compared_with_the_first(self):
        tournament = self.file(json.dumps({"fitness": "gene_sum", "selection": "tournament", "seed": 9}),
                               "tournament.json")
        drifting = self.file(json.dumps({"fitness": "gene_sum", "selection": "random"}), "drifting.json")
        text, table = self.outputs(tournament, drifting, tournament, "--generations", "10", "--replicates", "10")
        self.assertIn("tournament: 10 replicates of 10 generations, from seed 9\n", text)
        self.assertRegex(text, r"\ntournament rises more than drifting, by \d+\.\d \(adjusted p = 0\.0039\)\.\n")
        self.assertIn("\nNo difference between tournament and tournament_3 is shown (adjusted p = 1).\n", text)
        self.assertRegex(text, r"\ntournament_3 +0\.0  0\.0 to 0\.0 +- +1 +1\n")
        self.assertEqual(len(list(csv.DictReader(io.StringIO(table)))), 3 * 10 * 10)

    def test_options_replace_length_and_seed_of_the_file(self):
        path = self.file('{"seed": 5, "generation_limit": 4, "stagnation_limit": 1, "stop_at_target_fitness": true,'
                         ' "target_fitness": 1, "fitness": "gene_sum"}')
        text = self.compare(path, "--controls", "--replicates", "2").stdout
        self.assertIn("mine: 2 replicates of 4 generations, from seed 5\n", text)
        text = self.compare(path, "--controls", "--replicates", "2", "--generations", "3", "--seed", "6").stdout
        self.assertIn("mine: 2 replicates of 3 generations, from seed 6\n", text)
        text = self.compare("--controls", "--replicates", "2", "--set", "fitness=gene_sum").stdout
        self.assertIn("default: 2 replicates of 60 generations, from seed ", text)

    def test_refusals_name_the_option_and_its_value(self):
        path = self.file("{}")
        for words, status, expected in (
            ([], 1, "give --controls, or two or more experiments"),
            ([path], 1, "give --controls, or two or more experiments"),
            ([path, path, "--controls"], 1, "--controls: got 2 experiments, allowed one"),
            (["--controls", "--replicates", "1"], 2, "--replicates: got 1, allowed a whole number, 2 to 10000"),
            (["--controls", "--generations", "1"], 2, "--generations: got 1, allowed a whole number, 2 to 1000000"),
            (["--controls", "--jobs", "0"], 2, "--jobs: got 0, allowed a whole number, 1 to 1024"),
            (["--controls", "--seed", "-1"], 2, "--seed"),
            (["--controls", "--set", "mutation_chance=2"], 1, "--set mutation_chance: got 2, allowed 0 to 1"),
            (["--controls", "--set", "shuffle_fitness=perhaps"], 1,
             '--set shuffle_fitness: got "perhaps", allowed true or false'),
            ([self.folder.name, "--controls"], 1, "this is a folder"),
            ([self.file('{"food_count": -3}', "bad.json"), "--controls"], 1, "food_count (line 1): got -3"),
            ([self.file('{"generation_limit": 1}', "short.json"), "--controls"], 1,
             "generation_limit: got 1, allowed at least 2"),
            (["--controls", "--csv", "/nowhere/a.csv"], 1, "--csv: cannot write /nowhere/a.csv"),
            (["--controls", "--plot", "/nowhere/a.svg"], 1, "--plot: cannot write /nowhere/a.svg"),
        ):
            with self.subTest(words):
                self.assertIn(expected, self.compare(*words, status=status).stderr)
        # What was there before a refusal is there after it.
        kept = self.file("kept", "kept.csv")
        self.compare("--controls", "--csv", kept, "--plot", "/nowhere/a.svg", status=1)
        self.assertEqual(pathlib.Path(kept).read_text(), "kept")
        new = f"{self.folder.name}/new.csv"
        self.compare("--controls", "--csv", new, "--plot", "/nowhere/a.svg", status=1)
        self.assertFalse(pathlib.Path(new).exists())

    def test_a_full_disk_is_reported(self):
        done = self.compare("--controls", "--replicates", "2", "--generations", "2", "--set", "fitness=gene_sum",
                            "--csv", "/dev/full", status=1)
        self.assertIn("--csv: cannot write /dev/full: the disk may be full", done.stderr)

    def test_an_interrupt_ends_it_without_results(self):
        table = f"{self.folder.name}/a.csv"
        process = subprocess.Popen([EVOD, "compare", "--controls", "--replicates", "1000", "--csv", table],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn("1000 replicates", process.stdout.readline())
        process.send_signal(signal.SIGINT)
        output, _ = waiting.communicate(process)
        self.assertEqual(process.returncode, 130)
        self.assertIn("interrupted: there are no results", output)
        self.assertFalse(pathlib.Path(table).exists())


if __name__ == "__main__":
    unittest.main()
