"""Fitness from clients: World.evaluate, wrong numbers, killed servers and clients. KILLS states how many are killed."""
import asyncio
import concurrent.futures
import contextlib
import functools
import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import textwrap
import unittest

import numpy
import pandas

import evod
import evod.aio
import waiting
from evod.v1 import commands_pb2 as c
from support import PROGRAM, Relay, Server, until

KILLS = int(os.environ.get("KILLS", 6))
OPTIMISER = {"fitness": "external", "external_bodies": False, "population_size": 30, "elite_count": 2}
FREE = {**OPTIMISER, "mutate_group": "free", "selection": "tournament", "creep": "gaussian"}


def gene_sum(genes, life):
    """Adds the genes of the body in the order in which evod adds them, so that the sums have equal bits."""
    return functools.reduce(numpy.add, numpy.asarray(genes, float)[:, :6].T)


def rastrigin(genes, life):
    """0 is the maximum, where all free genes are 0; the other local maxima are about 1, 2, 3 … lower."""
    x = numpy.asarray(genes)
    return -(10 * x.shape[1] + (x**2 - 10 * numpy.cos(2 * numpy.pi * x)).sum(axis=1))


ANGLES = numpy.random.default_rng(5).permutation(20) * numpy.pi / 10
# the corners of a polygon of 20 sides, in a random order
CITIES = numpy.stack([numpy.cos(ANGLES), numpy.sin(ANGLES)], axis=1)


def tour(genes, life):
    """The negative length of the tour that visits the cities in the order of their free genes: random keys."""
    stops = CITIES[numpy.argsort(genes, axis=1)]
    return -numpy.linalg.norm(stops - numpy.roll(stops, 1, axis=1), axis=2).sum(axis=1)


