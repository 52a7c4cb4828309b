"""Requests of the synchronous module: every kind, refusals, several threads, interrupts, closing."""
import concurrent.futures
import contextlib
import os
import resource
import tempfile
import threading
import unittest
import warnings
from signal import SIGINT
from unittest import mock

import numpy

import evod
from evod.v1 import commands_pb2 as c, world_pb2 as w
from support import until
from every_request import finish, record_kinds, send_every_request


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=42, experiment={"population_size": 12, "generation_s": 2})
        cls.addClassCleanup(cls.lab.close)

    def refused(self, call, *fields):
        """The error of a refused call, whose violations are of exactly these fields."""
        with self.assertRaises(evod.Error) as raised:
            call()
        self.assertEqual(sorted(v.field for v in raised.exception.violations), sorted(fields), raised.exception)
        for violation in raised.exception.violations:
            self.assertTrue(violation.allowed and violation.got, violation)
        return raised.exception

    def test_every_kind_of_request_can_be_sent(self):
        with tempfile.TemporaryDirectory() as data, evod.local(seed=1, data=data) as lab:
            kinds = record_kinds(lab)
            finish(send_every_request(lab))
        self.assertEqual(kinds, set(field.name for field in c.Request.DESCRIPTOR.oneofs_by_name["kind"].fields))

    def test_a_damaged_world_is_listed_and_can_be_deleted(self):
        with tempfile.TemporaryDirectory() as data:
            with evod.local(seed=1, data=data) as lab:
                lab.create_world("plate")
            with open(os.path.join(data, "plate.evod"), "r+b") as file:
                file.truncate(20000)
            with evod.local(data=data) as lab:
                (damaged,) = lab.damaged_worlds()
                self.assertEqual((damaged.name, damaged.run_id), ("plate", ""))
                self.assertEqual([info.name for info in lab.worlds()], ["default"])
                world = lab.world("plate")
                with self.assertRaises(evod.FailedPrecondition) as raised:
                    world.info()
                self.assertEqual(raised.exception.reason, c.REASON_WORLD_DAMAGED)
                self.assertIn(damaged.reason, str(raised.exception))
                world.delete()
                self.assertEqual(lab.damaged_worlds(), ())
            self.assertTrue(os.path.exists(os.path.join(data, "plate.damaged-1.evod")))

    def test_settings_without_evolution_cause_warnings(self):
        with self.assertWarnsRegex(UserWarning, "no child is ever bred, because elite_count 12 is not below"):
            world = self.lab.create_world("elite", {"elite_count": 12, "population_size": 12})
        with self.assertWarnsRegex(UserWarning, "no child is ever bred"):
            world.reset()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            world.get_parameters()
            world.set(elite_count=1)
        with self.assertWarnsRegex(UserWarning, "because mutation and crossover are off"):
            world.set(mutation_chance=0, crossover="none", dry_run=True)

    def test_every_parameter_is_an_attribute(self):
        world = self.lab.create_world("attributes")
        registry, now = self.lab.registry(), world.get_parameters()
        self.assertEqual(list(now), list(registry))
        self.assertEqual(set(registry) - set(dir(world.parameters)), set())
        for name, description in registry.items():
            self.assertTrue(description.help and description.allowed and description.effect, name)
            self.assertEqual(getattr(now, name), description.default)
        for name in ("mutation_chance", "population_size", "respawn", "selection"):
            value = {"real": 0.25, "count": 20, "flag": False, "choice": "random"}[registry[name].kind]
            setattr(world.parameters, name, value)
            parameter = world.parameters[name]
            self.assertEqual(parameter.pending if parameter.pending is not None else parameter.value, value)
        with self.assertRaisesRegex(AttributeError, "did you mean mutation_chance"):
            world.parameters.mutation_chanc
        self.assertIn("Organisms on each island.", world.parameters._repr_html_())
        with mock.patch.object(world, "get_parameters", wraps=world.get_parameters) as read:
            self.assertEqual(dict(world.parameters), dict(world.get_parameters()))
            self.assertEqual([(name, parameter.name) for name, parameter in world.parameters.items()],
                             [(name, name) for name in registry])
        self.assertEqual(read.call_count, 3)
        world.delete()

    def test_values_out_of_range_are_refused_before_sending(self):
        world = self.lab.world()
        wrong = {"mutation_chance": 1.5, "elite_count": -1, "selection": "best", "respawn": "yes", "no_such": 1,
                 "population_size": 2.5, "tick_s": float("nan"), "mutation_step": True, "survivors": "half"}
        kinds = record_kinds(self.lab)
        error = self.refused(lambda: world.set(wrong), *wrong)
        self.assertNotIn("set_parameters", kinds)
        self.assertEqual(error.code_name, "INVALID_ARGUMENT")
        got = {violation.field: violation.got for violation in error.violations}
        for name, text in {"respawn": "'yes'", "mutation_step": "True", "survivors": "'half'", "population_size": "2.5",
                           "mutation_chance": "1.5", "selection": "best"}.items():
            self.assertEqual(got[name], text)
        by_name = {"mutation_chance": w.ParameterValue(real=1.5), "selection": w.ParameterValue(choice="best")}
        assignments = [w.ParameterAssignment(name=name, value=value) for name, value in by_name.items()]
        refusal = self.refused(lambda: self.lab.request(set_parameters=c.SetParameters(parameters=assignments)),
                               *by_name)
        self.assertEqual(set(refusal.violations) - set(error.violations), set())
        self.assertEqual(refusal.message, error.message)

    def test_wrong_places_are_named_by_argument(self):
        world = self.lab.create_world("places", seed=3)
        with self.assertRaises(evod.InvalidArgument) as refused:
            world.place(food=[(1, 40)], poison=[(30, 40), (-4, 40)])
        self.assertEqual([v.field for v in refused.exception.violations], ["food[0].x_px", "poison[1].x_px"])
        for wrong in ({"food": [1, 2]}, {"organisms": [(30, 40)]}, {"organisms": [(30, 40, {"impulse": 3})]}):
            with self.assertRaises(evod.InvalidArgument):
                world.place(**wrong)
        world.remove(organisms=[3], generation=1)
        self.assertEqual(world.organism(3).cause_of_death, evod.CauseOfDeath.REMOVED)
        with self.assertRaises(evod.Aborted):
            world.remove(organisms=[4], generation=2)
        world.delete()

    def test_numpy_numbers_are_accepted(self):
        world = self.lab.world()
        parameters = world.set(mutation_chance=numpy.float32(0.5), elite_count=numpy.int64(3), respawn=numpy.True_,
                               mutation_step=numpy.int8(7), dry_run=True)
        self.assertEqual((parameters.mutation_chance, parameters.elite_count, parameters.mutation_step), (0.5, 3, 7))
        self.assertNotEqual(world.parameters.elite_count, 3)

    def test_refusals_name_every_wrong_field(self):
        world = self.lab.world()
        self.refused(lambda: world.set(tournament_winners=9), "tournament_size")
        self.refused(lambda: world.set(mutation_chance=0.1, expected_revision=77), "expected_revision")
        self.refused(lambda: self.lab.create_world("../x"), "name")
        self.refused(lambda: world.run(generations=0), "generations")
        self.refused(lambda: world.run(generations=-1), "generations")
        self.refused(lambda: world.run(generations=1.5), "generations")
        self.refused(lambda: world.set_speed(0), "speed")
        self.refused(lambda: world.set_speed("fast"), "speed")
        self.refused(lambda: world.snapshots(rate_hz=0), "rate_hz")
        self.refused(lambda: world.snapshots(detail="all"), "detail")
        self.refused(lambda: world.snapshots(region=(0, 0, 1)), "region")
        self.refused(lambda: world.export("organism"), "table")
        self.refused(lambda: world.step(-1), "ticks")
        self.refused(lambda: world.step("one"), "ticks")
        self.refused(lambda: world.organism(-1, island=2**32), "organism", "island")
        self.refused(lambda: world.reset(seed=2**64), "seed")
        self.refused(lambda: world.fork(7), "name")
        self.refused(lambda: world.history(first=0.5), "first")
        self.refused(lambda: world.export("lineage", of=(1, -1, 2)), "of.island")
        self.refused(lambda: world.snapshots(region=(0, 0, "1", 1)), "region.width_px")
        self.refused(lambda: world.snapshots(bytes_per_s_max=-1), "bytes_per_s_max")
        with self.assertRaisesRegex(KeyError, "there is no world 'nowhere'; the worlds are: default"):
            self.lab.world("nowhere")
        with self.assertRaises(evod.NotFound) as raised:
            world.organism(12)
        self.assertEqual(raised.exception.code_name, "NOT_FOUND")
        with self.assertRaises(evod.FailedPrecondition) as raised:
            world.resume()
        self.assertEqual(raised.exception.reason, c.REASON_NOTHING_TO_RESUME)
        self.assertEqual([info.name for info in self.lab.worlds()], ["default"])

    def test_a_local_server_keeps_runs_until_it_ends(self):
        with evod.local(seed=3, experiment={"population_size": 20, "generation_s": 1}) as lab:
            world = lab.create_world("other", {"population_size": 20, "generation_s": 1})
            self.assertEqual(world.info().speed, "max", "created worlds have the speed of local(), too")
            world.run(generations=3).wait()
            with world.open_replay(generation=2) as replay:
                self.assertEqual((replay.info().generation, replay.info().speed), (2, "max"))
            twin = world.fork("twin", at_generation=2).info()
            self.assertEqual((twin.generation, twin.speed), (2, "max"))
            self.assertEqual(len(world.table("generations")), 3)
            folder = next(line.split(" stored in ")[1] for line in lab.log.splitlines() if " stored in " in line)
            self.assertTrue(os.path.isdir(folder))
        self.assertFalse(os.path.exists(folder))

    def test_a_world_begins_with_the_given_population(self):
        genes = numpy.linspace(90, 110, 4 * 6).reshape(4, 6)
        world = self.lab.create_world("given", {"population_size": 4}, population=[genes])
        numpy.testing.assert_array_equal(world.population().genes, genes.astype("f4"))
        world.delete()
        self.refused(lambda: self.lab.create_world("given", {"population_size": 3}, population=[genes]),
                     "population[0]")

    def test_a_world_may_begin_with_fewer_organisms(self):
        drawn = self.lab.create_world("drawn", {"population_size": numpy.float64(4)}, seed=numpy.int64(5))
        genes = numpy.full((2, 6), 100.0)
        world = self.lab.create_world("few", {"population_size": numpy.float64(4)}, seed=5, population=[genes])
        numpy.testing.assert_array_equal(world.population().genes[:2], genes)
        numpy.testing.assert_array_equal(world.population().genes[2:], drawn.population().genes[2:])
        world.delete()
        drawn.delete()

    def test_many_threads_share_a_connection(self):
        world = self.lab.create_world("shared", speed="max")
        with world.snapshots(rate_hz=120) as snapshots, concurrent.futures.ThreadPoolExecutor(8) as pool:
            run = world.run()
            seen = pool.submit(lambda: [next(snapshots).tick for _ in range(20)])
            ended = pool.submit(lambda: [next(run).number for _ in range(20)])
            answers = [pool.submit(world.organism, i % 50) for i in range(300)]
            self.assertEqual([answer.result().id for answer in answers], [i % 50 for i in range(300)])
            self.assertEqual(ended.result(), list(range(1, 21)))
            self.assertEqual(seen.result(), sorted(seen.result()))
        world.delete()

    def test_file_descriptors_above_1024_work(self):
        limits = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(2000, limits[1]), limits[1]))
        self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, limits)
        with contextlib.ExitStack() as files:
            for _ in range(1100):
                files.enter_context(open("/dev/null"))
            with evod.connect(self.lab.address) as lab:
                self.assertEqual([info.name for info in lab.worlds()], ["default"])

    def test_an_interrupt_leaves_the_connection_usable(self):
        events = self.lab.world().events()
        for _ in range(3):
            def interrupt():
                until(lambda: self.lab._link._inner._waiters, "the call waits")
                os.kill(os.getpid(), SIGINT)

            waits = threading.Thread(target=interrupt)
            waits.start()
            with self.assertRaises(KeyboardInterrupt):
                next(events)
            waits.join()
            self.assertEqual([info.name for info in self.lab.worlds()], ["default"])
        events.close()

    def test_closing_fails_waiting_calls(self):
        lab = evod.connect(self.lab.address)
        events, failures = lab.world().events(), []

        def wait():
            try:
                next(events)
            except evod.NoConnection as error:
                failures.append(error.message)

        waiting = threading.Thread(target=wait)
        waiting.start()
        until(lambda: lab._link._inner._waiters, "the call waits")
        lab.close()
        waiting.join()
        self.assertEqual(failures, ["the connection was closed here"])
        with self.assertRaisesRegex(evod.NoConnection, "closed here"):
            lab.worlds()
        lab.close()


if __name__ == "__main__":
    unittest.main()
