"""Results are frozen dataclasses with states, names of genes, and tables."""
import dataclasses
import inspect
import json
import pathlib
import pickle
import unittest

import numpy

import evod
from evod import plans, tables
from evod.conversion import result
from evod.results import CLASSES, STATES
from evod.v1 import commands_pb2, session_pb2, stream_pb2, world_pb2

VECTORS = pathlib.Path(__file__).resolve().parents[2] / "proto/vectors"
SMALL = {"island_count": 2, "population_size": 12, "generation_s": 2, "migration": "ring", "migration_epoch": 1}


class Numbers(unittest.TestCase):
    def test_a_fitness_has_the_text_of_all_programs(self):
        for fitness, text in json.loads((VECTORS / "fitness.json").read_text()):
            self.assertEqual(tables.fitness_text(fitness), text)


class Conversion(unittest.TestCase):
    def test_every_field_of_the_protocol_is_converted(self):
        messages = {name: message for module in (world_pb2, commands_pb2, session_pb2)
                    for name, message in module.DESCRIPTOR.message_types_by_name.items()}
        for name, kind in CLASSES.items():
            fields = [field.name.removesuffix("_") for field in dataclasses.fields(kind)]  # `class` is a keyword
            left_out = {evod.results.EntityIds: {"by"},  # in events only
                        evod.ClassInfo: {"template"},
                        evod.results.Descendant: {"more_from_second"}}.get(kind, set())  # part of from_second
            self.assertEqual(set(fields), set(messages[name].fields_by_name) - left_out, name)

    def test_every_state_has_its_name(self):
        for name, state in STATES.items():
            module = next(m for m in (world_pb2, commands_pb2) if name in m.DESCRIPTOR.enum_types_by_name)
            values = {v.name: v.number for v in module.DESCRIPTOR.enum_types_by_name[name].values if v.number}
            prefix = len(min(values, key=len)) and "".join("_" + c if c.isupper() else c.upper()
                                                           for c in name)[1:] + "_"
            self.assertEqual({prefix + member.name: member.value for member in state}, values)
        details = {v.name: v.number for v in stream_pb2.Detail.DESCRIPTOR.values if v.number}
        self.assertEqual({f"DETAIL_{member.name}": member.value for member in evod.Detail}, details)

    def test_comments_are_those_of_the_protocol(self):
        self.assertEqual(evod.Pick.__doc__, "One selection of a parent.")
        source = inspect.getsource(evod.results)
        for line in ("outcome: Outcome | None  #: None: the run has not ended", "state: RunState\n",
                     "replay: ReplayRange | None  #: None: this is a live world",
                     "reason: str  #: text for the user; empty in StorageState.KEEPS_UP"):
            self.assertIn(f"    {line}", source)

    def test_states_of_newer_servers_are_kept(self):
        info = result(world_pb2.WorldInfo(state=77, speed=world_pb2.Speed(real_time_factor=2)))
        self.assertEqual((info.state.value, str(info.state), info.speed), (77, "unknown_77", 2.0))
        self.assertEqual((info.outcome, info.replay, info.run_until_tick), (None, None, None))