def verify(folder, world):
    done = waiting.run([PROGRAM, "verify", f"{folder}/{world}.evod"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


class Evaluate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.data.cleanup)
        cls.lab = evod.local(seed=42, data=cls.data.name)
        cls.addClassCleanup(cls.lab.close)

    def test_a_function_equals_the_built_in_one_bit_for_bit(self):
        mine = self.lab.create_world("mine", OPTIMISER, seed=9)
        built_in = self.lab.create_world("built_in", {**OPTIMISER, "fitness": "gene_sum"}, seed=9)
        rated = mine.evaluate(gene_sum, generations=40)
        built_in.run(generations=40).wait()
        self.assertEqual([g.number for g in rated], list(range(1, 41)))
        for mine_now, theirs in zip(mine.history(), built_in.history(), strict=True):
            self.assertEqual(mine_now.islands, theirs.islands)
        for world in (mine, built_in):
            world.step()  # the hash after this tick covers the genes of the next generation, but no numbers of a client
        self.assertEqual(mine.info().state_hash, built_in.info().state_hash)
        verify(self.data.name, "mine")

    def test_life_equals_the_fitness_of_life_bit_for_bit(self):
        setting = {"population_size": 20, "generation_s": 4, "island_count": 2, "migration": "ring"}
        mine = self.lab.create_world("lived", {**setting, "fitness": "external"}, seed=9)
        built_in = self.lab.create_world("life", setting, seed=9)
        eaten = []

        def life_fitness(genes, life):
            eaten.append(life.food_eaten.sum())
            return life.lived_s + life.health

        mine.evaluate(life_fitness, generations=6)
        built_in.run(generations=6).wait()
        for mine_now, theirs in zip(mine.history(), built_in.history(), strict=True):
            self.assertEqual(mine_now.islands, theirs.islands)
        self.assertEqual(len(eaten), 12)
        self.assertEqual(sum(eaten), sum(s.food_eaten for g in mine.history() for s in g.islands))

    def test_rastrigin_in_ten_dimensions_is_solved(self):
        setting = {**FREE, "population_size": 200, "free_genes": 10, "free_gene_min": -5.12, "free_gene_max": 5.12,
                   "free_mutation_step": 0.5, "mutation_chance": 0.1}
        for seed in (1, 2, 3):
            world = self.lab.create_world(f"rastrigin{seed}", setting, seed=seed)
            history = world.evaluate(rastrigin, generations=300)
            self.assertLess(history[0].best, -80)
            self.assertGreater(history[-1].best, -0.05)  # above every local maximum but the greatest
            self.assertLess(numpy.abs(history[-1].genes).max(), 1)
            verify(self.data.name, f"rastrigin{seed}")

    def test_the_shortest_tour_of_20_cities_is_found(self):
        setting = {**FREE, "population_size": 500, "free_genes": 20, "elite_count": 5, "mutation_chance": 0.05,
                   "reset_chance": 0.03, "rearranging": "swap", "rearrange_chance": 0.3}
        for seed in (1, 2, 3):
            world = self.lab.create_world(f"tour{seed}", setting, seed=seed)
            history = world.evaluate(tour, generations=300)
            self.assertLess(history[0].best, -15)
            self.assertAlmostEqual(history[-1].best, -40 * numpy.sin(numpy.pi / 20))  # the sides of the polygon
            verify(self.data.name, f"tour{seed}")

    def test_genes_have_names_in_all_results(self):
        setting = {"free_genes": 40, "controller": "network", "population_size": 12, "generation_s": 2}
        world = self.lab.create_world("named", setting, seed=3)
        names = world.info().gene_names
        self.assertEqual((len(names), names[6], names[-1]), (83, "hidden1<food_bearing", "free39"))
        groups = world.info().gene_groups
        self.assertEqual((groups[5], groups[6], groups[82]),
                         (evod.GeneGroup.BODY, evod.GeneGroup.BRAIN, evod.GeneGroup.FREE))
        ended = list(world.run(generations=3))
        history, table = world.history(), world.table("generations")
        self.assertEqual(set(history.to_pandas().columns), set(table.columns))
        self.assertEqual(ended[2].genes.names, names)
        self.assertEqual(ended[2].islands[0].genes["free39"], history[2].islands[0].genes["free39"])
        self.assertAlmostEqual(float(history[2].change["free39"]),
                               history[2].genes["free39"] - history[1].genes["free39"])
        self.assertEqual(world.statistics().last[0].genes["turn<bias"], history[2].islands[0].genes["turn<bias"])
        population = world.population()
        self.assertEqual((population.genes.shape, population.genes.names), ((12, 83), names))
        self.assertEqual(world.organism(5).genes["free0"], population.genes["free0"][5])
        self.assertEqual(world.table("population").dtypes["free39"], numpy.float32)
        child = world.breeding(generation=1).descendants[-1]
        crossed = [bool(child.from_second >> gene & 1) for gene in range(83)]
        self.assertIn(True, crossed[64:])
        for gene in range(83):
            if child.order_mutation is None and gene not in [mutation.gene for mutation in child.mutations]:
                self.assertEqual(child.genes[gene], (child.second_genes if crossed[gene] else child.first_genes)[gene])
        world.step()
        placed = world.place(organisms=[(600, 400, world.population().genes[3].to_dict())])
        self.assertEqual(world.organism(placed.organisms[0]).genes["free7"], world.population().genes["free7"][3])
        with evod.open_run(f"{self.data.name}/named.evod") as run:
            self.assertEqual(run.gene_names, names)
            self.assertEqual(list(run.generations().columns), list(table.columns))
            pandas.testing.assert_frame_equal(run.generations(), table, check_dtype=False, check_exact=True)
            self.assertEqual(run.genes(3)[0].names, names)
            self.assertTrue((run.organisms()["free39"].iloc[24:36].to_numpy() == run.genes(3)[0]["free39"]).all())
            again = {**setting, "population_size": 12}
            copy = self.lab.create_world("copy", again, population=run.genes(3))
            self.assertTrue((copy.population().genes == run.genes(3)[0]).all())
            with self.assertRaises(evod.InvalidArgument):
                self.lab.create_world("six", {"population_size": 12}, population=run.genes(3))

    def test_optimisers_have_their_free_genes_alone(self):
        setting = {**FREE, "free_genes": 2, "mutate_group": "all", "mutation_chance": 0, "crossover": "single_point",
                   "population_size": 200, "elite_count": 0, "population_model": "generational"}
        world = self.lab.create_world("alone", setting, seed=3)
        shapes = []

        def fitness(genes, life):
            shapes.append(genes.shape)
            return genes[:, :3] @ numpy.ones(2)

        names = ("free0", "free1")
        self.assertEqual(world.info().gene_names, names)
        ended = world.evaluate(fitness, generations=3)
        self.assertEqual(shapes, [(200, 2)] * 3)
        self.assertAlmostEqual(ended[0].diversity, 12 ** -0.5, delta=0.02)  # of uniform numbers
        self.assertEqual(ended[2].genes.names, names)
        self.assertAlmostEqual(float(ended[2].change["free1"]), ended[2].genes["free1"] - ended[1].genes["free1"])
        breeding = world.breeding(generation=1)
        mixed = [child for child in breeding.descendants if set(child.genes) - set(child.first_genes)]
        self.assertGreater(len(mixed), 150)  # the only cut point is between the two genes
        table = world.table("generations")
        self.assertNotIn("body_size_mean", table.columns)
        with evod.open_run(f"{self.data.name}/alone.evod") as run:
            self.assertEqual(run.gene_names, names)
            pandas.testing.assert_frame_equal(run.generations(), table, check_dtype=False, check_exact=True)
            self.assertEqual(run.organisms()["free1"].dtype, numpy.float32)
            self.assertEqual(world.table("population").dtypes["free1"], numpy.float32)
            copy = self.lab.create_world("alone2", setting, population=run.genes(3))
            self.assertTrue((copy.population().genes == run.genes(3)[0]).all())
        best = world.best()
        self.assertEqual(best.genes.names, names)
        verify(self.data.name, "alone")
        six = self.lab.create_world("six_free", {**setting, "free_genes": 6}, seed=1)
        self.assertEqual(six.evaluate(lambda genes, life: genes["free5"], 2)[-1].genes.names[0], "free0")
        self.assertEqual(six.population().genes.names[5], "free5")
        bodies = self.lab.create_world("body_genes", {**setting, "free_genes": 0}, seed=1)
        self.assertEqual(bodies.info().gene_names, evod.GENE_NAMES)

    def test_genes_of_a_list_keep_to_their_values(self):
        genes = [evod.genes.Real("rate", 0.001, 1, scale="logarithmic"), evod.genes.Integer("layers", 1, 8),
                 evod.genes.Choice("material", ["steel", "wood", "clay"]), evod.genes.Permutation("tour", 5),
                 evod.genes.Real("angle", -90, 90, step=15)]
        world = self.lab.create_world("mixed", {
            "fitness": "external", "external_bodies": False, "free_genes": genes, "population_size": 40,
            "mutate_group": "free", "rearranging": "inversion", "rearrange_chance": 0.5, "reset_chance": 0.1}, seed=3)
        cost = numpy.abs(numpy.arange(5) - 2)

        def fitness(genes, life):
            tour = numpy.stack([genes[f"tour{i}"] for i in range(5)], axis=1)
            self.assertTrue((numpy.sort(tour, axis=1) == numpy.arange(5)).all())
            self.assertTrue(numpy.isin(genes["layers"], range(1, 9)).all())
            self.assertTrue(numpy.isin(genes["material"], range(3)).all())
            self.assertTrue(numpy.isin(genes["angle"], range(-90, 91, 15)).all())
            return -abs(numpy.log10(genes["rate"]) + 2) - abs(genes["layers"] - 5) - (genes["material"] != 1) \
                - tour @ cost / 10 - abs(genes["angle"] - 30) / 90

        world.evaluate(fitness, generations=60)
        best = world.history()[-1]
        self.assertGreater(best.best, -2.5)
        self.assertEqual(list(world.info().gene_names),
                         ["rate", "layers", "material", "tour0", "tour1", "tour2", "tour3", "tour4", "angle"])
        world.reset(free_genes=[evod.genes.Integer("bits", 0, 1)])
        self.assertEqual(list(world.info().gene_names), ["bits"])
        with self.assertRaisesRegex(evod.InvalidArgument, r"free_genes\[0\].max.*16777216"):
            self.lab.create_world("wrong", {"fitness": "external",
                                            "free_genes": [evod.genes.Integer("n", 0, 20_000_000)]})
        with self.assertRaisesRegex(evod.InvalidArgument, r"free_genes\[0\]"):
            self.lab.create_world("wrong", {"fitness": "external", "free_genes": [{"minimum": 3}]})
        world.delete()

    def test_a_wrong_result_names_it_and_the_world_waits(self):
        world = self.lab.create_world("wrong", OPTIMISER, seed=2)
        for result, field, got in (
            (numpy.zeros(29), "fitness", "the shape (29,)"),
            (numpy.zeros((30, 1)), "fitness", "the shape (30, 1)"),
            (None, "fitness", "the shape ()"),
            ("abc", "fitness", "'abc'"),
            ([0.0] * 7 + [numpy.nan] + [0.0] * 22, "fitness[7]", "nan"),
            ([-numpy.inf] + [0.0] * 29, "fitness[0]", "-inf"),
        ):
            with self.assertRaises(evod.InvalidArgument) as raised:
                world.evaluate(lambda genes, life: result, generations=1)
            self.assertEqual([(v.field, v.got) for v in raised.exception.violations], [(field, got)])
            self.assertIn("generation 1", str(raised.exception))
            self.assertEqual(world.info().awaited_fitness, evod.AwaitedFitness(1, (0,)))
        with self.assertRaisesRegex(ZeroDivisionError, "division"):
            world.evaluate(lambda genes, life: 1 / 0, generations=1)
        self.assertEqual([g.number for g in world.evaluate(gene_sum, generations=2)], [1, 2])

    def test_a_large_population_is_rated_in_parts(self):
        world = self.lab.create_world("large", {**OPTIMISER, "population_size": 140_000}, seed=2)
        history = world.evaluate(gene_sum, generations=2)
        self.assertEqual(history[-1].organism_count, 140_000)
        with contextlib.closing(sqlite3.connect(f"file:{self.data.name}/large.evod?mode=ro", uri=True)) as run:
            until(lambda: run.execute("SELECT count(*) FROM journal").fetchone()[0] >= 4, "two commands per generation")

    def test_it_works_with_asyncio(self):
        async def evaluate():
            async with evod.aio.local() as lab:
                world = await lab.create_world("peak", OPTIMISER, seed=3)
                return await world.evaluate(gene_sum, generations=3)

        self.assertEqual([g.number for g in asyncio.run(evaluate())], [1, 2, 3])

    def test_several_clients_share_a_world(self):
        world = self.lab.create_world("shared", {**OPTIMISER, "island_count": 3}, seed=2)

        def evaluate(_):
            with evod.connect(self.lab.address, token="", timeout_s=600) as lab:
                return len(lab.world("shared").evaluate(gene_sum, generations=30))

        with concurrent.futures.ThreadPoolExecutor(3) as pool:
            lengths = list(pool.map(evaluate, range(3)))
        ended = world.info().generation
        # each client asks for thirty generations more from the moment at which it begins
        self.assertLessEqual(ended, 90)
        self.assertTrue(all(30 <= length <= ended for length in lengths), lengths)
        self.assertEqual([g.number for g in world.history()], list(range(1, ended + 1)))
        verify(self.data.name, "shared")


CLIENT = """
    import sys, numpy, evod
    sys.path.insert(0, sys.argv[3])
    from evaluate_test import gene_sum
    with evod.connect(sys.argv[1], timeout_s=600) as lab:
        print("connected", flush=True)
        lab.world("long").evaluate(gene_sum, generations=int(sys.argv[2]))
"""


class Kills(unittest.TestCase):
    """The world `long` is rated by clients, while this test kills servers and clients at random moments."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.data = folder.name
        self.server = Server("--data", self.data, "--seed", "5", "--speed", "max")
        self.relay = Relay(self.server.port)
        self.addCleanup(self.relay.close)
        self.client = None

    def tearDown(self):
        if self.client is not None:
            self.end_client()
        if self.server.process.poll() is None:
            self.server.kill()

    def start_client(self):
        here = os.path.dirname(os.path.abspath(__file__))
        self.client = subprocess.Popen([sys.executable, "-c", textwrap.dedent(CLIENT), self.relay.address, "100000",
                                        here],
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.client.stdout.readline()

    def end_client(self):
        self.client.send_signal(signal.SIGKILL)
        waiting.ended(self.client)
        self.client.stdout.close()

    def test_nothing_is_lost_or_doubled(self):
        chance = random.Random(7)
        with evod.connect(self.relay.address, timeout_s=600) as lab:
            setting = {**OPTIMISER, "island_count": 2, "migration": "ring"}
            world = lab.create_world("long", setting, seed=6, speed="max")
            self.start_client()
            reached = 0
            for kill in range(KILLS):
                target = reached + chance.randrange(1, 30)
                until(lambda: world.info().generation >= target, f"generation {target}")
                if kill % 2 == 0:
                    self.server.kill()
                    self.server = Server("--data", self.data, "--speed", "max")
                    self.relay.port = self.server.port
                    self.assertGreaterEqual(world.info().generation, reached)
                else:
                    self.end_client()
                    info = world.info()
                    self.assertEqual(info.state, evod.RUNNING)
                    until(lambda: world.info().awaited_fitness, "the world without a client")
                    self.start_client()
                reached = world.info().generation
            until(lambda: world.info().generation > reached + 3, "another client goes on")
            self.end_client()
            self.client = None
            until(lambda: world.info().awaited_fitness, "the world without a client")
            world.evaluate(gene_sum, generations=1)
            rated = world.info().generation
            built_in = lab.create_world("sum", {**setting, "fitness": "gene_sum"}, seed=6, speed="max")
            built_in.run(generations=rated).wait()
            for mine, theirs in zip(world.history(), built_in.history(), strict=True):
                self.assertEqual(mine.islands, theirs.islands)
        self.server.end()
        with contextlib.closing(sqlite3.connect(f"file:{self.data}/long.evod?mode=ro", uri=True)) as run:
            twice = run.execute(
                "SELECT client_key, request_id FROM journal GROUP BY 1, 2 HAVING count(*) > 1").fetchall()
            self.assertEqual(twice, [])
            messages = [c.Request.FromString(row[0]) for row in run.execute("SELECT request FROM journal")]
        numbers = [(m.set_fitness.generation, m.set_fitness.island) for m in messages if m.HasField("set_fitness")]
        self.assertEqual(sorted(numbers), [(g, i) for g in range(1, rated + 1) for i in range(2)])
        verify(self.data, "long")


if __name__ == "__main__":
    unittest.main()
