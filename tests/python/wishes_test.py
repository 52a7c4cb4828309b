"""What people ask of programs for evolution, in small: each with two siblings. Each case works, or its refusal says
what to write."""
import os
import pathlib
import tempfile
import unittest

import numpy
import pandas

import evod
import waiting
from evod import genes
from support import PROGRAM

FREE = {"fitness": "external", "external_bodies": False, "free_genes": 2, "population_size": 10,
        "mutate_group": "free"}  # fmt: skip


def first_gene(genes_, life):
    return -abs(genes_[:, 0])


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=42)
        cls.addClassCleanup(cls.lab.close)
        cls.made = 0

    def world(self, **more):
        type(self).made += 1
        return self.lab.create_world(f"w{self.made}", {**FREE, **more}, seed=3)

    def refused(self, words, call, *arguments, **more):
        with self.assertRaisesRegex(evod.InvalidArgument, words):
            call(*arguments, **more)


class Genes(Case):
    def test_each_gene_has_bounds_a_step_or_a_scale(self):
        for gene, allowed in ((genes.Real("x", 10, 100), lambda x: 10 <= x <= 100),
                              (genes.Real("x", 10, 100, step=5), lambda x: x % 5 == 0 and 10 <= x <= 100),
                              (genes.Real("x", 0.001, 1, scale="logarithmic"), lambda x: 0.0009 <= x <= 1)):
            best = self.world(free_genes=[gene, genes.Real("y")]).evaluate(first_gene, 5).hall_of_fame(5)
            self.assertTrue(all(allowed(float(found.genes["x"])) for found in best), best)

    def test_a_list_as_a_bound_names_the_list_of_genes(self):
        for name, value in (("free_gene_min", [0, 10]), ("free_gene_max", (1, 100)),
                            ("free_gene_max", numpy.array([1, 100]))):
            self.refused("free_genes as a list of evod.genes.Real", self.world, **{name: value})
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "bounds.json"
            file.write_text('{"free_genes": 2, "free_gene_min": [0, 10]}')
            checked = waiting.run([PROGRAM, "check", str(file)], capture_output=True, text=True)
        self.assertIn("the list free_genes gives each gene values of its own", checked.stderr)

    def test_genes_are_whole_numbers_choices_or_switches(self):
        for gene, values in ((genes.Integer("n", 1, 8), range(1, 9)), (genes.Choice("n", [50, 75, 100]), range(3)),
                             (genes.Choice("n", ["no", "yes"]), range(2))):
            result = self.world(free_genes=[gene]).evaluate(first_gene, 5)
            self.assertLessEqual({float(found.genes["n"]) for found in result.hall_of_fame(20)}, set(values))

    def test_tables_contain_the_texts_of_choices(self):
        choices = ["relu", "a,b", "1", "16"]
        listed = [genes.Real("rate"), genes.Choice("act", choices), genes.Permutation("tour", 3)]
        with tempfile.TemporaryDirectory() as folder, evod.local(data=folder) as lab:
            world = lab.create_world("texts", {**FREE, "free_genes": listed})
            best = world.evaluate(first_gene, 4).hall_of_fame(8)
            population = world.population()
            texts = [choices[int(value)] for value in population.genes["act"]]
            self.assertEqual(list(population.to_pandas()["act"]), texts)
            self.assertEqual(list(world.table("population")["act"]), texts)
            self.assertEqual(world.table("population")["rate"].dtype, numpy.float32)
            for found in [*best, world.best()]:
                row = world.table("organisms").set_index(["generation", "island", "organism"]).loc[found.of]
                self.assertEqual((row["act"], row["rate"]), (choices[int(found.genes["act"])], found.genes["rate"]))
                self.assertIn(f"act {row['act']}, tour0", repr(found))
                self.assertIn(f"<td>{row['act']}</td>", found._repr_html_())
            again = lab.create_world("again", {**FREE, "free_genes": listed},
                                     population=[population.to_pandas()[list(population.genes.names)].to_numpy()])
            numpy.testing.assert_array_equal(again.population().genes, population.genes)
            with evod.open_run(f"{folder}/texts.evod") as run:
                self.assertEqual(list(run.population()["act"]), texts)
                pandas.testing.assert_frame_equal(run.organisms()[["rate", "act"]],
                                                  world.table("organisms")[["rate", "act"]])

    def test_steps_stay_within_bounds_without_piling_up(self):
        for method, share in (("reflect", 0), ("redraw", 0), ("clamp", 0.2)):
            world = self.world(free_genes=20, creep="gaussian", free_mutation_step=0.3, mutation_chance=0.5,
                               selection="random", out_of_bounds=method)
            world.evaluate(lambda genes_, life: numpy.zeros(len(genes_)), 30)
            free = numpy.asarray(world.population().genes[:, -20:])
            at_bound = ((free == 0) | (free == 1)).mean()
            self.assertTrue(at_bound > share if share else at_bound == 0, (method, at_bound))

    def test_a_few_known_organisms_are_completed(self):
        whole = len(self.world().population().genes[0])
        for count in 1, 2, 9:
            known = numpy.full((count, whole), 100.0)
            known[:, -2:] = 0.5
            world = self.lab.create_world(f"known{count}", FREE, population=[known])
            self.assertEqual(world.population().genes.shape, (10, whole))
            numpy.testing.assert_array_equal(world.population().genes[:count], known)


    def test_columns_of_a_population_are_those_of_the_world(self):
        for shape in (2, 4), (1, 6), (3, 1), (2, 3):
            worlds = len(self.lab.worlds())
            self.refused(r"population\[0\].*allowed (the shape \(organisms, 2\)|a multiple of 2)",
                         self.lab.create_world, "columns", FREE, population=[numpy.full(shape, 0.5)])
            self.assertEqual(len(self.lab.worlds()), worlds)


