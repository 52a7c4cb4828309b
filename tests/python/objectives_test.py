"""World.evaluate with several objectives, and functions that repair chromosomes."""
import tempfile
import unittest

import numpy

import evod
import waiting
from support import PROGRAM

DEB = {  # the settings of Deb et al. 2002: 100 survivors and 100 children
    "fitness": "external", "external_bodies": False, "objectives": 2, "free_genes": 30, "population_size": 200,
    "population_model": "nsga2", "survivors": 0.5, "selection": "tournament", "tournament_size": 2,
    "crossover": "simulated_binary", "crossover_chance": 0.9, "crossover_spread_index": 20, "creep": "polynomial",
    "mutation_chance": 1 / 30, "mutation_spread_index": 20, "mutate_group": "free",
}


def zdt(number):
    """Zitzler, Deb & Thiele 2000, doi:10.1162/106365600568202: both objectives are minimised."""
    def rate(genes, life):
        x = numpy.asarray(genes, float)
        g = 1 + 9 * x[:, 1:].mean(axis=1)
        share = x[:, 0] / g
        h = {1: 1 - numpy.sqrt(share), 2: 1 - share**2,
             3: 1 - numpy.sqrt(share) - share * numpy.sin(10 * numpy.pi * x[:, 0])}[number]
        return numpy.stack([x[:, 0], g * h], axis=1)
    return rate


#: The extent of the true front, and the hypervolume of NSGA-II after 25,000 evaluations within it, scaled to 1: medians
#: of 100 runs by Nebro et al. 2008, IEEE Trans. Evol. Comput. 12(4), doi:10.1109/TEVC.2007.913109.
PUBLISHED = {1: ((0, 0), (1, 1), 0.6594), 2: ((0, 0), (1, 1), 0.3261), 3: ((0, -0.773369), (0.851833, 1), 0.5148)}


class Arithmetic(unittest.TestCase):
    def test_the_hypervolume_of_boxes(self):
        self.assertEqual(evod.hypervolume([[1, 3], [2, 2], [3, 1], [3, 3]], [4, 4], minimize=True), 6)
        self.assertEqual(evod.hypervolume([[2, 3, 4]], [0, 0, 0]), 24)
        self.assertEqual(evod.hypervolume([[2, 2, 1], [1, 1, 2]], [0, 0, 0]), 5)
        self.assertEqual(evod.hypervolume([[2, 2, 1], [2, 2, 1]], [0, 0, 0]), 4)
        self.assertEqual(evod.hypervolume([[5]], [3]), 2)
        self.assertEqual(evod.hypervolume([[1, 1]], [1, 0]), 0)
        with self.assertRaisesRegex(evod.InvalidArgument, "2 numbers, one for each objective"):
            evod.hypervolume([[1, 1]], [0, 0, 0])

    def test_the_hypervolume_is_the_share_of_dominated_points(self):
        random = numpy.random.default_rng(5)
        for count in 2, 3, 4:
            rows = random.random((20, count))
            points = random.random((100_000, count))
            inside = (points[:, None] < rows[None]).all(axis=2).any(axis=1).mean()
            deviation = (inside * (1 - inside) / len(points)) ** 0.5
            self.assertLess(abs(evod.hypervolume(rows, numpy.zeros(count)) - inside), 5 * deviation)

    def test_the_front_is_that_of_the_definition(self):
        self.assertEqual(evod.nondominated([[1, 1], [1, 1], [0, 1], [2, 0]]).tolist(), [True, True, False, True])
        with self.assertRaisesRegex(evod.InvalidArgument, "count, objectives"):
            evod.nondominated([1, 2, 3])