class Genes(unittest.TestCase):
    def setUp(self):
        self.values = numpy.arange(36.0).reshape(6, 6)  # as many organisms as genes: a name must not select a row
        self.genes = evod.Genes(self.values)

    def test_names_select_columns(self):
        numpy.testing.assert_array_equal(self.genes["body_size"], self.values[:, 2])
        self.assertEqual(self.genes[1]["impulse"], 7)
        self.assertEqual(self.genes[[1, 4]]["impulse"].tolist(), [7, 25])
        self.assertEqual(self.genes[self.values[:, 0] > 20]["impulse"].tolist(), [25, 31])
        self.assertEqual(self.genes[1:3].to_dict()["impulse"].tolist(), [7, 13])
        with self.assertRaisesRegex(KeyError, "no gene 'size'; the genes are: normal_speed, impulse"):
            self.genes["size"]

    def test_results_of_calculations_have_no_names(self):
        for array in (self.genes[:, 2], self.genes.T, self.genes + 1, self.genes.mean(axis=1), self.genes[:, ::-1]):
            if isinstance(array, evod.Genes):
                with self.assertRaises(KeyError):
                    array["impulse"]
            else:
                self.assertIs(type(array), numpy.ndarray)
        self.assertIs(type(self.genes[0] - self.genes[1]), numpy.ndarray)
        self.genes += 1
        self.assertEqual(self.genes[0]["impulse"], 2)

    def test_a_wrong_shape_is_refused(self):
        with self.assertRaisesRegex(ValueError, r"got the shape \(5,\), allowed"):
            evod.Genes(numpy.zeros(5))

    def test_genes_are_pickled_with_their_names(self):
        self.assertEqual(pickle.loads(pickle.dumps(self.genes))[2]["impulse"], 13)
        numpy.testing.assert_array_equal(pickle.loads(pickle.dumps(self.genes.T)), self.values.T)


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=3, experiment=SMALL)
        cls.addClassCleanup(cls.lab.close)
        cls.world = cls.lab.world()
        cls.world.run(4).wait()

    def test_queries_return_frozen_dataclasses(self):
        world = self.world
        for made, kind in ((world.info(), evod.WorldInfo), (world.statistics(), evod.Statistics),
                           (world.motion(), evod.Motion),
                           (world.organism(1), evod.OrganismInfo), (world.breeding(), evod.Breeding),
                           (self.lab.world_infos()[0], evod.WorldInfo), (world.set_speed("max"), evod.WorldInfo)):
            self.assertIs(type(made), kind)
            self.assertIn("<table>", made._repr_html_())
            with self.assertRaises(dataclasses.FrozenInstanceError):
                made.island = 1
        info = world.info()
        self.assertIs(info.state, evod.RunState.WAITING)
        self.assertEqual((info.seed, info.speed, info.gene_names), (3, "max", evod.GENE_NAMES))

    def test_an_organism_is_the_row_of_the_population(self):
        organism, population = self.world.organism(5), self.world.population()
        numpy.testing.assert_array_equal(organism.genes, population.genes[5])
        self.assertEqual(organism.genes["body_size"], population.genes["body_size"][5])
        table = population.to_pandas()
        self.assertEqual(table["body_size"][5], organism.genes["body_size"])
        self.assertEqual(table["parent_first"][5], organism.parents[0])
        self.assertEqual((organism.alive, organism.cause_of_death), (True, None))

    def test_breeding_explains_each_descendant(self):
        breeding = self.world.breeding()
        self.assertEqual(breeding.generation, 3)
        self.assertEqual(breeding.parameters["selection"], self.world.parameters.selection)
        genes = self.world.population().genes
        for descendant in breeding.descendants:
            numpy.testing.assert_array_equal(descendant.genes, genes[descendant.id])
        kinds = {descendant.kind for descendant in breeding.descendants}
        self.assertLessEqual(kinds, set(evod.DescendantKind))
        self.assertIn(evod.DescendantKind.CHILD, kinds)

    def test_the_history_is_the_exported_table(self):
        history, exported = self.world.history(), self.world.table("generations")
        frame = history.to_pandas()
        self.assertEqual(sorted(frame.columns), sorted(exported.columns))
        self.assertEqual(len(frame), 8)
        for name in exported.columns:
            numpy.testing.assert_array_equal(frame[name], exported[name], name)
        self.assertEqual(history[1].genes["impulse"], history[1].genes[1])
        self.assertEqual(history[0].islands[1].genes["impulse"].mean, exported["impulse_mean"][1])
        self.assertIn("<td>4</td>", history._repr_html_())