class Fitness(Case):
    def test_what_is_no_number_names_the_organism_and_a_penalty(self):
        for value in numpy.nan, numpy.inf, -numpy.inf:
            def rated(genes_, life, value=value):
                fitness = numpy.array(first_gene(genes_, life), float)
                fitness[4] = value if life.generation == 3 else fitness[4]
                return fitness

            world = self.world()
            self.refused("generation 3.*organism 4.*return a penalty", world.evaluate, rated, 5)
            self.assertEqual([g.number for g in world.evaluate(first_gene, 2)], [3, 4])

    def test_small_differences_are_printed(self):
        for scale in 0.004, 0.0004, 1e-5:
            result = self.world().evaluate(lambda genes_, life, scale=scale: 0.95 + scale * genes_[:, 0], 2)
            self.assertRegex(str(result[-1]), r"best 0\.95\d*, mean 0\.95")
        self.assertIn("best -0.00", str(self.world().evaluate(lambda genes_, life: -0.004 * genes_[:, 0], 2)[-1]))

    def test_words_of_other_optimisers_get_a_hint(self):
        for word, hint in (("minimise", "minimize=True"), ("callback", "on_generation=function"),
                           ("num_generations", "generations=N")):
            self.refused(hint, self.world().evaluate, first_gene, 5, **{word: 3})

    def test_many_seeds_of_a_function_are_one_call(self):
        for seeds in ({"replicates": 3}, {"seeds": [11, 12, 13]}, {"seed": 5, "replicates": 3}):
            sweep = evod.sweep({"free_genes": 2, "population_size": 10}, grid={"mutation_chance": [0.1, 0.2]},
                               function=first_gene, generations=3, **seeds)
            self.assertEqual(len(sweep.last), 6)
            if "seeds" in seeds:
                self.assertEqual(sweep.seeds, (11, 12, 13))


