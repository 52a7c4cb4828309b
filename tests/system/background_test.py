"""Exports and GetBreeding of several users: none of them can take all places or all the time. EVOD names the program,
MESSAGES the folder of the message classes."""
import sys
import unittest

import access_test as access
import export_test
from access_test import ADMIN, VIEWER
from past_test import c, plain

GENERATIONS = 400


class Background(access.Access, export_test.Runs):
    def setUp(self):
        super().setUp()
        self.token("admin", ADMIN)
        self.token("eve", VIEWER)
        self.token("ada", VIEWER)
        self.token("bob", VIEWER)
        # Almost every generation must be simulated again, which keeps a processor busy for seconds.
        self.running = self.serve("--require-token", "--speed", "max", "--keep-every", "1000000")
        admin = self.come(self.running, self.secrets["admin"])
        self.run_world(admin, GENERATIONS, population_size=100)

    def come_as(self, user):
        return self.come(self.running, self.secrets[user])

    def take_all(self, sessions=16):
        """One user asks for as many exports and GetBreeding as the user's sessions can, and reads no answer."""
        eves = [self.come_as("eve") for _ in range(sessions)]
        for eve in eves:
            eve.export = eve.ask(export_run=c.ExportRun(world="w", table=c.RUN_TABLE_ORGANISMS,
                                                        format=c.TEXT_FORMAT_JSON_LINES))
            eve.asked = [eve.ask(get_breeding=c.GetBreeding(world="w", generation=GENERATIONS - 1 - i))
                         for i in range(20)]
        return eves

    def is_served(self, ada):
        """Both need some generations only."""
        text, _ = self.table(ada, table=c.RUN_TABLE_POPULATION, generation=2)
        self.assertEqual(text.count("\n"), 1 + 2 * 100)
        bred = ada.call(get_breeding=c.GetBreeding(world="w", generation=1)).breeding
        self.assertEqual(bred.generation, 1)

    def test_places_are_free_when_the_sessions_have_ended(self):
        for eve in self.take_all():
            eve.socket.close()
        again = [self.come_as("eve") for _ in range(4)]
        export = c.ExportRun(world="w", table=c.RUN_TABLE_POPULATION, format=c.TEXT_FORMAT_CSV, generation=2)
        for eve in again:
            plain.until(lambda eve=eve: eve.response(eve.ask(export_run=export)).status.code == plain.OK, "a place")
            bred = eve.call(get_breeding=c.GetBreeding(world="w", generation=1)).breeding
            self.assertEqual(bred.generation, 1)

    def test_the_user_with_the_most_gives_a_place_to_another(self):
        export = c.ExportRun(world="w", table=c.RUN_TABLE_ORGANISMS, format=c.TEXT_FORMAT_JSON_LINES)
        full = []
        for user in 4 * ["eve"] + 4 * ["bob"]:
            full.append(self.come_as(user))
            full[-1].part = full[-1].call(export_run=export).export_part
            self.assertFalse(full[-1].part.last)
        self.is_served(self.come_as("ada"))
        refused = []
        for client in full:
            answer = client.response(client.ask(continue_export=c.ContinueExport(export_id=client.part.export_id)))
            if answer.status.code != plain.OK:
                self.assertEqual(answer.status.reason, c.REASON_EXPORTS_MAX)
                self.assertIn("another user needed a place", answer.status.message)
                refused.append(full.index(client))
        self.assertIn(refused, ([0], [4]), "the oldest of one of them")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
