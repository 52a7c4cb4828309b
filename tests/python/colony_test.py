"""Colonies: worlds with births and predators. Statistics of both species, organisms, and species in snapshots."""
import tempfile
import unittest

import numpy

import evod
from evod.v1 import commands_pb2 as c, stream_pb2

COLONY = {"reproduction": "births", "births": "asexual", "generation_s": 5, "population_size": 60, "food_count": 200,
          "predator_count": 12, "birth_health": 120, "health_loss_per_s": 4}


class Colony(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.lab = evod.local(seed=3, experiment=COLONY, data=cls.folder.name)
        cls.addClassCleanup(cls.lab.close)
        cls.world = cls.lab.world()
        cls.generations = list(cls.world.run(3))
        cls.world.step(100)

    def test_statistics_describe_both_species(self):
        last = self.generations[-1].islands[0]
        self.assertIsInstance(last.colony, evod.ColonyStatistics)
        self.assertIsNone(last.predators.predators)
        self.assertGreater(sum(g.islands[0].colony.born_count for g in self.generations), 0)
        self.assertEqual(last.predators.genes.names, evod.GENE_NAMES)
        first = self.generations[0].islands[0]
        self.assertEqual((first.colony.first_count, first.predators.colony.first_count), (60, 12))

    def test_tables_have_columns_of_both_species(self):
        history, table = self.world.history().to_pandas(), self.world.table("generations")
        self.assertEqual(sorted(history.columns), sorted(table.columns))
        numpy.testing.assert_array_equal(history["born_count"], table["born_count"])
        numpy.testing.assert_array_equal(history["predators_body_size_mean"], table["predators_body_size_mean"])
        self.assertEqual(history["predators_first_count"][0], 12)

    def test_organisms_have_a_species_and_a_number(self):
        snapshot = self.world.snapshot()
        species = snapshot.organisms.species
        self.assertEqual(numpy.count_nonzero(species), snapshot.live.predator_count)
        numpy.testing.assert_array_equal(snapshot.to_pandas()["species"], species)
        infos = [self.world.organism(organism.id) for organism in snapshot.organisms]
        self.assertEqual([info.species is evod.Species.PREDATOR for info in infos], (species == 1).tolist())
        self.assertEqual(len({info.number for info in infos}), len(infos))
        self.assertTrue(all(info.age_s >= info.lived_s - 1e-9 for info in infos))
        count = len(self.world.population())
        for info in infos:
            self.assertLessEqual(len(info.parents), 1)  # asexual; the others have their own id before
            self.assertTrue(info.placed_tick is None or all(parent < info.id for parent in info.parents))
        self.assertEqual(self.world.population().parents.shape, (count, 2))

    def test_species_are_the_same_in_deltas_tiles_and_columns(self):
        messages, take = [], self.lab._link.core._take_snapshot
        self.lab._link.core._take_snapshot = lambda message: (messages.append(message), take(message))
        self.addCleanup(lambda: delattr(self.lab._link.core, "_take_snapshot"))
        whole = self.world.snapshot().organisms
        with self.world.snapshots(1, region=(0, 0, 5000, 5000)) as snapshots:
            tiles = next(snapshots).organisms
        numpy.testing.assert_array_equal(tiles.id, whole.id)
        numpy.testing.assert_array_equal(tiles.species, whole.species)
        for species in (True, False):
            plain = c.SubscribeSnapshots(world=self.world.name, rate_hz=1, species=species)
            held = self.lab._link.core.subscribe(c.Request(subscribe_snapshots=plain))
            while messages[-1].codec != stream_pb2.CODEC_PLAIN:
                self.world.info()
            column = messages[-1].plain.organisms.species
            self.assertEqual(list(column), whole.species.tolist() if species else [])
            messages.append(messages[0])
            del held

    def test_breeding_is_refused(self):
        with self.assertRaisesRegex(evod.FailedPrecondition, "a world with births breeds no generations"):
            self.world.breeding()


class OneSpecies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=3)
        cls.addClassCleanup(cls.lab.close)
        cls.world = cls.lab.world()

    def test_other_worlds_show_nothing_of_colonies(self):
        organism = self.world.organism(1)
        self.assertEqual((organism.species, organism.number, organism.children), (None, None, 0))
        snapshot = self.world.snapshot()
        self.assertFalse(snapshot.organisms.species.any())
        self.assertNotIn("species", snapshot.to_pandas().columns)
        self.world.run(1).wait()
        self.assertNotIn("born_count", self.world.history().to_pandas().columns)
        self.assertIsNone(self.world.history()[0].islands[0].colony)

    def test_snapshots_are_those_without_species(self):
        messages = []
        self.lab._link.core._take_snapshot = messages.append
        for codec in (stream_pb2.CODEC_PLAIN, stream_pb2.CODEC_DELTA):
            for species in (False, True):
                request = c.SubscribeSnapshots(world=self.world.name, rate_hz=1, codec=codec, species=species)
                held = self.lab._link.core.subscribe(c.Request(subscribe_snapshots=request))
                count = len(messages)
                while len(messages) == count:
                    self.world.info()
                del held
            without, with_species = messages[-2:]
            for message in (without, with_species):
                self.assertEqual(message.codec, codec)
                for field in ("subscription_id", "sequence", "checksum"):  # the checksum is of the sequence, too
                    message.ClearField(field)
            self.assertEqual(without.SerializeToString(), with_species.SerializeToString())


if __name__ == "__main__":
    unittest.main()
