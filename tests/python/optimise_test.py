"""World.evaluate as an optimiser: watching, ends, the best organisms, read-only arrays, hints."""
import asyncio
import contextlib
import io
import os
import threading
import unittest
import warnings
from unittest import mock

import numpy

import evod
import evod.aio
from evod.tables import fitness_text
import waiting
from support import Temporary

FREE = {"fitness": "external", "external_bodies": False, "free_genes": 2, "population_size": 10}


def first_gene(genes, life):
    return -abs(genes[:, 0])


class Optimise(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=42)
        cls.addClassCleanup(cls.lab.close)
        cls.made = 0

    def world(self, **more):
        type(self).made += 1
        return self.lab.create_world(f"w{self.made}", {**FREE, **more}, seed=3)

    # ---- watching ---------------------------------------------------------------------------------------------------

    def test_a_live_call_yields_while_it_rates(self):
        seen = []

        def rated(genes, life):
            seen.append(("rated", life.generation))
            return first_gene(genes, life)

        world = self.world()
        for generation in world.evaluate(rated, generations=2, live=True):
            seen.append(("ended", generation.number))
        self.assertEqual(seen, [("rated", 1), ("ended", 1), ("rated", 2), ("ended", 2)])
        best = [generation.best for generation in world.evaluate(rated, generations=2)]
        self.assertEqual(len(best), 2)
        for generation in world.evaluate(rated, generations=100, live=True):
            if generation.number == 6:
                break
        self.assertEqual(world.history()[-1].number, 6)
        self.assertEqual([g.number for g in world.evaluate(rated, generations=2)], [7, 8])

    def test_a_with_statement_keeps_the_result(self):
        with self.world().evaluate(first_gene, generations=100, live=True) as search:
            self.assertEqual(len(search), 0)
            for generation in search:
                self.assertIs(search[-1], generation)
                if len(search) == 3:
                    break
        self.assertEqual((len(search), search.reason, search.evaluation_count), (3, "break", 30))
        self.assertEqual([g.number for g in search], [1, 2, 3])

    def test_any_other_call_waits_for_the_end(self):
        world = self.world()
        world.evaluate(first_gene, generations=2)
        self.assertEqual(len(world.history()), 2)
        self.assertEqual(world.evaluate(first_gene, generations=3)[-1].number, 5)
        seen = []
        world.evaluate(first_gene, 2, on_generation=seen.append)
        self.assertEqual([g.number for g in seen], [6, 7])
        self.assertEqual([g.evaluation_count for g in seen], [10, 20])

    def test_asyncio_watches_and_waits(self):
        async def watch():
            async with evod.aio.local() as lab:
                world = await lab.create_world("w", FREE, seed=3)
                seen = []

                async def called(generation):
                    seen.append(generation.number)

                async for generation in world.evaluate(first_gene, generations=2, on_generation=called, live=True):
                    self.assertEqual(seen[-1], generation.number)
                whole = await world.evaluate(first_gene, generations=2, on_generation=called)
                async with world.evaluate(first_gene, stagnation=5, live=True) as search:
                    async for _ in search:
                        pass
                with self.assertRaisesRegex(evod.FailedPrecondition, "await world.best"):
                    (await world.history()).best()
                return seen, whole, search, await world.best()

        seen, whole, search, best = asyncio.run(watch())
        self.assertEqual(seen, [1, 2, 3, 4])
        self.assertEqual((whole.reason, search.reason), ("generations", "stagnation"))
        self.assertGreaterEqual(best.fitness, max(whole.best().fitness, search.best().fitness))

    def test_progress_is_one_line_on_a_terminal(self):
        class Terminal(io.StringIO):
            def isatty(self):
                return True

        for kind, in_notebook, ends in ((Terminal, False, 1), (io.StringIO, False, 3), (io.StringIO, True, 1)):
            with mock.patch("evod.progress.in_notebook", return_value=in_notebook):
                with contextlib.redirect_stderr(kind()) as shown:
                    world = self.world()
                    world.evaluate(first_gene, generations=3, progress=True)
                self.assertEqual(shown.getvalue().count("\n"), ends)
                self.assertRegex(shown.getvalue(), "generation 3 of 3: best -.*, [0-9]+ evaluations, [0-9.]+ s")
                with contextlib.redirect_stderr(kind()) as shown, evod.local(seed=1) as lab:
                    lab.world().run(3, progress=True).wait()
                self.assertEqual(shown.getvalue().count("\n"), ends)
                self.assertRegex(shown.getvalue(), "generation 3 of 3: best .* alive, [0-9.]+ s")

    # ---- the end ----------------------------------------------------------------------------------------------------

    def test_a_pause_in_the_function_ends_the_call(self):
        for options in ({}, {"generations": 200}, {"generations": 200, "minimize": True}):
            world = self.world()

            def rated(genes, life):
                if life.generation == 5:
                    world.pause()
                return first_gene(genes, life)

            result = world.evaluate(rated, **options)
            self.assertEqual(([g.number for g in result], result.reason), ([1, 2, 3, 4, 5], "pause"))

    def test_a_pause_by_others_ends_evaluate_and_run(self):
        rated = threading.Event()

        def slowly(genes, life):
            rated.set()
            return first_gene(genes, life)

        def evoctl(world):
            self.evoctl("--world", world.name, "pause", check=True)

        for pause in (lambda world: world.pause(), evoctl):
            world, result = self.world(), []
            rated.clear()
            thread = threading.Thread(target=lambda: result.append(world.evaluate(slowly)))
            thread.start()
            rated.wait()
            pause(world)
            thread.join()
            self.assertEqual(result[0].reason, "pause")
        plain = self.lab.create_world("plain", {"population_size": 10, "generation_s": 1}, seed=1)
        for generations in (None, 100_000):
            run = plain.run(generations)
            next(run)
            plain.pause()
            run.wait()
            self.assertEqual(run.reason, "pause")
        self.assertEqual(plain.info().state, evod.PAUSED)

    def test_criteria_end_the_call(self):
        result = self.world().evaluate(first_gene, 500, target=-0.2)
        self.assertEqual(result.reason, "target")
        self.assertGreaterEqual(result[-1].best, -0.2)
        self.assertTrue(all(g.best < -0.2 for g in result[:-1]))
        result = self.world().evaluate(lambda genes, life: numpy.zeros(len(genes)), stagnation=4)
        self.assertEqual((len(result), result.reason), (5, "stagnation"))
        self.assertEqual(self.world().evaluate(first_gene, seconds=1e-9).reason, "seconds")
        result = self.world().evaluate(first_gene, until=lambda g: g.number == 3)
        self.assertEqual((len(result), result.reason), (3, "until"))
        world = self.world(generation_limit=2)
        self.assertEqual(world.evaluate(first_gene).reason, "generation_limit")
        world = self.world()
        self.assertEqual(world.evaluate(first_gene, 2).reason, "generations")
        self.assertEqual(world.evaluate(first_gene, target=-100).reason, "target")
        self.assertEqual(world.info().state, evod.PAUSED)

    def test_wrong_arguments_say_what_to_write(self):
        world = self.world()
        for options, said in (
            ({"minimise": True}, "minimize=True"), ({"num_generations": 3}, "generations=N"),
            ({"callback": print}, "on_generation=function"), ({"workers": 4}, "pool.map"), ({"colour": 1}, "minimize"),
            ({"target": "low"}, "a number"), ({"target": numpy.nan}, "a number"), ({"stagnation": 0}, "at least 1"),
            ({"stagnation": 2.5}, "a whole number"), ({"seconds": -1}, "greater than 0"), ({"until": 3}, "target="),
        ):
            with self.assertRaises(evod.InvalidArgument) as raised:
                world.evaluate(first_gene, **options)
            self.assertEqual([v.field for v in raised.exception.violations], list(options))
            self.assertIn(said, raised.exception.violations[0].allowed)
        with self.assertRaisesRegex(evod.InvalidArgument, "a function of genes and life"):
            world.evaluate(3)
        for name in ("minimise", "minimize", "maximise"):
            with self.assertRaisesRegex(evod.InvalidArgument, "minimize=True as an argument of world.evaluate"):
                self.lab.create_world("never", {**FREE, name: True})

    # ---- minimize, new organisms, arrays ----------------------------------------------------------------------------

    def test_minimize_keeps_the_sign_of_the_function(self):
        up, down = self.world(), self.world()
        greatest = up.evaluate(first_gene, 20)
        least = down.evaluate(lambda genes, life: -first_gene(genes, life), 20, minimize=True)
        self.assertEqual(up.step().state_hash, down.step().state_hash)  # of the genes; 0 and -0 differ before
        for one, other in zip(greatest, least, strict=True):
            self.assertEqual((one.best, one.mean, one.worst), (-other.best, -other.mean, -other.worst))
        self.assertEqual(least.best().fitness, -greatest.best().fitness)
        self.assertEqual([s.of for s in least.hall_of_fame(9)], [s.of for s in greatest.hall_of_fame(9)])
        self.assertEqual([g.best for g in down.history(minimize=True)], [g.best for g in least])
        self.assertEqual(down.best(minimize=True).fitness, least.best().fitness)
        self.assertTrue((least.columns()["fitness_best"] <= least.columns()["fitness_mean"]).all())
        self.assertIn(f"best {least[-1].best:.4g}", str(least[-1]))

    def test_only_new_organisms_are_rated(self):
        counts = []

        def counted(genes, life):
            counts.append((len(genes), int(life.is_new.sum())))
            return first_gene(genes, life)

        for more in ({}, {"elite_count": 3, "population_model": "generational"}, {"population_model": "steady_state"},
                     {"island_count": 2, "migration": "ring", "migration_epoch": 1}):
            whole, saving = self.world(**more), self.world(**more)
            counts.clear()
            all_rated = whole.evaluate(counted, 12)
            marked = sum(new for _, new in counts)
            counts.clear()
            result = saving.evaluate(counted, 12, only_new=True)
            self.assertEqual(result.evaluation_count, marked)
            self.assertEqual(sum(length for length, _ in counts), marked)
            self.assertLess(marked, all_rated.evaluation_count)
            self.assertEqual(saving.info().state_hash, whole.info().state_hash)
        bodies = self.lab.create_world("bodies", {"fitness": "external", "generation_s": 1}, seed=1)
        with self.assertRaisesRegex(evod.InvalidArgument, "survivors live again"):
            bodies.evaluate(first_gene, 1, only_new=True)

    def test_the_function_gets_the_free_genes_and_cannot_write(self):
        world = self.world(free_genes=3)
        shapes = []
        world.evaluate(lambda genes, life: shapes.append((genes.shape, genes.names)) or genes["free2"], 1)
        self.assertEqual(shapes, [((10, 3), ("free0", "free1", "free2"))])

        def whole(genes, life):
            genes[:, 1:] = 0.3
            return genes[:, 0]

        def in_place(genes, life):
            genes *= 2
            return genes[:, 0]

        def column(genes, life):
            genes["free1"][2] = 0.5
            return genes[:, 0]

        for writes in (whole, in_place, column):
            with self.assertRaisesRegex(evod.InvalidArgument, r"evod\.Repaired\(fitness, copy\)"):
                world.evaluate(writes, 1)

        def repaired(genes, life):
            copy = genes.copy()
            copy[:, 1:] = 0.3
            return copy["free0"]

        self.assertEqual(len(world.evaluate(repaired, 1)), 1)
        with self.assertRaisesRegex(ValueError, "my own"):
            world.evaluate(lambda genes, life: (_ for _ in ()).throw(ValueError("my own")), 1)

    def test_a_refused_number_names_organism_and_generation(self):
        world = self.world()
        world.evaluate(first_gene, 2)
        for number in (numpy.nan, numpy.inf, -numpy.inf, 1e101):
            with self.assertRaisesRegex(evod.InvalidArgument, "generation 3, island 0: .* of organism 4. .* a penalty"):
                world.evaluate(lambda genes, life: numpy.where(numpy.arange(len(genes)) == 4, number, 0.0), 1)

    def test_a_number_for_each_organism_is_needed(self):
        for columns, what in (1, r"column \[:, 0\]"), (2, "objectives=2"), (3, "objectives=3"):
            with self.assertRaisesRegex(evod.InvalidArgument, f"the shape .10, {columns}.*{what}"):
                self.world().evaluate(lambda genes, life: numpy.zeros((len(genes), columns)), 1)
        with self.assertRaisesRegex(evod.InvalidArgument, "allowed an array of 10 numbers, one for each organism$"):
            self.world().evaluate(lambda genes, life: numpy.zeros(9), 1)

    # ---- the best ---------------------------------------------------------------------------------------------------

    def test_the_best_organisms_are_known(self):
        world = self.world(island_count=2, population_size=8)
        result = world.evaluate(first_gene, 30)
        best = result.best()
        self.assertEqual(best.fitness, max(g.best for g in result))
        self.assertEqual(best.fitness, -abs(float(best.genes["free0"])))
        stored = world.best()
        self.assertEqual((stored.of, stored.fitness, stored.genes.to_dict()),
                         (best.of, best.fitness, best.genes.to_dict()))
        self.assertEqual(world.history().best().of, best.of)
        famous, read = result.hall_of_fame(12), world.hall_of_fame(12)
        self.assertEqual([s.fitness for s in famous], [s.fitness for s in read])
        self.assertEqual(len({s.genes.tobytes() for s in famous}), 12)
        table = world.table("lineage", of=best.of)
        self.assertIn(best.generation, list(table.generation))
        self.assertEqual([g.best_solution.fitness for g in result], [g.best for g in result])
        for k in (0, -1, 101):
            with self.assertRaisesRegex(evod.InvalidArgument, "k: got"):
                result.hall_of_fame(k)
        part = world.history(first=3, last=5)
        self.assertEqual(part.best().fitness, max(g.best for g in part))

    def evoctl(self, *words, **options):
        command = [os.environ["EVOCTL"], "--server", self.lab.address, *words]
        return waiting.run(command, capture_output=True, text=True, **options)

    def test_evoctl_shows_the_same_best(self):
        world = self.world(island_count=2, population_size=8)
        world.evaluate(first_gene, 12)
        for words, history in (((), world.history()), (("--from", "3", "--to", "6"), world.history(3, 6)),
                               (("--island", "1"), world.history(island=1))):
            best = history.best()
            shown = self.evoctl("--world", world.name, "best", *words, check=True).stdout
            self.assertIn(f"fitness {fitness_text(best.fitness)}: organism {best.organism} of island {best.island}, "
                          f"generation {best.generation}\n", shown)
            self.assertIn(f"{best.genes['free1']:.6g}\n", shown)
        refused = self.evoctl("--world", self.world().name, "best")
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("no such generation has ended", refused.stderr)

    def test_a_world_without_generations_has_no_best(self):
        world = self.world()
        for call in (world.best, lambda: world.history().best(), evod.History().best):
            with self.assertRaises(evod.FailedPrecondition):
                call()
        self.assertEqual(world.hall_of_fame(3), [])

    def test_small_differences_are_printed(self):
        result = self.world().evaluate(lambda genes, life: 0.95 + 0.004 * genes[:, 0], generations=5)
        self.assertIn(f"best {result[-1].best:.4g}, mean {result[-1].mean:.4g}", str(result[-1]))
        self.assertIn(f"{result[-1].best:.4g}", result._repr_html_())

    def test_a_history_plots_itself(self):
        result = self.world().evaluate(lambda genes, life: (genes ** 2).sum(axis=1), 4, minimize=True)
        axes = result.plot()
        self.assertEqual(list(axes.get_lines()[1].get_ydata()), [g.best for g in result])
        self.assertEqual(len(self.world().evaluate(first_gene, 30)._repr_html_().split("<tr>")), 23)


