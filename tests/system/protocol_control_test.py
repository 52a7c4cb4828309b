"""Commands of the protocol: worlds, run control, parameters, repeated requests, events.

Arguments as in plain_client.py.
"""
import itertools
import math
import sys
import time
import unittest

import waiting
from plain_client import (
    ABORTED, EXISTS, INVALID, NOT_FOUND, OK, PRECONDITION, as_dict, assignments, Client,
    set_parameters, WithServer, c, session_pb2, w,
)


class Commands(WithServer):
    def test_worlds_are_created_and_deleted_or_refused(self):
        world = self.client.call(create_world=c.CreateWorld(
            name="a_World-1", seed=5, parameters=assignments(population_size=7))).world
        self.assertEqual((world.name, world.seed, world.tick, world.generation, world.state),
                         ("a_World-1", 5, 0, 1, w.RUN_STATE_WAITING))
        self.assertRegex(world.run_id, r"^[0-9a-f]{32}$")
        self.assertRegex(world.state_hash, r"^[0-9a-f]{32}$")
        self.client.call(EXISTS, create_world=c.CreateWorld(name="a_World-1"))
        for name in ("", "a b", "ä", "a/b", "x" * 65, "a\n"):
            status = self.client.call(INVALID, create_world=c.CreateWorld(name=name)).status
            self.assertEqual([v.field for v in status.violations], ["create_world.name"])
        status = self.client.call(INVALID, create_world=c.CreateWorld(
            name="", parameters=assignments(mutation_chance=2.0, food_count=-0.5))).status
        self.assertEqual({v.field for v in status.violations},
                         {"create_world.name", "create_world.mutation_chance", "create_world.food_count"})
        status = self.client.call(INVALID, delete_world=c.DeleteWorld()).status
        self.assertEqual([v.field for v in status.violations], ["delete_world.world"])
        answer = self.client.call(delete_world=c.DeleteWorld(world="a_World-1"))
        self.assertIsNone(answer.WhichOneof("answer"))
        self.client.call(NOT_FOUND, delete_world=c.DeleteWorld(world="a_World-1"))

    def test_run_pause_resume_step(self):
        world = self.new_world(generation_s=0.5)  # 30 ticks
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(PRECONDITION, resume=c.Resume(world=world))
        answer = self.client.call(run=c.Run(world=world, generations=2))
        self.assertEqual((answer.applied_tick, answer.world.state), (0, w.RUN_STATE_RUNNING))
        self.assertEqual(answer.world.run_until_generation, 3)
        ended = self.client.wait_world(lambda x: x.state == w.RUN_STATE_WAITING, world)
        self.assertEqual((ended.tick, ended.generation, ended.HasField("run_until_generation")), (60, 2, False))
        self.assertAlmostEqual(ended.simulated_s, 1, places=9)

        self.client.call(run=c.Run(world=world))
        self.client.wait_world(lambda x: x.tick > 100, world)
        paused = self.client.call(pause=c.Pause(world=world)).world
        self.assertEqual(paused.state, w.RUN_STATE_PAUSED)
        self.assertEqual(self.client.world(world).state_hash, paused.state_hash)
        stepped = self.client.run_to(paused.tick + 7, world)
        self.assertEqual(stepped.tick, paused.tick + 7)
        again = self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=3)).world  # reached long ago
        self.assertEqual((again.state, again.tick), (w.RUN_STATE_PAUSED, stepped.tick))
        self.assertEqual(self.client.call(resume=c.Resume(world=world)).world.state, w.RUN_STATE_RUNNING)
        self.client.wait_world(lambda x: x.tick > stepped.tick, world)

        status = self.client.call(INVALID, run=c.Run(world=world, generations=0)).status
        self.assertEqual([v.field for v in status.violations], ["run.generations"])

    def test_a_run_may_last_the_maximum_of_generations(self):
        world = self.new_world()
        for generations in (1 << 40, (1 << 64) - 1):
            answer = self.client.call(run=c.Run(world=world, generations=generations)).world
            self.assertEqual(answer.state, w.RUN_STATE_RUNNING)
            self.assertGreater(answer.run_until_generation, 1)
        answer = self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=(1 << 64) - 1)).world
        self.assertEqual(answer.run_until_tick, (1 << 64) - 1)

    def test_speed(self):
        world = self.new_world()
        for factor in (0.001, 1.5, 10000.0):
            answer = self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=factor)))
            self.assertEqual(answer.world.speed.real_time_factor, factor)
        self.assertTrue(self.client.call(
            set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True))).world.speed.max)
        for factor in (0.0, -1.0, 0.0009, 10001.0, math.nan, math.inf, -math.inf):
            status = self.client.call(
                INVALID, set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=factor))).status
            self.assertEqual([(v.field, v.allowed) for v in status.violations],
                             [("set_speed.speed.real_time_factor", "0.001 to 10000")])
        self.client.call(INVALID, set_speed=c.SetSpeed(world=world))
        self.client.call(INVALID, set_speed=c.SetSpeed(world=world, speed=w.Speed()))
        self.client.call(INVALID, set_speed=c.SetSpeed(world=world, speed=w.Speed(max=False)))
        self.assertTrue(self.client.world(world).speed.max)

    def test_viewers_and_speed_change_nothing(self):
        parameters = {"generation_s": 2}
        watched, alone = self.new_world(seed=9, **parameters), self.new_world(seed=9, **parameters)
        viewer = self.enterContext(Client(self.server))
        viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=watched, rate_hz=120))
        viewer.call(subscribe_events=c.SubscribeEvents())
        self.client.call(set_speed=c.SetSpeed(world=watched, speed=w.Speed(real_time_factor=20)))
        self.client.call(set_speed=c.SetSpeed(world=alone, speed=w.Speed(max=True)))
        for world in (watched, alone):
            self.client.run_to(77, world)
            self.client.call(set_parameters=set_parameters(world, food_health=60.0, mutation_chance=0.5))
            self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=400))
        hashes = {self.client.wait_world(lambda x: x.tick == 400, world).state_hash for world in (watched, alone)}
        self.assertEqual(len(hashes), 1)


