"""Worlds whose organisms are steered by neural networks: genes, headings, and the activations of the networks."""
import pathlib
import pickle
import subprocess
import tempfile
import unittest

import numpy

import evod
from evod.v1 import commands_pb2 as c, stream_pb2

from support import PROGRAM

STEP = 2 * numpy.pi / 256  # of headings in snapshots
NETWORK = {"controller": "network", "brain_hidden": 4, "sense_speed": True, "generation_s": 2, "population_size": 30,
           "survivors": 0}
LAYERS = ([f"hidden{h}<{source}" for h in range(1, 5)
           for source in ("food_bearing", "food_proximity", "poison_bearing", "poison_proximity", "speed", "bias")] +
          [f"{out}<{source}" for out in ("thrust", "turn") for source in ("hidden1", "hidden2", "hidden3", "hidden4",
                                                                          "bias")])


class Network(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.lab = evod.local(seed=3, experiment=NETWORK, data=cls.folder.name)
        cls.addClassCleanup(cls.lab.close)
        cls.world = cls.lab.world()
        cls.generations = list(cls.world.run(3))
        cls.world.step(40)

    def test_chromosomes_have_the_weights_after_the_body(self):
        info = self.world.info()
        self.assertEqual(info.gene_names, (*evod.GENE_NAMES, *LAYERS))
        self.assertEqual(info.gene_groups, (evod.GeneGroup.BODY,) * 6 + (evod.GeneGroup.BRAIN,) * len(LAYERS))
        population = self.world.population()
        self.assertEqual(population.genes.shape, (30, 6 + len(LAYERS)))
        self.assertEqual(population.genes.names, info.gene_names)
        numpy.testing.assert_array_equal(population.genes["turn<bias"], population.genes[:, -1])
        self.assertIn("hidden2<speed", population.to_pandas().columns)
        self.assertTrue(set(population.choices) <= {0, evod.Choice.STEER})
        self.assertIn(evod.Choice.STEER, population.choices)

    def test_statistics_contain_every_gene_by_name(self):
        last, history = self.generations[-1], self.world.history()
        self.assertEqual(last.genes.names, self.world.info().gene_names)
        self.assertEqual(last.islands[0].genes["turn<bias"], last.islands[0].genes[-1])
        self.assertEqual(history[-1].islands, last.islands)
        self.assertIn("thrust<hidden1_selection", history.to_pandas().columns)
        self.assertEqual(self.world.statistics().last[0].genes["hidden1<bias"].mean, last.genes["hidden1<bias"])
        numpy.testing.assert_allclose(last.selection + last.transmission + last.migration, last.change, atol=1e-9)
        with self.assertRaisesRegex(KeyError, "there is no gene 'impulsive'"):
            last.islands[0].genes["impulsive"]
        self.assertEqual(pickle.loads(pickle.dumps(last.islands[0].genes))["turn<bias"], last.islands[0].genes[-1])

    def test_snapshots_contain_the_headings(self):
        with self.world.snapshots(60) as snapshots:
            before = next(snapshots)
            for _ in range(5):
                self.world.step(7)
                snapshot = next(snapshots)
        self.assertGreater(snapshot.tick, before.tick)
        self.assertFalse(numpy.array_equal(snapshot.organisms.headings, self.world.snapshot().organisms.x_px))
        latest = self.world.snapshot()
        for organism, heading in zip(latest.organisms, latest.organisms.headings):
            off = (self.world.organism(organism.id).heading - heading + numpy.pi) % (2 * numpy.pi) - numpy.pi
            self.assertLessEqual(abs(off), STEP / 2 + 1e-6)
        numpy.testing.assert_array_equal(latest.to_pandas()["heading"], latest.organisms.headings)
        numpy.testing.assert_array_equal(latest.organisms[2:5].headings, latest.organisms.headings[2:5])
        if snapshot.tick == latest.tick:  # decoded from deltas
            numpy.testing.assert_array_equal(snapshot.organisms.headings, latest.organisms.headings)

    def test_headings_are_the_same_in_deltas_tiles_and_columns(self):
        messages, take = [], self.lab._link.core._take_snapshot
        self.lab._link.core._take_snapshot = lambda message: (messages.append(message), take(message))
        self.addCleanup(lambda: delattr(self.lab._link.core, "_take_snapshot"))
        whole = self.world.snapshot().organisms
        with self.world.snapshots(1, region=(0, 0, 5000, 5000)) as snapshots:
            tiles = next(snapshots).organisms
        numpy.testing.assert_array_equal(tiles.id, whole.id)
        numpy.testing.assert_array_equal(tiles.headings, whole.headings)
        for headings in (True, False):
            plain = c.SubscribeSnapshots(world=self.world.name, rate_hz=1, headings=headings)
            held = self.lab._link.core.subscribe(c.Request(subscribe_snapshots=plain))
            while messages[-1].codec != stream_pb2.CODEC_PLAIN:
                self.world.info()
            column = messages[-1].plain.organisms.heading
            numpy.testing.assert_allclose(column, whole.headings if headings else [], atol=1e-6)
            messages.append(messages[0])
            del held

    def test_the_run_can_be_verified(self):
        (path,) = pathlib.Path(self.folder.name).glob("*.evod")
        subprocess.run([PROGRAM, "verify", path], check=True, stdout=subprocess.DEVNULL)


class Rules(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=3)
        cls.addClassCleanup(cls.lab.close)
        cls.world = cls.lab.world()

    def test_rules_have_neither_heading_nor_network(self):
        organism = self.world.organism(1)
        self.assertEqual((organism.heading, organism.brain), (None, None))
        snapshot = self.world.snapshot()
        self.assertTrue(numpy.isnan(snapshot.organisms.headings).all())
        self.assertNotIn("heading", snapshot.to_pandas().columns)

    def test_snapshots_of_rules_never_have_headings(self):
        messages = []
        self.lab._link.core._take_snapshot = messages.append
        for codec in (stream_pb2.CODEC_PLAIN, stream_pb2.CODEC_DELTA):
            for headings in (False, True):
                request = c.SubscribeSnapshots(world=self.world.name, rate_hz=1, codec=codec, headings=headings)
                held = self.lab._link.core.subscribe(c.Request(subscribe_snapshots=request))
                count = len(messages)
                while len(messages) == count:
                    self.world.info()
                del held
            without, with_headings = messages[-2:]
            self.assertEqual((without.codec, with_headings.codec), (codec, codec))
            for message in (without, with_headings):
                message.ClearField("subscription_id")
                message.ClearField("sequence")
                message.ClearField("checksum")  # of the sequence, too
            self.assertEqual(without.SerializeToString(), with_headings.SerializeToString())


if __name__ == "__main__":
    unittest.main()