class AsPythonUsersExpect(Temporary):
    def test_create_world_takes_a_file(self):
        with evod.local() as lab:
            path = self.file("mine.json", {"population_size": 12, "seed": 9, "mutation_chance": {"1": 0.3, "4": 0.1},
                                           "description": "mine"})
            for number, given in enumerate((path, str(path))):
                info = lab.create_world(f"mine{number}", given).info()
                self.assertEqual((info.seed, len(lab.world(f"mine{number}").population())), (9, 12))
            self.assertEqual(lab.create_world("other", path, seed=4).info().seed, 4)
            for wrong in (5, ["population_size"], b"x.json"):
                self.refused(lambda: lab.create_world("never", wrong), "experiment")
            with self.assertRaises(evod.FileNotFound):
                lab.create_world("never", "no_such_file.json")
            bad = self.folder / "bad.json"
            bad.write_text("{")
            with self.assertRaises(evod.InvalidArgument):
                lab.create_world("never", bad)

    def test_worlds_are_worlds(self):
        with evod.local(seed=5) as lab:
            lab.create_world("second", seed=6)
            for world in lab.worlds():
                world.run(generations=1).wait()
                self.assertEqual(len(world.history()), 1)
                world.pause()
            self.assertEqual([info.seed for info in lab.world_infos()], [5, 6])

    def test_a_forgotten_await_is_an_error(self):
        async def forget(call):
            async with evod.aio.local(seed=1) as lab:
                world = await lab.world()
                with warnings.catch_warnings(record=True) as caught:
                    warnings.simplefilter("always")
                    call(world)
                self.assertIn("was called without await", str(caught[0].message))
                with self.assertRaisesRegex(evod.FailedPrecondition, "write `await World"):
                    await world.info()
                self.assertEqual((await world.info()).generation, 1)
                await world.run(generations=1)

        for call in (lambda world: world.run(), lambda world: world.snapshots(),
                     lambda world: world.evaluate(first_gene)):
            asyncio.run(forget(call))


if __name__ == "__main__":
    unittest.main()
