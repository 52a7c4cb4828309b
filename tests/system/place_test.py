"""Food, poison and organisms that are placed in a running world and removed from it, from evoctl to the run file. EVOD
and EVOCTL name the programs, MESSAGES the folder of the message classes."""
import json
import pathlib
import sys
import unittest

import access_test as access
import waiting
from access_test import EVOD, c, plain

INVALID, PRECONDITION, ABORTED = 3, 9, 10
GENES = [100, 100, 100, 100, 100, 100]


def evod(*words, status=0):
    done = waiting.run([EVOD, *words], capture_output=True, text=True)
    assert done.returncode == status, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


def food(x_px, y_px):
    return c.PlacedItem(kind=c.ITEM_KIND_FOOD, x_px=x_px, y_px=y_px)


class Placing(access.Access):
    def begin(self):
        server = self.serve("--speed", "max", "--seed", "7")
        client = self.come(server)
        client.run_to(50, "default")
        return server, client

    def test_a_killed_server_keeps_placed_items(self):
        server, client = self.begin()
        before = client.world("default").state_hash
        placed = client.call(place=c.Place(world="default", items=[food(30, 40), food(50, 40)])).placed
        self.assertEqual(len(placed.food), 2)
        client.call(remove=c.Remove(world="default", generation=placed.generation, food=placed.food[:1], organisms=[0]))
        here = client.world("default")
        self.assertEqual(here.tick, 50)
        self.assertNotEqual(here.state_hash, before)
        server.process.kill()
        waiting.ended(server.process)

        server = self.serve("--speed", "max", "--threads", "3")
        client = self.come(server)
        self.assertEqual(client.world("default").state_hash, here.state_hash)
        client.call(fork_world=c.ForkWorld(world="default", name="now"))
        client.call(fork_world=c.ForkWorld(world="default", name="before", at_generation=1))
        self.assertEqual(client.world("now").state_hash, here.state_hash)
        later = client.run_to(200, "default").state_hash
        self.assertEqual(client.run_to(200, "now").state_hash, later)
        self.assertNotEqual(client.run_to(200, "before").state_hash, later)
        replay = client.call(open_replay=c.OpenReplay(world="default", at=c.RunMoment(tick=200))).world
        self.assertEqual(plain.until(lambda: client.world(replay.name).tick == 200 and client.world(replay.name),
                                     "the replay").state_hash, later)
        client.call(PRECONDITION, place=c.Place(world=replay.name, items=[food(30, 40)]))
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        for world in ("default", "now", "before"):
            evod("verify", f"{self.folder}/{world}.evod")
        events = evod("export", f"{self.folder}/default.evod", "--what", "events", "--format", "jsonl")
        kinds = [json.loads(line)["kind"] for line in events.splitlines()]
        self.assertIn("place", kinds)
        self.assertIn("remove", kinds)

    def test_wrong_fields_are_named_and_nothing_is_placed(self):
        _, client = self.begin()
        before = client.world("default").state_hash
        refused = client.call(INVALID, place=c.Place(world="default", items=[food(30, 40), food(-3, 1e9)], organisms=[
            c.PlacedOrganism(x_px=100, y_px=100, genes=[1e6] * 6)])).status
        fields = [violation.field for violation in refused.violations]
        self.assertEqual(fields[:2], ["place.items[1].x_px", "place.items[1].y_px"])
        self.assertIn("place.organisms[0].body_size", fields)
        refused = client.call(ABORTED, remove=c.Remove(world="default", generation=9, organisms=[0])).status
        self.assertEqual(refused.reason, c.REASON_GENERATION_CHANGED)
        self.assertEqual(client.world("default").state_hash, before)

    def test_clients_are_informed(self):
        _, client = self.begin()
        client.call(subscribe_events=c.SubscribeEvents(world="default"))
        client.call(place=c.Place(world="default", items=[food(30, 40)]))
        placed = client.next_event("placed").placed
        self.assertEqual((placed.by.kind, len(placed.food)), (access.w.ACTOR_KIND_CLIENT, 1))
        client.call(remove=c.Remove(world="default", food=placed.food))
        self.assertEqual(list(client.next_event("removed").removed.food), list(placed.food))

    def test_evoctl_places_and_removes(self):
        server, client = self.begin()
        text = self.evoctl("place", "food", "30,40", "50.5,40", server=server)
        self.assertRegex(text, r"^placed food \d+, \d+ on island 0, generation 1, from tick 50\n$")
        number = text.split()[2].rstrip(",")
        self.assertEqual(self.evoctl("remove", "food", number, server=server),
                         f"removed food {number} on island 0, generation 1, from tick 50\n")
        self.assertIn("food[0]: got " + number, self.evoctl("remove", "food", number, server=server, status=2))
        self.assertIn("X,Y", self.evoctl("place", "food", "30", server=server, status=2))
        self.assertIn("--from FILE or --copy ID", self.evoctl("place", "organism", "30,40", server=server, status=2))
        self.assertIn(": this is a folder, not a population file",
                      self.evoctl("place", "organism", "30,40", "--from", self.folder, server=server, status=2))
        self.assertIn("items[0].x_px: got -1, allowed 4 to ",
                      self.evoctl("place", "food", "--", "-1,40", server=server, status=2))
        client.call(remove=c.Remove(world="default", organisms=[0]))
        self.assertIn("removed, lived", self.evoctl("organism", "0", server=server))
        population = pathlib.Path(self.folder) / "best.csv"
        self.evoctl("export", "--what", "population", "--output", str(population), server=server)
        for source in (["--copy", "3"], ["--from", str(population)]):
            done = next(done for done in (self.try_evoctl("place", "organism", f"{x},{y}", *source, server=server)
                                          for x in range(30, 500, 60) for y in (60, 200, 350)) if done.returncode == 0)
            self.assertRegex(done.stdout, r"^placed organism 5[01] on island 0")
        self.assertIn("placed after tick 50", self.evoctl("organism", "50", server=server))

    def try_evoctl(self, *words, server):
        return waiting.run([access.EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, *words],
                           capture_output=True, text=True)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=1)
