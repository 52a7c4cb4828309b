"""Food, poison and organisms that are placed in a running world and removed from it, from evoctl to the run file. EVOD
and EVOCTL name the programs, MESSAGES the folder of the message classes."""
import pathlib
import sys
import unittest

import access_test as access
import waiting
from access_test import c


def food(x_px, y_px):
    return c.PlacedItem(kind=c.ITEM_KIND_FOOD, x_px=x_px, y_px=y_px)


class Placing(access.Access):
    def begin(self):
        server = self.serve("--speed", "max", "--seed", "7")
        client = self.come(server)
        client.run_to(50, "default")
        return server, client

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
