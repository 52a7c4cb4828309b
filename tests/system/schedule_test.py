"""Parameters that change by generation, from the file to the run file. EVOD and EVOCTL name the programs, MESSAGES the
folder of the message classes."""
import json
import pathlib
import re
import sys
import unittest

import access_test as access
import waiting
from access_test import EVOD, c, plain

SCHEDULED = {"population_size": {"1": 12, "4": 20}, "generation_s": 0.5, "mutation_chance": {"1": 0.5, "3": 0.05},
             "food_health": {"2": 60, "5": 5}, "seed": 3}
INVALID, PRECONDITION = 3, 9


def evod(*words, status=0):
    done = waiting.run([EVOD, *words], capture_output=True, text=True)
    assert done.returncode == status, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout if status == 0 else done.stderr


def state_of(text):
    return re.search(r"state ([0-9a-f]{32})", text)[1]


class Schedules(access.Access):
    def setUp(self):
        super().setUp()
        self.file = self.write("annealed.json", SCHEDULED)

    def write(self, name, experiment):
        path = pathlib.Path(self.folder) / name
        path.write_text(json.dumps(experiment))
        return str(path)

    def ended(self, client, world, generations):
        return plain.until(lambda: (lambda w: w.generation == generations and w.state == plain.w.RUN_STATE_WAITING
                                    and w)(
            client.world(world)), f"{generations} generations")

    def parameters(self, client, world):
        return client.call(get_parameters=c.GetParameters(world=world)).parameters

    def test_evod_run_equals_a_server_killed_in_between(self):
        alone = state_of(evod("run", self.file, "--generations", "7"))
        self.assertNotEqual(alone, state_of(evod("run", self.file, "--generations", "7", "--set",
                                                 "mutation_chance=0.5")))
        self.assertEqual(alone, state_of(evod("run", self.file, "--generations", "7", "--threads", "3")))
        server = self.serve("--experiment", self.file, "--speed", "max")
        client = self.come(server)
        world = client.world().name
        self.assertEqual([(x.generation, x.name) for x in self.parameters(client, world).schedule],
                         [(2, "food_health"), (3, "mutation_chance"), (4, "population_size"), (5, "food_health")])
        client.call(subscribe_events=c.SubscribeEvents(world=world))
        client.call(run=c.Run(world=world, generations=3))
        changed = client.next_event("parameters_changed").parameters_changed
        self.assertEqual((changed.by.kind, [x.name for x in changed.changed], changed.revision),
                         (access.w.ACTOR_KIND_SCHEDULE, ["food_health"], 2))
        self.ended(client, world, 3)
        server.process.kill()
        waiting.ended(server.process)

        server = self.serve("--experiment", self.file, "--speed", "max")
        client = self.come(server)
        self.assertEqual([(x.generation, x.name) for x in self.parameters(client, world).schedule],
                         [(4, "population_size"), (5, "food_health")])
        self.assertIn("food_health=60  # 5 from generation 5\n", self.evoctl("get", "food_health", server=server))
        client.call(run=c.Run(world=world, generations=4))
        self.assertEqual(self.ended(client, world, 7).state_hash, alone)
        self.assertEqual(len(self.parameters(client, world).schedule), 0)
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        run_file = f"{self.folder}/{world}.evod"
        evod("verify", run_file)
        bundle = f"{self.folder}/bundle"
        evod("export", run_file, "--bundle", bundle)
        self.assertEqual(alone, state_of(evod("run", f"{bundle}/experiment.json", "--generations", "7")))

        other = self.write("annealed.json", {**SCHEDULED, "food_health": {"2": 60, "5": 6}})
        refused = waiting.run([EVOD, "--port", "0", "--data", self.folder, "--experiment", other], capture_output=True,
                              text=True)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("other schedule of parameters", refused.stdout + refused.stderr)

    def test_evoctl_create_set_overrides_the_schedule(self):
        server = self.serve("--speed", "max")
        self.evoctl("create", "first", "--experiment", self.file, server=server)
        self.evoctl("create", "second", "--experiment", self.file, "--set", "food_health=9", server=server)
        client = self.come(server)
        for world in ("first", "second"):
            client.call(set_speed=c.SetSpeed(world=world, speed=plain.w.Speed(max=True)))
            client.call(run=c.Run(world=world, generations=6))
        alone = evod("run", self.file, "--generations", "6")
        self.assertEqual(self.ended(client, "first", 6).state_hash, state_of(alone))
        alone = evod("run", self.file, "--generations", "6", "--set", "food_health=9")
        self.assertEqual(self.ended(client, "second", 6).state_hash, state_of(alone))

    def test_a_change_that_no_longer_fits_is_dropped(self):
        server = self.serve("--speed", "max")
        client = self.come(server)
        real = lambda name, value, generation: plain.w.ScheduledValue(name=name, generation=generation,
                                                                      value=plain.w.ParameterValue(real=value))
        create = c.CreateWorld(name="w", seed=1, parameters=plain.assignments(generation_s=0.1), schedule=[
            real("impulse_min", 200, 3), real("mutation_chance", 0.5, 3), real("mutation_chance", 0.1, 4)])
        client.call(create_world=create)
        client.call(set_parameters=c.SetParameters(world="w", parameters=plain.assignments(impulse_max=150.0)))
        client.call(subscribe_events=c.SubscribeEvents(world="w"))
        client.call(set_speed=c.SetSpeed(world="w", speed=plain.w.Speed(max=True)))
        client.call(run=c.Run(world="w", generations=4))
        dropped = client.next_event("change_dropped").change_dropped
        self.assertEqual((dropped.by.kind, sorted(dropped.name)),
                         (access.w.ACTOR_KIND_SCHEDULE, ["impulse_min", "mutation_chance"]))
        self.assertEqual([x.field for x in dropped.violations], ["impulse_max"])
        self.ended(client, "w", 4)
        values = {x.name: x.value.real for x in self.parameters(client, "w").parameters}
        self.assertEqual((values["impulse_min"], values["mutation_chance"]), (20, 0.1))

        # A reset restarts the schedule.
        client.call(reset_world=c.ResetWorld(world="w"))
        self.assertEqual(len(self.parameters(client, "w").schedule), 3)
        values = {x.name: x.value.real for x in self.parameters(client, "w").parameters}
        self.assertEqual(values["mutation_chance"], 0.15)

    def test_invalid_files_name_generation_and_line(self):
        wrong = pathlib.Path(self.folder) / "wrong.json"
        wrong.write_text('{\n"impulse_max": {\n  "7": 90},\n"impulse_min": 95\n}')
        self.assertIn("impulse_max at generation 7 (line 3): got 90, allowed at least impulse_min (95)",
                      evod("check", str(wrong), status=1))
        self.assertIn('"mutation_chance": {"1": 0.5, "3": 0.05}', evod("check", self.file))
        refused = evod("run", self.file, "--set", "impulse_min=95", "--set", "impulse_max=90", status=2)
        self.assertIn("impulse_max", refused)
        steep = self.write("steep.json", {"impulse_min": {"3": 200}})
        self.assertIn("impulse_max at generation 3: got 150", evod("run", steep, "--set", "impulse_max=150", status=2))


