"""The streams of a world: generations, snapshots and events, also while another client changes the world."""
import contextlib
import pathlib
import tempfile
import threading
import unittest

import evod
import support
import waiting
from evod.core import UNACKNOWLEDGED_MAX
from evod.v1 import commands_pb2 as c, world_pb2


def numbers(run):
    return [g.number for g in run]


class Generations(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=42)
        cls.addClassCleanup(cls.lab.close)

    def setUp(self):
        name = self.id().rsplit(".")[-1][:60]
        self.world = self.lab.create_world(name, {"population_size": 12, "generation_s": 2}, seed=7, speed="max")
        self.addCleanup(lambda: self.world.name in [x.name for x in self.lab.worlds()] and self.world.delete())

    def test_consecutive_runs_return_each_generation_once(self):
        self.assertEqual(numbers(self.world.run(2)), [1, 2])
        self.assertEqual(numbers(self.world.run(3)), [3, 4, 5])
        run = self.world.run()
        self.assertEqual([next(run).number for _ in range(2)], [6, 7])

    def test_generations_equal_the_history(self):
        generations = list(self.world.run(5))
        history = self.world.history()
        self.assertEqual([g.islands for g in generations], [g.islands for g in history])
        for g in generations:
            self.assertEqual((g.best, g.worst), (g.islands[0].fitness_best, g.islands[0].fitness_worst))
            self.assertEqual(g.genes.tolist(), [gene.mean for gene in g.islands[0].genes])
        self.assertEqual([g.number for g in self.world.history(2, 3)], [2, 3])

    def test_a_generation_contains_all_islands(self):
        world = self.lab.create_world("islands", {"island_count": 3, "population_size": 12, "generation_s": 2},
                                      speed="max")
        (g,) = world.run(1)
        self.assertEqual([island.island for island in g.islands], [0, 1, 2])
        self.assertEqual(g.best, max(island.fitness_best for island in g.islands))
        self.assertAlmostEqual(g.mean, sum(island.fitness_mean for island in g.islands) / 3)
        self.assertEqual({snapshot.island for _, snapshot in zip(range(3), world.snapshots())}, {0, 1, 2})
        world.delete()

    def test_a_run_shortened_by_another_command_ends(self):
        run = self.world.run(10**6)
        self.world.run(1)
        self.assertEqual(numbers(run)[-1], self.world.wait().generation)

    def test_a_termination_criterion_ends_a_run(self):
        self.world.set(generation_limit=4)
        self.assertEqual(numbers(self.world.run(50)), [1, 2, 3, 4])
        self.assertEqual(self.world.info().state, world_pb2.RUN_STATE_TERMINATED)

    def test_a_reset_or_deleted_world_fails_its_run(self):
        run = self.world.run()
        self.world.reset()
        with self.assertRaisesRegex(evod.Error, "was reset while it ran"):
            numbers(run)
        run = self.world.run()
        self.world.delete()
        with self.assertRaisesRegex(evod.Error, "was deleted while it ran"):
            numbers(run)

    def test_a_world_runs_without_being_iterated(self):
        self.world.run(3)
        self.assertEqual(self.world.wait().generation, 3)

    def test_closed_snapshots_are_unsubscribed(self):
        snapshots = self.world.snapshots(10**6)
        self.assertEqual(snapshots.rate_hz, self.lab.describe().limits.snapshot_rate_hz_max)
        next(snapshots)
        snapshots.close()
        self.world.run(2).wait()
        self.assertEqual(self.lab._link.core._streams, {})

    def test_a_slow_reader_receives_fewer_snapshots(self):
        with self.world.snapshots(120) as snapshots:
            self.world.run()
            next(snapshots)
            while len(snapshots._stream._subscription.arrived) < UNACKNOWLEDGED_MAX - 1:
                self.world.info()
            last = self.world.pause()
            behind = []
            while not behind or behind[-1].tick < last.tick:
                behind.append(next(snapshots))
        self.assertLessEqual(len(behind), UNACKNOWLEDGED_MAX)
        self.assertEqual([snapshot.tick for snapshot in behind], sorted(snapshot.tick for snapshot in behind))

    def test_events_are_of_one_world_or_of_all(self):
        events, everything = self.world.events(), self.lab.events()
        other = self.lab.create_world("other")
        self.world.pause()
        other.delete()
        self.assertEqual(next(events).WhichOneof("kind"), "run_control_changed")
        kinds = [event.WhichOneof("kind") for _, event in zip(range(4), everything)]
        # The first run_control_changed is the speed of the new world, which is that of evod.local().
        self.assertEqual(kinds, ["world_created", "run_control_changed", "run_control_changed", "world_deleted"])


class Damage(unittest.TestCase):
    def test_everything_that_waits_ends_with_the_reason(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        server = support.Server("--data", folder.name)
        self.addCleanup(server.kill)
        lab = evod.connect(f"127.0.0.1:{server.port}")
        self.addCleanup(lab.close)
        parameters = {"population_size": 12, "generation_s": 2}
        world = lab.create_world("a", parameters, seed=7, speed="max")
        other = lab.create_world("b", parameters, seed=7, speed="max")
        run, snapshots = world.run(), world.snapshots(10)
        next(run)
        next(snapshots)
        ends = []

        def end_of(wait):
            with contextlib.suppress(StopIteration):
                try:
                    while True:
                        wait()
                except evod.FailedPrecondition as error:
                    ends.append(error)

        threads = [threading.Thread(target=end_of, args=(wait,))
                   for wait in (run.__next__, snapshots.__next__, world.wait)]
        for thread in threads:
            thread.start()
        path = pathlib.Path(folder.name, "a.evod")
        for file in (path, pathlib.Path(f"{path}-wal"), pathlib.Path(f"{path}-shm")):
            with open(file, "r+b") as damaged:
                damaged.write(b"x" * file.stat().st_size)
        waiting.until(lambda: not any(thread.is_alive() for thread in threads), "the ends")
        self.assertEqual(len(ends), 3)
        reason = lab.damaged_worlds()[0].reason
        for error in ends:
            self.assertIn("does not run: " + reason, str(error))
            self.assertEqual(error.reason, c.REASON_WORLD_DAMAGED)
        self.assertEqual(other.run(2).wait().number, 2)


if __name__ == "__main__":
    unittest.main()
