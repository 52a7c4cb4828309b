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