class Planned(access.Access):
    """Changes that take effect at a given generation or tick."""

    def plan(self, client, code=0, **at):
        return client.call(code, set_parameters=c.SetParameters(
            world="default", parameters=plain.assignments(mutation_chance=0.5), **at))

    def planned(self, client):
        return [x.id for x in client.call(get_parameters=c.GetParameters(world="default")).parameters.planned]

    def value(self, client, name):
        parameters = client.call(get_parameters=c.GetParameters(world="default")).parameters.parameters
        return next(x.value.real for x in parameters if x.name == name)

    def test_acknowledged_changes_survive_a_kill(self):
        server = self.serve("--seed", "3", "--speed", "max")
        client = self.come(server)
        self.assertIn("planned_changes", client.welcome.features)
        client.call(subscribe_events=c.SubscribeEvents(world="default"))
        answer = self.plan(client, at_tick=100)
        self.assertEqual((answer.planned_change.id, answer.planned_change.tick, answer.applied_tick), (1, 100, 0))
        self.assertEqual(client.next_event("change_planned").change_planned.change, answer.planned_change)
        twice = c.Request(client_key="again", request_id=1, set_parameters=c.SetParameters(
            world="default", parameters=plain.assignments(food_health=9.0), at_tick=200))
        for _ in range(2):
            sent = client.response(client.ask(client_key="again", request_id=1, set_parameters=twice.set_parameters))
            self.assertEqual(sent.planned_change.id, 2, sent)
        self.plan(client, at_generation=5)
        self.assertEqual(self.planned(client), [1, 2, 3])
        client.run_to(150)
        changed = client.next_event("parameters_changed")
        self.assertEqual((changed.tick, changed.parameters_changed.planned_change), (100, 1))
        self.assertEqual(self.planned(client), [2, 3])
        cancelled = client.call(cancel_change=c.CancelChange(world="default", id=3)).planned_change
        self.assertEqual(cancelled.generation, 5)
        self.assertEqual(client.next_event("change_cancelled").change_cancelled.change.id, 3)
        server.process.kill()
        waiting.ended(server.process)

        server = self.serve("--speed", "max")
        client = self.come(server)
        self.assertEqual(self.planned(client), [2])
        sent = client.response(client.ask(client_key="again", request_id=1, set_parameters=twice.set_parameters))
        self.assertEqual(sent.planned_change.id, 2, "answered as before, and not planned twice")
        self.assertEqual(self.planned(client), [2])
        client.call(fork_world=c.ForkWorld(world="default", name="fork"))
        self.assertEqual(len(client.call(get_parameters=c.GetParameters(world="fork")).parameters.planned), 0)
        client.run_to(201, "default")
        self.assertEqual((self.value(client, "food_health"), self.value(client, "mutation_chance")), (9, 0.5))
        client.call(delete_world=c.DeleteWorld(world="fork"))
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        evod("verify", f"{self.folder}/default.evod")

    def test_wrong_ticks_and_ids_are_named(self):
        client = self.come(self.serve("--seed", "3"))
        for at, field, allowed in (({"at_tick": 0}, "at_tick", "at least 1"),
                                   ({"at_generation": 1}, "at_generation", "at least 2"),
                                   ({"at_generation": 0}, "at_generation", "at least 2"),
                                   ({"at_generation": 2, "at_tick": 9}, "at_tick", "absent if at_generation is set")):
            status = self.plan(client, INVALID, **at).status
            self.assertEqual([(x.field, x.allowed) for x in status.violations], [("set_parameters." + field, allowed)])
        status = client.call(5, cancel_change=c.CancelChange(world="default", id=4)).status
        self.assertEqual(status.violations[0].field, "cancel_change.id")
        self.assertEqual(self.plan(client, at_tick=7, dry_run=True).planned_change.id, 0)
        self.assertEqual(self.planned(client), [])
        for _ in range(client.welcome.limits.planned_changes_max):
            self.plan(client, at_tick=7)
        self.plan(client, 8, at_tick=7)

    def test_evoctl_plans_lists_and_cancels(self):
        server = self.serve("--seed", "3")
        self.assertEqual(self.evoctl("changes", server=server), "nothing is planned\n")
        self.assertRegex(self.evoctl("set", "--at-generation", "30", "mutation_chance=0.01", server=server),
                         r"^planned: change 1, from generation 30: mutation_chance=0.01, by evoctl .*\n$")
        self.evoctl("set", "--at-tick", "9", "food_health=3", "food_count=1", server=server)
        reported = self.evoctl("changes", server=server)
        self.assertRegex(reported, r"^change 1, from .*\nchange 2, after tick 9: food_health=3 food_count=1, by .*\n$")
        self.assertIn("cancelled: change 1,", self.evoctl("cancel", "1", server=server))
        self.assertIn("no planned change has that id", self.evoctl("cancel", "1", server=server, status=1))
        self.assertIn("at least 2", self.evoctl("set", "--at-generation", "1", "food_health=3", server=server,
                                                status=2))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=1)
