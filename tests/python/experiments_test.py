"""Whole experiments: evod.run, evod.sweep and evod.compare give what the programs give."""
import asyncio
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
from unittest import mock

import numpy
import pandas

import evod
import evod.aio
from support import Temporary

SMALL = {"population_size": 12, "generation_s": 2}


def program(*arguments, **options):
    return subprocess.run([os.environ["EVOD"], *arguments], check=True, capture_output=True, text=True,
                          **options).stdout


class Run(Temporary):
    def test_a_run_is_that_of_the_program(self):
        path = self.file("small.json", {**SMALL, "seed": 9, "mutation_chance": {"1": 0.5, "3": 0.1}})
        program("run", str(path), "--generations", "4", "--set", "selection=random", "--csv",
                str(self.folder / "x.csv"))
        with evod.run(path, generations=4, selection="random") as run:
            table, expected = run.generations(), pandas.read_csv(self.folder / "x.csv", float_precision="round_trip")
            self.assertEqual(run.seed, 9)
            self.assertEqual(run.parameters["selection"], "random")
            self.assertEqual(len(run.organisms()), 4 * 12)
            file = run.path
            self.assertTrue(file.exists())
        for name in expected.columns:
            numpy.testing.assert_array_equal(table[name], expected[name], name)
        self.assertFalse(file.parent.exists())

    def test_a_file_of_an_experiment_gives_its_name(self):
        path = self.file("walk.json", {**SMALL, "seed": 9, "generation_limit": 2})
        with evod.run(path) as run:
            self.assertEqual((run.name, len(run.generations())), ("walk", 2))

    def test_a_run_without_an_end_is_refused(self):
        self.refused(lambda: evod.run(SMALL), "generations")
        self.refused(lambda: evod.run(SMALL, generations=0), "generations")
        self.refused(lambda: evod.run(SMALL, generations=1, population_size=0, selection="best"),
                     "population_size", "selection")
        self.refused(lambda: evod.run(SMALL, generations=1, seed="one"), "seed")
        (self.folder / "broken.json").write_text("{")
        with self.assertRaisesRegex(ValueError, "broken.json: Expecting property name"):
            evod.run(self.folder / "broken.json", generations=1, selection="random")

    def test_asyncio_runs_it_too(self):
        async def both():
            runs = await asyncio.gather(*(evod.aio.run(SMALL, seed=5, generations=2) for _ in range(2)))
            return [run.generations().fitness_mean.tolist() for run in runs]

        first, second = asyncio.run(both())
        self.assertEqual(first, second)


class Sweep(Temporary):
    def test_a_sweep_is_that_of_the_program(self):
        grid = {"mutation_chance": [0.1, 0.2], "selection": ["random", "tournament"]}
        path = self.file("s.json", {"experiment": SMALL, "grid": grid, "replicates": 2, "seed": 4, "generations": 3})
        program("sweep", str(path), "--out", str(self.folder / "s"))
        expected = pandas.read_csv(self.folder / "s" / "runs.csv", comment="#", float_precision="round_trip")
        of_arrays = {**grid, "mutation_chance": numpy.array([0.1, 0.2])}
        sweep = evod.sweep(SMALL, grid=of_arrays, replicates=2, seed=4, generations=3)
        self.assertEqual((sweep.cell_count, sweep.replicates, sweep.seed), (4, 2, 4))
        self.assertEqual(sweep.parameters, ("mutation_chance", "selection"))
        self.assertEqual(list(sweep.seeds), list(expected.seed[:6:3]))
        pandas.testing.assert_frame_equal(sweep.runs, expected)
        self.assertEqual(len(sweep.last), 8)
        self.assertEqual(set(sweep.last.generation), {3})

    def test_a_cancelled_sweep_stops_the_program(self):
        script = self.folder / "evod"
        script.write_text(f"#!/bin/sh\necho $$ >{self.folder}/pid.new; mv {self.folder}/pid.new {self.folder}/pid; "
                          "exec sleep 600\n")
        script.chmod(0o700)

        async def cancel():
            sweep = asyncio.create_task(evod.aio.sweep(grid={"mutation_chance": [0.1]}, generations=1, program=script))
            while not (self.folder / "pid").exists():
                await asyncio.sleep(0.01)
            sweep.cancel()
            with self.assertRaises(asyncio.CancelledError):
                await sweep

        asyncio.run(cancel())
        with self.assertRaises(ProcessLookupError):
            os.kill(int((self.folder / "pid").read_text()), 0)

    def test_wrong_arguments_are_named(self):
        self.refused(lambda: evod.sweep(SMALL, grid={"selecton": ["random"]}, replicates=0, generations=1,
                                        fitness="best"),
                     "replicates", "grid.selecton", "experiment.fitness")
        self.refused(lambda: evod.sweep(SMALL, generations=1), "grid")
        self.refused(lambda: evod.sweep(SMALL, grid={"mutation_chance": [0.1]}, generations=1, jobs=0), "jobs")
        with self.assertRaisesRegex(FileNotFoundError, "there is no file nowhere.json"):
            evod.sweep("nowhere.json", grid={"mutation_chance": [0.1]}, generations=1)


