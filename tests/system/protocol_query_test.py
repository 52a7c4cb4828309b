"""Queries of the protocol, and snapshots of whole islands.

Arguments as in plain_client.py.
"""
import itertools
import math
import sys
import time
import types
import unittest

import numpy

from plain_client import (
    INVALID, NOT_FOUND, Client, columns, WithServer, c, stream_pb2, w,
)


class Snapshots(WithServer):
    def setUp(self):
        super().setUp()
        self.viewer = self.enterContext(Client(self.server))

    def subscribe(self, world, rate_hz=100.0, island=None):
        return self.viewer.call(subscribe_snapshots=c.SubscribeSnapshots(
            world=world, rate_hz=rate_hz, island=island)).subscription

    def test_a_snapshot_shows_the_world_as_it_is(self):
        world = self.new_world(seed=11, obstacle_count=3, crate_count=2, obstacle_size_px=50, crate_size_px=30)
        self.client.run_to(50, world)
        subscription = self.subscribe(world)
        snapshot = self.viewer.next_snapshot()
        info = self.client.world(world)
        for field in ("tick", "generation", "generation_tick", "simulated_s", "state"):
            self.assertEqual(getattr(snapshot, field), getattr(info, field), field)
        self.assertEqual((snapshot.state_hash.hex(), snapshot.run_id.hex()), (info.state_hash, info.run_id))
        self.assertEqual((snapshot.world, snapshot.island, snapshot.island_count), (world, 0, 1))
        self.assertEqual((snapshot.width_px, snapshot.height_px, snapshot.item_radius_px), (1280, 720, 4))
        self.assertEqual((snapshot.codec, snapshot.subscription_id),
                         (stream_pb2.CODEC_PLAIN, subscription.subscription_id))
        live = self.client.call(get_statistics=c.GetStatistics(world=world)).statistics.live[0]
        self.assertEqual(snapshot.live, live)
        self.assertEqual(snapshot.organism_count, live.alive_count)
        self.assertEqual((snapshot.crate_count, snapshot.obstacle_count), (2, 3))
        self.assertLessEqual(snapshot.food_count, 25)
        seen = columns(snapshot)
        self.assertEqual(set(seen["obstacles"]["half_width"]), {25.0})
        self.assertEqual(set(seen["crates"]["half_height"]), {15.0})
        for kind in ("organisms", "food", "poison"):
            self.assertTrue((numpy.diff(seen[kind]["id"].astype(int)) > 0).all())
            self.assertTrue((seen[kind]["x"] <= 1280).all() and (seen[kind]["y"] <= 720).all())
        organisms = seen["organisms"]
        for row, organism in enumerate(organisms["id"]):
            answer = self.client.call(get_organism=c.GetOrganism(world=world, organism=int(organism))).organism
            self.assertTrue(answer.alive)
            self.assertLessEqual(abs(answer.x_px - organisms["x"][row]), 1 / 32)
            self.assertLessEqual(abs(answer.y_px - organisms["y"][row]), 1 / 32)
            self.assertLessEqual(abs(answer.radius_px - organisms["radius"][row]), 1 / 32)
            self.assertLessEqual(abs(answer.health - organisms["health"][row]), 1 / 32)
            self.assertAlmostEqual(answer.lived_s, 50 / 60)
            self.assertAlmostEqual(answer.radius_px, answer.genes[2] * 0.1, places=4)

    def test_snapshots_end_with_the_last_tick(self):
        world = self.new_world()
        began = time.monotonic()
        self.subscribe(world, 30.0)
        self.assertEqual(self.viewer.next_snapshot().tick, 0)
        self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=40))
        ticks, snapshot = [], None
        while snapshot is None or snapshot.tick < 40:
            snapshot = self.viewer.next_snapshot()
            ticks.append(snapshot.tick)
        self.assertEqual(ticks, sorted(ticks))
        # At 30 Hz with a few extra snapshots: 40 ticks take 2/3 s, so about 20 are shown.
        self.assertLess(len(ticks), 30 * (time.monotonic() - began) + 8)
        self.assertEqual((snapshot.state, snapshot.state_hash.hex()),
                         (w.RUN_STATE_PAUSED, self.client.world(world).state_hash))
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])  # the world is idle

    def test_islands_alone_and_together(self):
        world = self.new_world(island_count=3)
        everyone, one = self.subscribe(world), self.subscribe(world, island=2)
        self.assertEqual((everyone.subscription_id, one.subscription_id), (1, 2))
        seen = {}
        while len(seen) < 4:
            snapshot = self.viewer.next_snapshot()
            seen[snapshot.subscription_id, snapshot.island] = snapshot
        self.assertEqual(set(seen), {(1, 0), (1, 1), (1, 2), (2, 2)})
        self.assertEqual(seen[1, 2].plain, seen[2, 2].plain)
        status = self.viewer.call(NOT_FOUND, subscribe_snapshots=c.SubscribeSnapshots(
            world=world, rate_hz=1, island=3)).status
        self.assertEqual([(v.field, v.allowed, v.got) for v in status.violations],
                         [("subscribe_snapshots.island", "0 to 2", "3")])

    def test_rates(self):
        world = self.new_world()
        self.assertEqual(self.subscribe(world, 1e6).rate_hz, self.viewer.welcome.limits.snapshot_rate_hz_max)
        for rate in (0.0, -1.0, math.nan, math.inf):
            status = self.viewer.call(INVALID, subscribe_snapshots=c.SubscribeSnapshots(world=world,
                                                                                        rate_hz=rate)).status
            self.assertEqual([v.field for v in status.violations], ["subscribe_snapshots.rate_hz"])

    def test_a_fitness_of_genes_alone_has_empty_snapshots(self):
        world = self.new_world(fitness="rastrigin")
        self.subscribe(world)
        snapshot = self.viewer.next_snapshot()
        self.assertEqual((snapshot.organism_count, len(snapshot.plain.organisms.id)), (0, 0))
        self.assertGreater(snapshot.width_px, 0)

    def test_a_viewer_that_dies_in_mid_snapshot_leaves_no_trace(self):
        world = self.new_world(food_count=50_000, island_width_px=4000.0, island_height_px=4000.0)
        self.client.call(run=c.Run(world=world))
        for _ in range(5):
            with Client(self.server) as viewer:
                viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=120))
                viewer.read(100)
        now = self.client.world(world).tick
        self.client.wait_world(lambda x: x.tick > now, world)


