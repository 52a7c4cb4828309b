"""Sweeps and comparisons of a function in worker processes; time_to, paired_test and totals of sweeps."""
import asyncio
import itertools
import os
import sys
import textwrap
import unittest

import numpy

import evod
import evod.aio
import waiting
from evod import paired_tests
from support import Temporary

SETTING = {"free_genes": 3, "mutate_group": "free", "population_size": 12, "elite_count": 2}
GRID = {"mutation_chance": [0.05, 0.3], "selection": ["random", "tournament"]}
SCALE = 2.0


def helper(x):
    return SCALE * (x - 0.25) ** 2


def valley(genes, life):
    return helper(genes).sum(axis=1)


def sweep(function, **more):
    options = {"grid": GRID, "replicates": 2, "generations": 6, "seed": 1, "minimize": True, **more}
    return evod.sweep(SETTING, function=function, **options)


class FunctionSweeps(Temporary):
    def test_the_result_depends_on_the_function_alone(self):
        scale = 2.0

        def inner(genes, life):
            return (scale * (genes - 0.25) ** 2).sum(axis=1)

        results = [sweep(valley, jobs=1), sweep(valley, jobs=3), sweep(inner, jobs=2),
                   sweep(lambda genes, life: (2.0 * (genes - 0.25) ** 2).sum(axis=1))]
        self.assertEqual(len({result.csv for result in results}), 1)
        runs = results[0].runs
        self.assertEqual(len(runs), 4 * 2 * 6)
        self.assertEqual(list(runs.evaluations.unique()), [12 * n for n in range(1, 7)])
        self.assertTrue((runs.fitness_best <= runs.fitness_mean).all())

    def test_seeds_and_worlds_are_those_of_a_single_evaluation(self):
        result = sweep(valley)
        built_in = evod.sweep({**SETTING, "fitness": "gene_sum"}, grid=GRID, replicates=2, generations=2, seed=1)
        self.assertEqual(result.seeds, built_in.seeds)
        with evod.local() as lab:
            setting = {**SETTING, "fitness": "external", "external_bodies": False, "mutation_chance": 0.3,
                       "selection": "tournament"}
            alone = lab.create_world("alone", setting, seed=result.seeds[1]).evaluate(valley, 6, minimize=True)
        cell = result.runs.query("mutation_chance == 0.3 and selection == 'tournament' and replicate == 1")
        self.assertEqual(list(cell.fitness_best), [g.best for g in alone])

    def test_global_random_numbers_repeat(self):
        def noisy(genes, life):
            return valley(genes, life) + numpy.random.normal(size=len(genes))

        self.assertEqual(sweep(noisy, jobs=1).csv, sweep(noisy, jobs=2).csv)

    def test_a_script_without_a_main_guard_works(self):
        script = self.folder / "script.py"
        script.write_text(textwrap.dedent("""
            import evod, numpy
            print("imported")
            CENTRE = 0.25
            def distance(genes, life):
                return numpy.abs(genes - CENTRE).sum(axis=1)
            sweep = evod.sweep({"free_genes": 2}, grid={"mutation_chance": [0.1, 0.2]}, generations=2, seed=1,
                               function=distance, minimize=True, jobs=2)
            print(len(sweep.runs))
        """))
        done = waiting.run([sys.executable, script], capture_output=True, text=True)
        self.assertEqual(done.stdout, "imported\n4\n", done.stderr)

    def test_errors_name_the_cell(self):
        def fails(genes, life):
            if life.generation == 3:
                raise ZeroDivisionError("my fault")
            return valley(genes, life)

        for jobs in (1, 2):
            with self.assertRaisesRegex(evod.ProgramFailed, r"cell 0 \(mutation_chance 0.05, selection random\), "
                                        r"replicate 0: the function raised ZeroDivisionError: my fault"):
                sweep(fails, jobs=jobs)
        with self.assertRaisesRegex(evod.ProgramFailed, "cell 0 .*generation 1, island 0"):
            sweep(lambda genes, life: genes[:, 0] * numpy.nan)
        with self.assertRaisesRegex(evod.ProgramFailed, "cell 0 .* the worker process ended"):
            sweep(lambda genes, life: os._exit(1))

    def test_what_is_not_possible_says_why(self):
        class Mine:
            pass

        Mine.__module__ = "__main__"
        with open(os.devnull) as file:
            for function in (lambda genes, life: file.read(), lambda genes, life: Mine(), 3):
                self.refused(lambda: sweep(function), "function")
        self.refused(lambda: sweep(valley, out=self.folder), "out")
        self.refused(lambda: sweep(valley, jobs=0), "jobs")
        self.refused(lambda: sweep(valley, fitness="gene_sum"), "fitness")
        self.refused(lambda: evod.compare(SETTING, function=valley, fitness="life"), "fitness")
        with self.assertRaises(evod.InvalidArgument):
            sweep(valley, grid={"mutation_chance": [7]})

    def test_compare_with_controls_and_with_another_world(self):
        results = [evod.compare(SETTING, function=valley, minimize=True, names=["mine"], replicates=6, generations=8,
                                seed=1, jobs=jobs) for jobs in (1, 3)]
        self.assertEqual(results[0].csv, results[1].csv)
        self.assertEqual([w.name for w in results[0].worlds],
                         ["mine", "random_selection", "mutation_off", "shuffled_fitness"])
        by_control = {d.other: d for d in results[0].differences}
        self.assertLess(by_control["random_selection"].difference, 0)
        self.assertEqual(by_control["random_selection"].p, 2 / 2**6)
        self.assertIn("adjusted p", str(results[0]))
        two = evod.compare({**SETTING, "selection": "tournament"}, {**SETTING, "selection": "random"}, replicates=3,
                           function=lambda genes, life: genes.sum(axis=1), generations=4, seed=1)
        self.assertGreater(two.differences[0].difference, 0)
        self.assertEqual(len(two.fitness), 2 * 3 * 4)

    def test_the_statistics_are_those_of_evod_compare(self):
        built_in = evod.compare({**SETTING, "fitness": "gene_sum", "external_bodies": False, "mutate_group": "all"},
                                replicates=7, generations=5, seed=3)
        rises = built_in.fitness.pivot_table(index=["arm", "replicate"], columns="generation", values="fitness_mean")
        rise = rises[5] - rises[1]
        first = rise["experiment_1"].to_numpy()
        differences = [first - rise[d.other].to_numpy() for d in built_in.differences]
        p = [paired_tests.sign_flip_p(values) for values in differences]
        self.assertEqual(p, [d.p for d in built_in.differences])
        numpy.testing.assert_allclose(paired_tests.holm(p), [d.adjusted for d in built_in.differences])
        for values, found in zip(differences, built_in.differences):
            numpy.testing.assert_allclose(paired_tests.interval(values), (found.low, found.high), rtol=1e-6, atol=1e-9)
            if found.g is not None:
                self.assertAlmostEqual(paired_tests.hedges_g(values), found.g)

    def test_it_works_with_asyncio(self):
        async def both():
            return await evod.aio.sweep(SETTING, list=[{"mutation_chance": 0.1}], function=valley, generations=2)

        self.assertEqual(len(asyncio.run(both()).runs), 2)


