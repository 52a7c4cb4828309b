"""World names reused quickly: created, forked, reset and deleted without waiting for answers, by two clients, with
kills in between. EVOD names the program, MESSAGES the folder of the message classes.

ROUNDS   of the random sequences; SEED draws them.
"""
import contextlib
import os
import random
import sqlite3
import sys
import unittest

import past_test as past
import waiting
from past_test import EVOD, c, plain

ROUNDS, SEED = int(os.environ.get("ROUNDS", "6")), int(os.environ.get("SEED", "1"))
OK, NOT_FOUND, EXISTS = 0, 5, 6


class Gathering:
    """Records what is sent."""

    bytes = b""

    def sendall(self, more):
        self.bytes += more


class Names(past.Case):
    def serve(self):
        # A running world is within a generation, so a fork begins with a checkpoint that is compressed first.
        return self.server("--data", f"{self.folder}/runs", "--speed", "max", "--start")

    def at_once(self, client, *requests):
        """Sends all requests at once, so that the server applies the last before the first is on the disk. Returns
        their statuses."""
        together, client.socket = client.socket, Gathering()
        asked = [client.ask(**request) for request in requests]
        gathered, client.socket = client.socket, together
        client.socket.sendall(gathered.bytes)
        return [client.response(number).status.code for number in asked]

    def verify_all(self):
        for name in sorted(os.listdir(f"{self.folder}/runs")):
            self.assertFalse(name.endswith("-next"), name)
            if name.endswith(".evod"):
                done = waiting.run([EVOD, "verify", f"{self.folder}/runs/{name}"], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_fork_can_be_reset_before_it_is_written(self):
        server = self.serve()
        client = self.client(server)
        for i in range(20):
            codes = self.at_once(client, {"fork_world": c.ForkWorld(world="default", name=f"w{i}")},
                                 {"reset_world": c.ResetWorld(world=f"w{i}")})
            self.assertEqual(codes, [OK, OK])
            client.call(pause=c.Pause(world=f"w{i}"))
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        self.verify_all()

    def test_a_name_can_be_reused_immediately(self):
        server = self.serve()
        client = self.client(server)
        for _ in range(20):
            codes = self.at_once(client, {"fork_world": c.ForkWorld(world="default", name="w")},
                                 {"delete_world": c.DeleteWorld(world="w")}, {"create_world": c.CreateWorld(name="w")},
                                 {"reset_world": c.ResetWorld(world="w")}, {"reset_world": c.ResetWorld(world="w")},
                                 {"delete_world": c.DeleteWorld(world="w")})
            self.assertEqual(codes, [OK] * 6)
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        self.verify_all()

    def test_random_sequences_survive_kills(self):
        chance = random.Random(SEED)
        server = self.serve()
        for turn in range(ROUNDS):
            clients = [self.client(server), self.client(server)]
            asked = []
            for _ in range(chance.randrange(2, 24)):
                client, name = chance.choice(clients), chance.choice("abc")
                request = chance.choice([
                    {"create_world": c.CreateWorld(name=name, parameters=plain.assignments(population_size=5))},
                    {"fork_world": c.ForkWorld(world="default", name=name)},
                    {"reset_world": c.ResetWorld(world=name)},
                    {"delete_world": c.DeleteWorld(world=name)},
                    {"run_until_tick": c.RunUntilTick(world=name, tick=chance.randrange(1, 50))}])
                asked.append((client, client.ask(**request), request))
            if turn % 3 == 2:
                for client, number, _ in asked[:chance.randrange(len(asked))]:
                    client.response(number)
                server.kill()
                server = self.serve()
                continue
            for client, number, request in asked:
                status = client.response(number).status
                self.assertIn(status.code, (OK, NOT_FOUND, EXISTS), f"seed {SEED}, round {turn}: {request}: {status}")
            clients[0].call(pause=c.Pause(world="default"))
            clients[0].call(resume=c.Resume(world="default"))
            for client in clients:
                client.socket.close()
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        self.verify_all()


class Signals(past.Case):
    def test_goodbye_precedes_the_end_and_is_cut_by_a_signal(self):
        server = self.server("--data", f"{self.folder}/runs")
        client = self.client(server)
        client.ask(create_world=c.CreateWorld(name="large", parameters=plain.assignments(
            population_size=3_000_000, island_width_px=100_000.0, island_height_px=100_000.0)))
        client.ask(list_worlds=c.ListWorlds())
        client.call(get_metrics=c.GetMetrics())  # so that the server has read the requests
        server.process.terminate()
        client.next_event("server_going_away")
        self.assertNotIn(1, client.responses)  # the world is still being created
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), -15)
        self.assertIn("SIGTERM again: ending at once", server.output())
        server = self.server("--data", f"{self.folder}/runs")
        self.client(server).call(list_worlds=c.ListWorlds())

    def test_sighup_does_not_end_the_server(self):
        server = self.server("--keep-nothing")
        client = self.client(server)
        server.process.send_signal(1)
        plain.until(lambda: "SIGHUP" in server.output(), "a line in the log")
        client.call(list_worlds=c.ListWorlds())
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)

    def test_unwritten_data_shows_in_the_exit_status(self):
        server = self.server("--data", f"{self.folder}/runs", "--speed", "max")
        client = self.client(server)
        client.call(create_world=c.CreateWorld(name="other"))
        os.rename(f"{self.folder}/runs/default.evod", f"{self.folder}/moved")
        client.run_to(100, "other")
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 4)
        # The other world's file is complete: one failing file does not block others.
        with contextlib.closing(sqlite3.connect(f"{self.folder}/runs/other.evod")) as run:
            self.assertEqual(run.execute("SELECT count(*) FROM end_mark").fetchall(), [(1,)])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