class Objectives(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.data.cleanup)
        cls.lab = evod.local(seed=42, data=cls.data.name)
        cls.addClassCleanup(cls.lab.close)

    def verify(self, world):
        done = waiting.run([PROGRAM, "verify", f"{self.data.name}/{world}.evod"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_zdt_reaches_the_published_hypervolume(self):
        for number, (least, most, published) in PUBLISHED.items():
            with self.subTest(zdt=number):
                world = self.lab.create_world(f"zdt{number}", DEB, seed=number)
                search = world.evaluate(zdt(number), generations=250, minimize=True)
                width = numpy.subtract(most, least)
                volumes = search.hypervolume(most) / width.prod()
                self.assertGreater(volumes[-1], 0.99 * published)
                self.assertLess(volumes[-1], 1.02 * published)
                self.assertLess(volumes[0], 0.5 * published)
                front = search.front()
                self.assertEqual(front.objectives.shape, (len(front), 2))
                self.assertTrue(evod.nondominated(front.objectives, minimize=True).all())
                self.assertAlmostEqual(search[-1].best, front.objectives[:, 0].min())

    def test_the_run_repeats_without_the_function(self):
        world = self.lab.create_world("two", {**DEB, "free_genes": 3, "population_size": 20, "island_count": 2,
                                              "migration": "ring", "migration_epoch": 2, "shuffle_fitness": True})
        search = world.evaluate(zdt(1), generations=5, minimize=True)
        self.verify("two")
        organisms = world.table("organisms")
        last = organisms[organisms["generation"] == 5]
        mask = evod.nondominated(last[["fitness", "objective2"]])
        numpy.testing.assert_allclose(numpy.sort(-last["fitness"][mask]), search.front().objectives[:, 0])
        self.assertEqual(list(search.front().to_pandas().columns),
                         ["objective1", "objective2", "free0", "free1", "free2"])
        self.assertEqual(search.front().plot().get_xlabel(), "objective 1")
        breeding = world.breeding(island=0, generation=4)
        self.assertEqual(len({contender.own_fitness for contender in breeding.contenders}) > 1, True)

    def test_wrong_shapes_are_refused(self):
        world = self.lab.create_world("shapes", {**DEB, "free_genes": 3, "population_size": 6, "objectives": 3})
        with self.assertRaisesRegex(evod.InvalidArgument, r"\(6, 3\): 3 numbers for each organism \(objectives\)"):
            world.evaluate(zdt(1), generations=1)
        with self.assertRaisesRegex(evod.FailedPrecondition, "front"):
            world.evaluate(lambda genes, life: numpy.asarray(genes[:, :3]), generations=1).best()
        one = self.lab.create_world("one", {**DEB, "free_genes": 3, "population_size": 6, "objectives": 1})
        with self.assertRaisesRegex(evod.InvalidArgument, "create the world with objectives=2"):
            one.evaluate(zdt(1), generations=1)
        with self.assertRaisesRegex(evod.FailedPrecondition, "objectives=2"):
            one.evaluate(lambda genes, life: genes[:, 0], generations=1).front()


class Repair(unittest.TestCase):
    SETTING = {"fitness": "external", "external_bodies": False, "free_genes": 3, "population_size": 12,
               "elite_count": 1, "mutate_group": "free"}

    def setUp(self):
        self.data = tempfile.TemporaryDirectory()
        self.addCleanup(self.data.cleanup)
        self.lab = evod.local(seed=42, data=self.data.name)
        self.addCleanup(self.lab.close)

    @staticmethod
    def rounded(genes, life):
        whole = numpy.round(numpy.asarray(genes) * 4) / 4
        return evod.Repaired(whole.sum(axis=1), whole)

    def test_repaired_chromosomes_breed(self):
        world = self.lab.create_world("w", {**self.SETTING, "mutation_chance": 0}, seed=1)
        search = world.evaluate(self.rounded, generations=4)
        born = numpy.asarray(world.population().genes)[:, -3:]  # all descend from repaired chromosomes
        numpy.testing.assert_array_equal(born, numpy.round(born * 4) / 4)
        best = search.best()
        self.assertEqual(float(numpy.sum(best.genes)), best.fitness)
        done = waiting.run([PROGRAM, "verify", f"{self.data.name}/w.evod"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_only_new_rates_repaired_survivors_once(self):
        world = self.lab.create_world("w", {**self.SETTING, "mutation_chance": 0, "crossover": "none"}, seed=1)
        search = world.evaluate(self.rounded, generations=3, only_new=True)
        self.assertEqual(search.evaluation_count, 12)  # the others are copies

    def test_wrong_chromosomes_are_refused(self):
        world = self.lab.create_world("w", self.SETTING, seed=1)
        for genes, text in (numpy.zeros((12, 2)), r"the shape of the genes, \(12, 3\)"), \
                (numpy.full((12, 3), 2.0), r"free0: got 2, allowed 0 to 1"), (numpy.full((12, 3), numpy.nan), "free0"):
            with self.assertRaisesRegex(evod.InvalidArgument, text):
                world.evaluate(lambda _, life, genes=genes: evod.Repaired(numpy.zeros(12), genes), generations=1)
        self.assertEqual(world.evaluate(self.rounded, generations=1)[-1].number, 1)


if __name__ == "__main__":
    unittest.main()