class Numbers(Case):
    def test_numbers_of_numpy_are_numbers(self):
        for value in numpy.float64(12), numpy.int32(12), 12.0:
            self.assertEqual(self.world(population_size=value).parameters.population_size, 12)
        sweep = evod.sweep(grid={"population_size": numpy.linspace(10, 20, 3)}, generations=1, generation_s=1)
        self.assertEqual(sorted(set(sweep.runs.population_size)), [10, 15, 20])
        self.refused("got 30.5, allowed a whole number", self.world, population_size=30.5)

    def test_typing_errors_name_what_to_write(self):
        for name, value, hint in (("mutation_chance", "0,1", "write a decimal point: 0.1"),
                                  ("mutation_chance", "1e-1", "without quotation marks"),
                                  ("respawn", "true", "write True without quotation marks"),
                                  ("mutation_chance", [0.1, 0.2], r"evod.sweep\(grid=…\)")):
            self.refused(hint, self.world, **{name: value})

    def test_words_on_command_lines_get_the_same_hints(self):
        for word, hint in (("mutation_chance=0,1", "write a decimal point: 0.1"), ("respawn=True", "in lower case"),
                           ("mutation_step=1,5", "write a decimal point: 1.5")):
            for command in ([os.environ["EVOCTL"], "--server", self.lab.address, "set", word],
                            [PROGRAM, "run", "--generations", "1", "--set", word]):
                done = waiting.run(command, capture_output=True, text=True)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(hint, done.stderr)

    def test_a_sweep_takes_seeds(self):
        small = {"population_size": 10, "generation_s": 1}
        for seeds in [11, 12], (11,), [2**53 - 1, 3, 4]:
            sweep = evod.sweep(small, grid={"mutation_chance": [0.1]}, generations=1, seeds=seeds)
            self.assertEqual((sweep.seeds, list(sweep.runs.seed)), (tuple(seeds), list(seeds)))
        self.refused("replicates: got 3, allowed no value, or 2", evod.sweep, small, grid={"mutation_chance": [0.1]},
                     generations=1, seeds=[11, 12], replicates=3)

    def test_a_period_in_a_schedule_names_a_list(self):
        for key in "every 5", "5n", "1-5":
            self.refused("list each generation", self.world, mutation_chance={1: 0.1, key: 0.2})
        listed = {generation: 0.1 * (generation % 2) for generation in range(1, 9)}
        self.assertEqual(len(self.world(mutation_chance=listed).get_parameters().schedule), 7)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def evod(self, *words):
        return waiting.run([PROGRAM, *map(str, words)], capture_output=True, text=True, cwd=self.folder)

    def test_experiments_of_other_editors_are_read(self):
        file = self.folder / "x.json"
        for text in (b'\xef\xbb\xbf{"population_size": 30}', b'{\r\n"population_size": 30\r\n}',
                     b'{"population_size": 30.0}'):
            file.write_bytes(text)
            self.assertEqual(self.evod("check", file).returncode, 0, text)
        for text, hint in ((b'{"population_size": 30,}', "remove the comma"), (b"{'a': 1}", "straight double quotes"),
                           (b'{"mutation_chance": 0,1}', "write a point"),
                           (b'{"mutation_chance": "0.2"}', "without quotation marks")):
            file.write_bytes(text)
            self.assertIn(hint, self.evod("check", file).stderr)

    def test_populations_of_spreadsheets_are_read(self):
        self.evod("run", "--generations", 1, "--seed", 1, "--set", "population_size=20", "--run-file", "a.evod")
        plate = self.evod("export", "a.evod", "--what", "population").stdout
        (self.folder / "plate.csv").write_text(plate)
        expected = self.evod("run", "--population", "plate.csv", "--set", "population_size=20", "--generations", 1,
                             "--seed", 3).stdout.splitlines()[:3]
        heading, *rows = plate.splitlines()
        with_semicolons = [heading.replace(",", ";"), *(row.replace(",", ";").replace(".", ",") for row in rows)]
        with_quotes = [",".join(f'"{name}"' for name in heading.split(",")), *rows]
        for text in "\n".join(with_semicolons), "\n".join(with_quotes), "\ufeff" + plate, plate.replace(",", ", "):
            (self.folder / "plate.csv").write_text(text, encoding="utf-8")
            done = self.evod("run", "--population", "plate.csv", "--set", "population_size=20", "--generations", 1,
                             "--seed", 3)
            self.assertEqual((done.returncode, done.stdout.splitlines()[:3]), (0, expected), done.stderr)

    def test_some_organisms_of_files_begin_a_run(self):
        self.evod("run", "--generations", 1, "--seed", 1, "--set", "population_size=20", "--run-file", "a.evod")
        heading, *rows = self.evod("export", "a.evod", "--what", "population").stdout.splitlines()
        (self.folder / "one.csv").write_text("\n".join([heading, rows[11]]))
        (self.folder / "two.csv").write_text("\n".join([heading, *rows, *rows]))
        for files in (["one.csv"], ["one.csv", "one.csv"], ["two.csv"]):
            words = [word for file in files for word in ("--population", file)]
            done = self.evod("run", *words, "--set", "population_size=40", "--generations", 1, "--run-file", "b.evod")
            self.assertEqual(done.returncode, 0, done.stderr)
            (self.folder / "b.evod").unlink()


if __name__ == "__main__":
    unittest.main()