class Queries(WithServer):
    def test_history_in_parts(self):
        world = self.new_world(fitness="gene_sum", island_count=7)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world, generations=300))
        self.client.wait_world(lambda x: x.state == w.RUN_STATE_WAITING, world)
        got, first, answers = [], None, 0
        while True:
            history = self.client.call(get_history=c.GetHistory(world=world, first_generation=first)).history
            self.assertLessEqual(len(history.generations), self.client.welcome.limits.history_generations_max)
            got += [(s.generation, s.island) for s in history.generations]
            answers += 1
            if not history.HasField("next_generation"):
                break
            first = history.next_generation
        self.assertEqual(got, list(itertools.product(range(1, 301), range(7))))
        self.assertGreater(answers, 1)
        part = self.client.call(get_history=c.GetHistory(world=world, first_generation=5, last_generation=7, island=6))
        self.assertEqual([(s.generation, s.island) for s in part.history.generations], [(5, 6), (6, 6), (7, 6)])
        self.assertEqual(len(self.client.call(
            get_history=c.GetHistory(world=world, first_generation=1 << 60)).history.generations), 0)
        self.client.call(INVALID, get_history=c.GetHistory(world=world, first_generation=5, last_generation=4))
        self.client.call(NOT_FOUND, get_history=c.GetHistory(world=world, island=7))

    def test_statistics_before_and_after_a_generation(self):
        world = self.new_world(generation_s=1)
        before = self.client.call(get_statistics=c.GetStatistics(world=world)).statistics
        self.assertEqual((len(before.live), len(before.last)), (1, 0))
        self.assertEqual((before.live[0].organism_count, before.live[0].alive_count), (50, 50))
        self.client.run_to(61, world)
        after = self.client.call(get_statistics=c.GetStatistics(world=world)).statistics
        self.assertEqual((after.world.generation, after.last[0].generation, after.last[0].end_tick), (2, 1, 60))
        self.assertGreaterEqual(after.last[0].fitness_best, after.last[0].fitness_mean)

    def population(self, world, island=0, first=0, client=None):
        """A part of a population, with its columns as arrays."""
        answer = (client or self.client).call(
            get_population=c.GetPopulation(world=world, island=island, first_organism=first)).population
        columns = lambda data, kind, count: numpy.frombuffer(data, kind).reshape(count, -1)
        return types.SimpleNamespace(
            answer=answer, genes=columns(answer.genes, "<f4", 6), parents=columns(answer.parents, "<u4", 2),
            founders=numpy.frombuffer(answer.founders, "<u4"), choices=numpy.frombuffer(answer.choices, "u1"),
                                     forces=columns(answer.forces, "<f4", 2),
            targets=columns(answer.targets, "<f4", 2))

    def compare_with_organisms(self, world, island=0):
        """Asserts that every row of a population equals the answer to GetOrganism."""
        all_of_them = self.population(world, island)
        answer = all_of_them.answer
        self.assertEqual((answer.first, answer.count), (0, answer.organism_count))
        for column in (all_of_them.genes, all_of_them.forces, all_of_them.targets):
            self.assertEqual(column.shape[1], answer.count)
        for i in range(answer.count):
            one = self.client.call(get_organism=c.GetOrganism(world=world, island=island, organism=i)).organism
            self.assertEqual(one.generation, answer.generation)
            self.assertEqual(list(all_of_them.genes[:, i]), list(one.genes))
            parents = list(all_of_them.parents[:, i]) if answer.parents else []
            self.assertEqual(list(dict.fromkeys(parents)), list(one.parents))
            self.assertEqual(all_of_them.choices[i], one.choice)
            self.assertEqual(list(all_of_them.forces[:, i]), [one.force_x, one.force_y])
            self.assertEqual(list(all_of_them.targets[:, i]),
                             [numpy.float32(one.target_x_px), numpy.float32(one.target_y_px)])
            self.assertEqual(one.choice == w.CHOICE_UNSPECIFIED, not one.alive)
            if one.choice == w.CHOICE_WANDER:
                self.assertEqual((one.target_x_px, one.target_y_px), (one.x_px, one.y_px))
            elif one.choice != w.CHOICE_UNSPECIFIED:  # the target is within its range of perception
                seen = one.genes[4 if one.choice == w.CHOICE_SEEK else 5]
                self.assertLessEqual(math.hypot(one.target_x_px - one.x_px, one.target_y_px - one.y_px), seen + 0.01)
        return all_of_them

    def test_a_population_is_its_organisms(self):
        world = self.new_world(generation_s=6, island_count=2, poison_count=200)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        at_first = self.compare_with_organisms(world, 1)
        self.assertEqual((at_first.answer.generation, at_first.answer.generation_tick, at_first.answer.parents),
                         (1, 0, b""))
        self.client.run_to(300, world)
        later = self.compare_with_organisms(world, 1)
        self.assertEqual((later.genes == at_first.genes).all(), True)
        self.assertEqual(list(later.founders), list(range(50, 100)))
        self.assertEqual(set(later.choices), {w.CHOICE_UNSPECIFIED, w.CHOICE_WANDER, w.CHOICE_SEEK, w.CHOICE_FLEE},
                         "some have died, and the living do everything that there is")
        self.client.run_to(360, world)
        over = self.population(world, 1)  # organisms of a finished generation do nothing
        self.assertEqual(set(over.choices), {w.CHOICE_UNSPECIFIED})
        self.assertFalse(over.forces.any() or over.targets.any())
        self.client.run_to(361, world)
        bred = self.compare_with_organisms(world, 1)
        self.assertEqual((bred.answer.generation, bred.answer.generation_tick, bred.parents.shape), (2, 1, (2, 50)))
        self.assertLess(bred.parents.max(), 50)
        self.assertEqual(list(bred.founders), list(50 + bred.parents[0]))
        for island, first, field, allowed in ((2, 0, "island", "0 to 1"), (0, 50, "first_organism", "0 to 49")):
            status = self.client.call(NOT_FOUND, get_population=c.GetPopulation(
                world=world, island=island, first_organism=first)).status
            self.assertEqual([(v.field, v.allowed) for v in status.violations], [("get_population." + field, allowed)])

    def test_a_large_population_comes_in_parts(self):
        rows = self.client.welcome.limits.population_rows_max
        world = self.new_world(population_size=2 * rows + 7, fitness="gene_sum")
        parts, first = [], 0
        while not parts or first < parts[-1].answer.organism_count:
            parts.append(self.population(world, first=first))
            self.assertEqual(parts[-1].answer.first, first)
            first += parts[-1].answer.count
        self.assertEqual([part.answer.count for part in parts], [rows, rows, 7])
        genes = numpy.concatenate([part.genes for part in parts], axis=1)
        for i in (0, rows - 1, rows, 2 * rows + 6):
            one = self.client.call(get_organism=c.GetOrganism(world=world, organism=i)).organism
            self.assertEqual(list(genes[:, i]), list(one.genes))
        middle = self.population(world, first=rows - 3)
        self.assertTrue((middle.genes == genes[:, rows - 3:2 * rows - 3]).all())

    def test_motion_is_that_of_the_organisms(self):
        world = self.new_world(respawn=False)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        motion = lambda: self.client.call(get_motion=c.GetMotion(world=world)).motion
        at_rest = motion()
        self.assertEqual((at_rest.tick, at_rest.body_count, at_rest.kinetic_energy, at_rest.fastest_px_s),
                         (0, 50, 0, 0))
        self.client.run_to(200, world)
        answer = motion()
        alive = [o for o in (self.client.call(get_organism=c.GetOrganism(world=world, organism=i)).organism
                             for i in range(50)) if o.alive]
        speed = lambda o: math.hypot(o.velocity_x_px_s, o.velocity_y_px_s)
        self.assertEqual((answer.tick, answer.body_count), (200, len(alive)))
        self.assertAlmostEqual(answer.tick_s, 1 / 60)
        self.assertAlmostEqual(answer.kinetic_energy, sum(o.mass_kg * speed(o) ** 2 / 2 for o in alive), delta=0.1)
        self.assertAlmostEqual(answer.momentum_x, sum(o.mass_kg * o.velocity_x_px_s for o in alive), delta=0.01)
        self.assertAlmostEqual(answer.momentum_y, sum(o.mass_kg * o.velocity_y_px_s for o in alive), delta=0.01)
        self.assertAlmostEqual(answer.fastest_px_s, max(map(speed, alive)), places=3)
        self.assertAlmostEqual(answer.fastest_step_share, max(speed(o) / 60 / o.radius_px for o in alive), places=3)
        depths = [max(0, a.radius_px + b.radius_px - math.hypot(a.x_px - b.x_px, a.y_px - b.y_px))
                  for a, b in itertools.combinations(alive, 2)]
        self.assertAlmostEqual(answer.deepest_overlap_px, max(depths), places=3)
        self.assertGreaterEqual(answer.cell_px, 2 * max(o.radius_px for o in alive))
        self.client.call(NOT_FOUND, get_motion=c.GetMotion(world=world, island=1))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