class Snapshots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=3, experiment={"population_size": 12, "generation_s": 2, "crate_count": 2})
        cls.addClassCleanup(cls.lab.close)

    def test_entities_can_be_indexed(self):
        snapshot = self.lab.world().snapshot()
        organisms = snapshot.organisms
        numpy.testing.assert_array_equal(organisms.positions, numpy.stack((organisms.x_px, organisms.y_px), axis=1))
        self.assertEqual(organisms[3], (3, organisms.x_px[3], organisms.y_px[3], organisms.radius_px[3],
                                        organisms.health[3]))
        self.assertEqual([organism.id for organism in organisms][-1], organisms[-1].id)
        left = organisms[organisms.x_px < 600]
        self.assertEqual(left.id.tolist(), organisms.id[organisms.x_px < 600].tolist())
        self.assertEqual(left[1:3].x_px.tolist(), left.x_px[1:3].tolist())
        self.assertEqual(snapshot.crates[1].half_width_px, snapshot.crates.half_width_px[1])
        self.assertEqual(len(snapshot.food[:5]), 5)
        table = snapshot.to_pandas()
        self.assertEqual(list(table.columns[:6]), ["tick", "generation", "island", "id", "x_px", "y_px"])
        self.assertEqual(table["x_px"].tolist(), organisms.x_px.tolist())
        self.assertIn("12 organisms, the first 10", organisms._repr_html_())
        with self.assertRaises(IndexError):
            organisms[12]

    def test_genes_are_those_of_the_generation(self):
        world = self.lab.world()
        numpy.testing.assert_array_equal(world.snapshot(genes=True).organisms.genes, world.population().genes)
        with self.assertRaisesRegex(evod.FailedPrecondition, r"snapshot\(genes=True\)"):
            world.snapshot().organisms.genes
        seen = {}
        with world.snapshots(rate_hz=500, genes=True) as snapshots:
            world.run()
            for snapshot in snapshots:
                seen[snapshot.generation] = snapshot.organisms
                if len(seen) == 5:
                    break
        world.pause()
        for generation, organisms in seen.items():
            stored = world.table("population", generation=generation)
            numpy.testing.assert_array_equal(organisms.genes["body_size"], stored["body_size"].to_numpy()[organisms.id])
        first = organisms[:1]
        self.assertEqual(first.genes["body_size"][0], first.to_pandas()["body_size"][0])

    def test_genes_of_an_ended_generation_are_read(self):
        world = self.lab.create_world("past", {"population_size": 12, "generation_s": 1}, seed=5)
        snapshot, genes = world.snapshot(), world.population().genes
        world.run(2).wait()
        world.run(1).wait()
        self.assertFalse(numpy.array_equal(world.population().genes, genes))
        numpy.testing.assert_array_equal(self.lab._link.perform(plans.genes_of(snapshot)), genes)
        world.reset(seed=6)
        with self.assertRaisesRegex(evod.NotFound, "was reset before the genes of the snapshot were requested"):
            self.lab._link.perform(plans.genes_of(snapshot))

    def test_velocities_are_those_of_the_organisms(self):
        world = self.lab.create_world("moving", {"population_size": 12}, seed=3)
        with world.snapshots(rate_hz=1000) as snapshots:
            self.assertTrue(numpy.isnan(next(snapshots).organisms.velocities).all())
            for tick in range(1, 8):
                world.step()
                snapshot = next(snapshots)
                while snapshot.tick < tick:
                    snapshot = next(snapshots)
        organism = world.organism(4)
        velocity = snapshot.organisms[snapshot.organisms.id == 4].velocities[0]
        self.assertEqual(snapshot.organisms.velocities.shape, (12, 2))
        # Both ends of the displacement are rounded to 1/16 px, and a tick lasts 1/60 s.
        self.assertAlmostEqual(velocity[0], organism.velocity_x_px_s, delta=60 / 16)
        self.assertAlmostEqual(velocity[1], organism.velocity_y_px_s, delta=60 / 16)
        self.assertGreater(abs(velocity).max(), 0)

    def test_snapshots_with_a_view_have_no_velocities(self):
        world = self.lab.world()
        with world.snapshots(detail="full") as snapshots:
            snapshot = next(snapshots)
        self.assertIs(snapshot.tiles[0].detail, evod.Detail.FULL)
        self.assertTrue(numpy.isnan(snapshot.organisms.velocities).all())


class Notebooks(unittest.TestCase):
    def test_objects_are_shown_as_tables(self):
        with evod.local(seed=1) as lab:
            world = lab.world()
            run = world.run(1)
            run.wait()
            for thing, text in ((lab, lab.address), (world, "run_id"), (run, "default"),
                                (world.snapshot(), "generation"),
                                (world.parameters, "mutation_chance"), (world.snapshot().food, "x_px")):
                self.assertIn("<table>", thing._repr_html_())
                self.assertIn(text, thing._repr_html_())
            self.assertEqual(repr(run), "<run of default: generations 1 to 1>")
            other = lab.create_world("other")
            other.delete()
            self.assertIn("other", other._repr_html_())


if __name__ == "__main__":
    unittest.main()
