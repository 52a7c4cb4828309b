"""Lost connections and killed servers: commands are applied once, and subscriptions resume."""
import contextlib
import sqlite3
import tempfile
import unittest

import evod
from evod.v1 import commands_pb2 as c
from support import Relay, Server


class Reconnect(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.data = folder.name
        self.server = None
        self.serve()

    def serve(self):
        self.server = Server("--data", self.data, "--seed", "5", "--speed", "max")

    def tearDown(self):
        if self.server.process.poll() is None:
            self.server.kill()

    def restart(self, relay):
        self.server.kill()
        self.serve()
        relay.port = self.server.port

    def connect(self, relay, **options):
        lab = evod.connect(relay.address, timeout_s=600, **options)
        self.addCleanup(lab.close)
        self.addCleanup(relay.close)
        return lab

    def applied_ids(self, lab):
        """The request ids of the lab's commands in the journal; none is there twice."""
        with contextlib.closing(sqlite3.connect(f"file:{self.data}/default.evod?mode=ro", uri=True)) as run:
            rows = run.execute("SELECT request_id FROM journal WHERE client_key = ?", [lab.client_key]).fetchall()
        self.assertEqual(len(rows), len(set(rows)))
        return [row[0] for row in rows]

    def test_a_command_with_a_lost_answer_is_applied_once(self):
        relay = Relay(self.server.port)
        lab = self.connect(relay)
        world = lab.world()
        lab.registry()
        lost = []

        def lose_one(to_server, data):
            if to_server or lost:
                return False
            lost.append(data)
            return True

        relay.at = lose_one
        parameters = world.set(mutation_chance=0.5)
        self.assertEqual(len(lost), 1)
        self.assertEqual(relay.connection_count, 2)
        self.assertEqual(parameters.revision, world.get_parameters().revision)
        self.assertEqual(len(self.applied_ids(lab)), 1)

    def test_a_kill_during_a_retry_applies_a_command_once(self):
        relay = Relay(self.server.port)
        lab = self.connect(relay)
        world = lab.world()
        lab.registry()
        lab.request(run=c.Run())  # as World.run() does, without subscribing to events
        deaths = []

        def kill(to_server, data):
            """Kills the server before the answer arrives, and again before the answer to the retry arrives."""
            if to_server or len(deaths) >= 4:
                return False
            deaths.append(data)
            # The first data of a new session is its Welcome, which arrives; the data after it does not.
            if len(deaths) % 2 == 0:
                return False
            self.restart(relay)
            return True

        relay.at = kill
        parameters = world.set(mutation_chance=0.5)
        self.assertEqual(len(deaths), 4)
        self.assertEqual(parameters.mutation_chance, 0.5)
        self.assertEqual(len(self.applied_ids(lab)), 2)  # run, set_parameters

    def test_each_generation_is_returned_once_across_a_kill(self):
        relay = Relay(self.server.port)
        world = self.connect(relay).world()
        numbers = []
        for g in world.run(generations=40):
            numbers.append(g.number)
            if g.number in (5, 12):
                self.restart(relay)
            if g.number == 20:
                relay.cut()
        self.assertEqual(numbers, list(range(1, 41)))

    def test_snapshots_and_events_resume_after_a_kill(self):
        relay = Relay(self.server.port)
        world = self.connect(relay).world()
        events = world.events()
        snapshots = world.snapshots(rate_hz=100)
        world.run()
        first = next(snapshots)
        self.restart(relay)
        for snapshot in snapshots:
            if snapshot.generation > first.generation + 2:
                break
        self.assertEqual(snapshot.run_id, first.run_id)
        for event in events:
            if event.HasField("events_dropped"):
                break
        self.assertEqual(event.events_dropped.dropped_count, 0)
        for event in events:
            if event.HasField("generation_finished"):
                break

    def test_a_server_that_stays_away_is_reported(self):
        relay = Relay(self.server.port)
        lab = evod.connect(relay.address)
        self.addCleanup(lab.close)
        lab._link._inner.timeout_s = 0.5
        relay.close()
        with self.assertRaisesRegex(evod.NoConnection, "no server at 127.0.0.1"):
            lab.worlds()

    def test_a_call_succeeds_after_one_that_failed(self):
        relay = Relay(self.server.port)
        lab = self.connect(relay)
        lab._link._inner.timeout_s = 0.2
        relay.port = 1  # no server
        relay.cut()
        with self.assertRaisesRegex(evod.NoConnection, "closed the connection"):  # clears the frames of the traceback
            lab.worlds()
        relay.port = self.server.port
        lab._link._inner.timeout_s = 600
        self.assertEqual([info.name for info in lab.worlds()], ["default"])

    def test_without_reconnect_a_loss_is_reported_at_once(self):
        relay = Relay(self.server.port)
        lab = self.connect(relay, reconnect=False)
        relay.cut()
        with self.assertRaisesRegex(evod.NoConnection, "closed the connection"):
            lab.worlds()


if __name__ == "__main__":
    unittest.main()