class Control(WithServer):
    """Several controllers of one world: none blocks the others, and all see the same order of events."""
    OF_SERVER = w.ACTOR_KIND_SERVER

    def setUp(self):
        super().setUp()
        self.other = self.enterContext(Client(self.server))
        self.other.call(subscribe_events=c.SubscribeEvents())
        self.name = self.new_world()
        self.client.call(set_speed=c.SetSpeed(world=self.name, speed=w.Speed(real_time_factor=50)))
        self.client.call(run=c.Run(world=self.name))

    def borrow(self):
        """Steps the running world by half a second. Returns its tick."""
        tick = self.client.world(self.name).tick + 1500
        lent = self.client.call(run_until_tick=c.RunUntilTick(world=self.name, tick=tick))
        self.assertTrue(lent.world.leased)
        return max(tick, lent.applied_tick)  # it may have been there before the command arrived

    def wait_standing(self, tick):
        def stands(world):
            self.assertLessEqual(world.tick, tick, "the lease has ended and the world went on")
            return world.tick == tick and world.state == w.RUN_STATE_PAUSED
        return self.client.wait_world(stands, self.name)

    def while_lent(self, attempt):
        """The result of attempt(), which must finish within a lease."""
        return waiting.quicker_than(self.client.welcome.limits.lease_s, attempt)

    def next_control(self, kind, condition=lambda world: True):
        event = self.other.next_event("run_control_changed",
                                      lambda e: e.run_control_changed.by.kind == kind and e.world == self.name and
                                      condition(e.run_control_changed.world))
        return event.run_control_changed.world

    def renew(self, expected=OK, client=None):
        return (client or self.client).call(expected, renew_lease=c.RenewLease(world=self.name))

    def test_a_lease_expires_and_the_world_continues(self):
        def stand(_):
            tick = self.borrow()
            self.assertTrue(self.wait_standing(tick).leased)
            return tick
        tick = self.while_lent(stand)
        gone_on = self.next_control(self.OF_SERVER)
        self.assertEqual((gone_on.leased, gone_on.state), (False, w.RUN_STATE_RUNNING))
        self.client.wait_world(lambda x: x.tick > tick, self.name)
        self.assertIn("lease", self.renew(PRECONDITION).status.message)

    def test_a_lease_lasts_as_long_as_it_is_renewed(self):
        lease_s = self.client.welcome.limits.lease_s

        def go_on(lap):
            tick, end = self.borrow(), time.monotonic() + 1.5 * lease_s
            while time.monotonic() < end:
                self.renew()
                lap()
                time.sleep(lease_s / 20)
            self.assertEqual(self.wait_standing(tick).tick, tick)
        self.while_lent(go_on)

    def test_a_lease_ends_with_its_client(self):
        with Client(self.server) as brief:
            tick = brief.call(run_until_tick=c.RunUntilTick(world=self.name, tick=0)).applied_tick
        self.next_control(self.OF_SERVER)
        self.client.wait_world(lambda x: x.tick > tick, self.name)

    def test_all_see_one_order_of_two_controllers(self):
        rounds, clients = 200, [self.client, self.other]
        listeners = [self.enterContext(Client(self.server)) for _ in range(2)]
        for listener in listeners:
            listener.call(subscribe_events=c.SubscribeEvents(world=self.name))
        first = self.client.world(self.name).parameter_revision
        asked = [[(client, client.ask(set_parameters=set_parameters(self.name, food_health=float(1 + 2 * i + j))))
                  for j, client in enumerate(clients)] for i in range(rounds // 20)]
        answers = [client.response(request) for pairs in asked for client, request in pairs]
        for i in range(rounds // 20, rounds):
            asked = [(client, client.ask(set_parameters=set_parameters(self.name, food_health=1 + i / 8 + j / 16)))
                     for j, client in enumerate(clients)]
            answers += [client.response(request) for client, request in asked]
        by_revision = {answer.parameters.revision: answer for answer in answers}
        self.assertEqual(sorted(by_revision), list(range(first + 1, first + 1 + 2 * rounds)))
        seen = [[listener.next_event("parameters_changed") for _ in range(2 * rounds)] for listener in listeners]
        self.assertEqual(seen[0], seen[1])
        addresses = {f"127.0.0.1:{client.socket.getsockname()[1]}" for client in clients}
        self.assertEqual({event.parameters_changed.by.address for event in seen[0]}, addresses)
        for event, revision in zip(seen[0], sorted(by_revision)):
            changed, answer = event.parameters_changed, by_revision[revision]
            self.assertEqual((changed.revision, event.tick), (revision, answer.applied_tick))
            self.assertEqual(changed.changed[0].value, as_dict(answer.parameters)["food_health"].value)
        self.assertEqual([e.tick for e in seen[0]], sorted(e.tick for e in seen[0]))


class Parameters(WithServer):
    def setUp(self):
        super().setUp()
        self.registry = self.client.call(describe=c.Describe()).description.parameters
        self.world = self.new_world()

    def get(self):
        return self.client.call(get_parameters=c.GetParameters(world=self.world)).parameters

    def refused(self, **values):
        """The field paths of a refusal; asserts that nothing has changed."""
        before = self.get()
        status = self.client.call(INVALID, set_parameters=set_parameters(self.world, **values)).status
        self.assertEqual(self.get(), before)
        for v in status.violations:
            self.assertTrue(v.field and v.allowed and v.got, v)
        return {v.field for v in status.violations}

    def test_a_new_world_has_the_defaults_of_the_registry(self):
        parameters = self.get()
        self.assertEqual([p.name for p in parameters.parameters], [p.name for p in self.registry])
        for p, description in zip(parameters.parameters, self.registry):
            self.assertEqual(p.value, description.default_value, p.name)
            self.assertFalse(p.HasField("pending"), p.name)

    def test_all_or_nothing_and_every_fault_is_named(self):
        self.assertEqual(
            self.refused(food_health=30.0, mutation_chance=1.5, selection="best", mutate_chance=0.1, tick_s=math.nan),
            {"set_parameters." + n for n in ("mutation_chance", "selection", "mutate_chance", "tick_s")})

    def test_current_and_pending_values_are_shown(self):
        answer = self.client.call(set_parameters=set_parameters(
            self.world, food_health=31.0, population_size=60, island_count=2, steering_lookahead_s=1))
        self.assertEqual(answer.applied_tick, 0)
        now = as_dict(answer.parameters)
        self.assertEqual(len(now), len(self.registry))
        self.assertEqual((now["food_health"].value.real, now["food_health"].HasField("pending")), (31, False))
        self.assertEqual(now["steering_lookahead_s"].value.real, 1)  # a whole number is accepted for a real
        self.assertEqual((now["population_size"].value.count, now["population_size"].pending.count), (50, 60))
        self.assertEqual((now["island_count"].value.count, now["island_count"].pending.count), (1, 2))
        self.assertEqual(answer.parameters, self.get())
        self.assertEqual(self.client.call(reset_world=c.ResetWorld(world=self.world)).world.island_count, 2)
        after = as_dict(self.get())
        self.assertEqual((after["population_size"].value.count, after["population_size"].HasField("pending")),
                         (60, False))

    def test_compare_and_set(self):
        revision = self.get().revision
        answer = self.client.call(set_parameters=set_parameters(self.world, expected_revision=revision,
                                                                food_health=1.0))
        self.assertGreater(answer.parameters.revision, revision)
        status = self.client.call(ABORTED, set_parameters=set_parameters(
            self.world, expected_revision=revision, food_health=2.0)).status
        self.assertEqual([(v.field, v.allowed, v.got) for v in status.violations],
                         [("set_parameters.expected_revision", str(answer.parameters.revision), str(revision))])
        self.client.call(ABORTED, set_parameters=set_parameters(self.world, expected_revision=0, food_health=2.0))
        self.assertEqual(as_dict(self.get())["food_health"].value.real, 1)


class Resending(WithServer):
    def again(self, client, request):
        client.send(session_pb2.ClientMessage(request=request))
        return client.response(request.request_id)

    def test_the_first_answer_is_repeated_on_any_session(self):
        request = c.Request(request_id=1, client_key="retry-create", create_world=c.CreateWorld(name="once"))
        first = self.again(self.client, request)
        self.assertEqual(first.status.code, OK)
        self.assertEqual(self.again(self.client, request), first)
        with Client(self.server) as other:
            other.call(run_until_tick=c.RunUntilTick(world="once", tick=3))
            self.assertEqual(self.again(other, request), first)
        self.client.call(delete_world=c.DeleteWorld(world="once"))
        self.assertEqual(self.again(self.client, request), first)
        self.client.call(NOT_FOUND, get_parameters=c.GetParameters(world="once"))

    def test_a_reconnecting_client_gets_its_answer(self):
        request = c.Request(request_id=1, client_key="retry-gone", create_world=c.CreateWorld(name="gone"))
        with Client(self.server) as hasty:
            hasty.send(session_pb2.ClientMessage(request=request))
        self.assertEqual(self.again(self.client, request).status.code, OK)
        self.client.call(delete_world=c.DeleteWorld(world="gone"))


class Events(WithServer):
    def setUp(self):
        super().setUp()
        self.watcher = self.enterContext(Client(self.server))

    def subscribe(self, world=None):
        return self.watcher.call(subscribe_events=c.SubscribeEvents(world=world)).subscription.subscription_id

    def test_subscribers_get_commands_with_their_actor(self):
        self.subscribe()
        world = self.new_world(seed=3)
        event = self.watcher.next_event("world_created")
        self.assertEqual((event.world, event.world_created.world.seed), (world, 3))
        by = event.world_created.by
        self.assertEqual((by.kind, by.user, by.client), (w.ACTOR_KIND_CLIENT, "", "plain"))
        self.assertRegex(by.address, r"^127\.0\.0\.1:\d+$")
        self.client.call(set_parameters=set_parameters(world, food_health=5.0, population_size=9))
        changed = self.watcher.next_event("parameters_changed").parameters_changed
        self.assertEqual([(p.name, p.HasField("pending")) for p in changed.changed],
                         [("food_health", False), ("population_size", True)])
        self.assertEqual(changed.revision, self.client.world(world).parameter_revision)
        for request in ({"run": c.Run(world=world)}, {"pause": c.Pause(world=world)}, {"resume": c.Resume(world=world)},
                        {"set_speed": c.SetSpeed(world=world, speed=w.Speed(max=True))}):
            answer = self.client.call(**request)
            event = self.watcher.next_event("run_control_changed")
            self.assertEqual(event.run_control_changed.world, answer.world)
            self.assertEqual((event.tick, event.run_id), (answer.applied_tick, answer.world.run_id))
        reset = self.client.call(reset_world=c.ResetWorld(world=world)).world
        self.assertEqual(self.watcher.next_event("world_reset").world_reset.world.run_id, reset.run_id)
        self.client.call(set_parameters=set_parameters(world, dry_run=True, food_health=6.0))  # causes no event
        self.client.call(create_world=c.CreateWorld(name="brief"))
        self.client.call(delete_world=c.DeleteWorld(world="brief"))
        following = [self.watcher.next_event(kind) for kind in ("world_created", "world_deleted")]
        self.assertEqual({e.world for e in following}, {"brief"})

    def test_generations_migrations_and_the_end_of_a_run(self):
        world = self.new_world(fitness="gene_sum", island_count=3, migration="ring", migration_epoch=2, migrant_count=2,
                               generation_limit=5)
        self.subscribe(world)
        self.client.call(run=c.Run(world=world))
        kinds = []
        while "run_terminated" not in kinds:
            self.watcher.step()
            while self.watcher.events:
                event = self.watcher.events.pop(0)
                kinds.append(event.WhichOneof("kind"))
                if kinds[-1] == "generation_finished":
                    statistics = event.generation_finished.statistics
                    self.assertEqual([s.island for s in statistics], [0, 1, 2])
                    self.assertEqual(len(statistics[0].genes), 6)
                if kinds[-1] == "migration":
                    self.assertEqual([(e.from_island, e.to_island, e.migrant_count) for e in event.migration.edges],
                                     [(2, 0, 2), (0, 1, 2), (1, 2, 2)])
        self.assertEqual(kinds.count("generation_finished"), 5)
        self.assertEqual(kinds.count("migration"), 2)
        self.assertEqual(event.run_terminated.outcome, w.OUTCOME_GENERATION_LIMIT)
        history = self.client.call(get_history=c.GetHistory(world=world)).history
        self.assertEqual([(s.generation, s.island) for s in history.generations],
                         list(itertools.product(range(1, 6), range(3))))

    def test_an_extinction_causes_an_event(self):
        world = self.new_world(food_count=0, poison_count=0, generation_s=600)
        self.subscribe(world)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world, generations=1))
        extinction = self.watcher.next_event("extinction")
        self.assertEqual((extinction.extinction.island, extinction.extinction.generation), (0, 1))
        finished = self.watcher.next_event("generation_finished").generation_finished.statistics[0]
        self.assertEqual((finished.alive_count, finished.starved_count), (0, 50))

    def test_the_answer_comes_before_its_event(self):
        self.subscribe()
        request_id = self.watcher.ask(pause=c.Pause())
        self.watcher.response(request_id)
        self.assertEqual(self.watcher.events, [])
        self.watcher.next_event("run_control_changed")

    def test_no_more_events_after_unsubscribing(self):
        subscription = self.subscribe()
        self.watcher.call(unsubscribe=c.Unsubscribe(subscription_id=subscription))
        status = self.watcher.call(NOT_FOUND, unsubscribe=c.Unsubscribe(subscription_id=subscription)).status
        self.assertEqual([v.field for v in status.violations], ["unsubscribe.subscription_id"])
        self.client.call(pause=c.Pause())
        self.watcher.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.watcher.events, [])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