class SweepTables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sweep = evod.sweep({"fitness": "gene_sum", "island_count": 3, "population_size": 8, "migration": "ring"},
                               grid=GRID, replicates=5, generations=6, seed=2)

    def test_totals_have_a_row_for_all_islands(self):
        runs, totals = self.sweep.runs, self.sweep.totals
        self.assertEqual(len(totals) * 3, len(runs))
        groups = runs.groupby(["cell", "replicate", "generation"])
        for (cell, replicate, generation), rows in itertools.islice(groups, 9):
            total = totals.query(f"cell == {cell} and replicate == {replicate} and generation == {generation}").iloc[0]
            self.assertEqual(total.organism_count, rows.organism_count.sum())
            self.assertEqual(total.fitness_best, rows.fitness_best.max())
            self.assertEqual(total.fitness_worst, rows.fitness_worst.min())
            self.assertAlmostEqual(total.fitness_mean, numpy.average(rows.fitness_mean, weights=rows.organism_count))
            self.assertEqual(total.body_size_max, rows.body_size_max.max())
            self.assertEqual(total.end_tick, rows.end_tick.iloc[0])

    def test_time_to_is_the_first_generation(self):
        totals = self.sweep.totals
        for value, below in ((float(totals.fitness_mean.median()), False), (1e9, False), (-1e9, False),
                             (float(totals.fitness_mean.median()), True)):
            times = self.sweep.time_to("fitness_mean", value, below=below)
            self.assertEqual(len(times), 20)
            for row in times.itertuples():
                run = totals[(totals.cell == row.cell) & (totals.replicate == row.replicate)]
                hit = run[run.fitness_mean <= value if below else run.fitness_mean >= value]
                self.assertEqual(row.generation if len(hit) else None, hit.generation.min() if len(hit) else None)
        for wrong in ("fitness_men", "selection", "cell_phone"):
            with self.assertRaisesRegex(evod.InvalidArgument, "measure"):
                self.sweep.time_to(wrong, 1)

    def test_a_paired_test_takes_any_measure(self):
        for measure in ("fitness_mean", "diversity", "body_size_mean"):
            table = self.sweep.paired_test(measure, by="selection")
            self.assertEqual((list(table.selection), list(table.pairs)), (["tournament"], [10]))
        last = self.sweep.totals.query("generation == 6").set_index(["selection", "mutation_chance", "replicate"])
        differences = (last.loc["tournament"].body_size_mean - last.loc["random"].body_size_mean).to_numpy()
        self.assertAlmostEqual(table.difference[0], differences.mean())
        self.assertEqual(table.p[0], paired_tests.sign_flip_p(differences))
        times = self.sweep.time_to("fitness_mean", float(self.sweep.totals.fitness_mean.median()))
        self.assertLessEqual(self.sweep.paired_test(times, by="selection").pairs[0], 10)
        never = self.sweep.paired_test(self.sweep.time_to("fitness_mean", 1e9), by="selection")
        self.assertEqual((never.p[0], never.pairs[0]), (1, 0))
        with self.assertRaisesRegex(evod.InvalidArgument, "mutation_chance, selection"):
            self.sweep.paired_test("fitness_mean")

    def test_many_pairs_draw_signs_with_a_seed(self):
        values = numpy.random.default_rng(1).normal(0.2, 1, 40)
        self.assertEqual(paired_tests.sign_flip_p(values, 5), paired_tests.sign_flip_p(values, 5))
        self.assertLess(abs(paired_tests.sign_flip_p(values, 5) - paired_tests.sign_flip_p(values, 6)), 0.02)
        self.assertEqual(paired_tests.sign_flip_p([3.0]), 1.0)


if __name__ == "__main__":
    unittest.main()