class Compare(Temporary):
    def test_a_comparison_is_that_of_the_program(self):
        path = self.file("world.json", SMALL)
        report = program("compare", str(path), "--controls", "--replicates", "3", "--generations", "4", "--seed", "2")
        compared = evod.compare(path, replicates=3, generations=4, seed=2)
        self.assertEqual(str(compared), report)
        names = ["world", "random_selection", "mutation_off", "harmless_poison", "shuffled_fitness"]
        self.assertEqual([world.name for world in compared.worlds], names)
        self.assertEqual([difference.other for difference in compared.differences], names[1:])
        self.assertTrue(compared.verdict.startswith("Did evolution do it? "))
        self.assertEqual(compared.worlds[1].changes, "selection=random")
        fitness = compared.fitness.groupby(["arm", "generation"]).fitness_mean.mean().unstack("generation")
        for world in compared.worlds:
            self.assertAlmostEqual(world.first, fitness[1][world.name], delta=0.06)
            self.assertAlmostEqual(world.last, fitness[4][world.name], delta=0.06)
            self.assertLessEqual(world.rise_low, world.rise)
            self.assertLessEqual(world.rise, world.rise_high)
        table = compared.to_pandas()
        self.assertEqual(list(table.index), names)
        self.assertEqual(table["p"]["mutation_off"], compared.differences[1].p)
        self.assertIn(compared.verdict[:20], compared._repr_html_())

    def test_worlds_have_the_given_names(self):
        calm = self.file("calm.json", {**SMALL, "poison_count": 0})
        compared = evod.compare(calm, SMALL, names=["calm sea", "rough"], replicates=2, generations=2, seed=1,
                                selection="random")
        self.assertEqual([difference.other for difference in compared.differences], ["rough"])
        self.assertEqual(len(compared.fitness), 8)
        (self.folder / "other").mkdir()
        same = evod.compare(calm, self.file("other/calm.json", SMALL), replicates=2, generations=2, seed=1,
                            selection="random")
        self.assertNotEqual(same.worlds[0].first, same.worlds[1].first)
        named = evod.compare(calm, SMALL, replicates=2, generations=2, seed=1)
        self.assertEqual([world.name for world in named.worlds], ["calm", "experiment_2"])

    def test_a_control_that_cannot_differ_is_left_out(self):
        compared = evod.compare({**SMALL, "mutation_chance": 0}, replicates=2, generations=2, seed=1)
        self.assertNotIn("mutation_off", [world.name for world in compared.worlds])
        self.assertIn("mutation_off     is not run", compared.report)

    def test_wrong_arguments_are_named(self):
        self.refused(lambda: evod.compare(SMALL, replicates=1), "replicates")
        self.refused(lambda: evod.compare({"selection": "best"}, SMALL), "selection")
        self.refused(lambda: evod.compare(SMALL, SMALL, controls=True), "controls")
        self.refused(lambda: evod.compare(SMALL, SMALL, names=["a"]), "names")
        self.refused(lambda: evod.compare(SMALL, names=["a/b"]), "names")


class Bar:
    """Stands for tqdm: records what is shown."""

    made = []

    def __init__(self, *, desc, total, bar_format, disable):
        self.desc, self.total, self.n, self.disable = desc, total, 0, disable is None
        self.made.append(self)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def update(self, more):
        assert more >= 0, more
        self.n += more


class Progress(unittest.TestCase):
    def setUp(self):
        Bar.made = []
        tqdm = types.ModuleType("tqdm.auto")
        tqdm.tqdm = Bar
        patch = mock.patch.dict(sys.modules, {"tqdm": types.ModuleType("tqdm"), "tqdm.auto": tqdm})
        patch.start()
        self.addCleanup(patch.stop)

    def test_bars_reach_their_end(self):
        evod.run(SMALL, generations=3, progress=True).close()
        evod.sweep(SMALL, grid={"mutation_chance": [0.1, 0.2]}, generations=2, progress=True)
        evod.compare(SMALL, replicates=2, generations=2, progress=True)
        self.assertEqual([(bar.desc, bar.total, bar.n) for bar in Bar.made],
                         [("run", 3, 3), ("sweep", 1.0, 1.0), ("comparison", 1.0, 1.0)])

    def test_progress_of_the_program_is_read(self):
        seen = []
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder) / "evod"
            lines = ("#!/bin/sh", """echo '{"progress":0.5}'""", """echo '{"progress":0.75}'""",
                     "echo 'evod x: --seed: bad' >&2",
                     "exit 1", "")
            script.write_text("\n".join(lines))
            script.chmod(0o700)
            with self.assertRaises(evod.ProgramFailed) as raised:
                evod.program.Program([str(script)], on_progress=seen.append).run()
        self.assertEqual(seen[-1], 0.75)  # both reports may arrive at once
        self.assertLessEqual(set(seen), {0.5, 0.75})
        self.assertIn("seed: bad", str(raised.exception))

    def test_no_bar_is_shown_without_a_terminal(self):
        with mock.patch.object(sys, "stderr", io.StringIO()):
            evod.run(SMALL, generations=1).close()
            evod.run(SMALL, generations=1, progress=False).close()
        self.assertEqual([bar.n for bar in Bar.made], [0])

    def test_a_missing_package_is_named(self):
        with mock.patch.dict(sys.modules, {"tqdm.auto": None}):
            evod.run(SMALL, generations=1).close()
            with self.assertRaisesRegex(ImportError, "need the package tqdm: install it, python3-tqdm on Debian"):
                evod.run(SMALL, generations=1, progress=True)


if __name__ == "__main__":
    unittest.main()
