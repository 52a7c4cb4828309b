"""A run file that cannot be restored stops its own world. EVOD and EVOCTL name the programs, MESSAGES the folder of the
message classes."""
import contextlib
import pathlib
import sqlite3
import subprocess
import unittest
import urllib.request

import past_test as past
import waiting
from past_test import EVOD, EVOCTL, c, plain, w

FAILED_PRECONDITION, ALREADY_EXISTS = 9, 6
SAID = "a.evod is damaged: the population of generation 3 on island 0 is missing or was changed; "


class DamagedWorld(past.Case):
    def serve(self, *options):
        server = self.server("--data", self.folder, *options)
        return server, self.client(server)

    def recorded(self, *names):
        """Stores a run for each name, and damages the first."""
        server, client = self.serve("--seed", "1")
        for name in names:
            if name != "default":
                client.call(create_world=c.CreateWorld(name=name, seed=3, parameters=plain.assignments(**past.CREATE)))
                client.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
                client.run_to(300, name)
        if "default" not in names:
            client.call(delete_world=c.DeleteWorld(world="default"))
        server.end()
        self.path = pathlib.Path(self.folder, f"{names[0]}.evod")
        with contextlib.closing(sqlite3.connect(self.path, isolation_level=None)) as run:
            run.execute("UPDATE population SET chromosomes = zeroblob(288) WHERE generation = 3")
        self.bytes = self.path.read_bytes()

    def evoctl(self, server, *words, status=0):
        done = waiting.run([EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, *words],
                           capture_output=True, text=True)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def damaged(self, client):
        return {world.name: world for world in client.call(list_worlds=c.ListWorlds()).worlds.damaged}

    def assert_refused(self, client, **request):
        status = client.call(FAILED_PRECONDITION, **request).status
        self.assertEqual(status.reason, c.REASON_WORLD_DAMAGED, request)
        self.assertIn(SAID, status.message)

    def test_other_worlds_run_and_its_name_stays_taken(self):
        self.recorded("a", "b", "default")
        server, client = self.serve("--start")
        plain.until(lambda: client.world("default").tick > 0, "--start")
        client.run_to(400, "b")
        damaged = self.damaged(client)
        self.assertEqual(list(damaged), ["a"])
        self.assertIn(SAID, damaged["a"].reason)
        self.assertEqual(len(damaged["a"].run_id), 32)
        for request in ({"get_statistics": c.GetStatistics(world="a")}, {"run": c.Run(world="a")},
                        {"reset_world": c.ResetWorld(world="a")}, {"open_replay": c.OpenReplay(world="a")},
                        {"fork_world": c.ForkWorld(world="a", name="f")}, {"get_breeding": c.GetBreeding(world="a")},
                        {"subscribe_snapshots": c.SubscribeSnapshots(world="a", rate_hz=10)}):
            self.assert_refused(client, **request)
        for request in ({"create_world": c.CreateWorld(name="a")}, {"fork_world": c.ForkWorld(world="b", name="a")}):
            self.assertEqual(client.call(ALREADY_EXISTS, **request).status.reason, c.REASON_WORLD_EXISTS)
        self.assertIn("a does not run: ", self.evoctl(server, "status"))
        self.assertRegex(self.evoctl(server, "status"), r"\na +damaged ")
        self.assertIn(SAID, self.evoctl(server, "--world", "a", "status", status=1))
        server.end()
        self.assertEqual(self.path.read_bytes(), self.bytes)
        experiment = pathlib.Path(self.folder, "a.json")
        experiment.write_text("{}")
        server, client = self.serve("--experiment", str(experiment))
        self.assertIn('--experiment, --seed and --population have no effect: world "a" exists and is damaged',
                      server.output())
        self.assertEqual(list(self.damaged(client)), ["a"])
        server.end()
        self.assertEqual(self.path.read_bytes(), self.bytes)

    def test_what_can_be_read_is_exported_and_it_can_be_deleted(self):
        self.recorded("a", "b")
        server, client = self.serve()
        table = self.evoctl(server, "--world", "a", "export", "--what", "generations")
        self.assertEqual(table.count("\n"), 1 + 2 * 2, "two generations on two islands have ended")
        self.assertIn("a.evod is damaged", self.evoctl(server, "--world", "a", "export", "--what", "organisms",
                                                       status=1))
        self.assertEqual(self.evoctl(server, "delete", "a"), "deleted a\n")
        self.assertFalse(self.path.exists())
        self.assertEqual(pathlib.Path(self.folder, "a.damaged-1.evod").read_bytes(), self.bytes)
        self.assertEqual(self.damaged(client), {})
        client.call(create_world=c.CreateWorld(name="a"))
        server.end()
        server, client = self.serve()
        self.assertEqual((self.damaged(client), client.world("a").tick, client.world("b").tick), ({}, 0, 300))

    def test_a_server_starts_with_only_a_damaged_world(self):
        self.recorded("a")
        server, client = self.serve("--start", "--http-port", "0")
        self.assertIn('--speed and --start have no effect: world "a" is damaged', server.output())
        self.assert_refused(client, get_statistics=c.GetStatistics())
        self.assertEqual(client.call(list_worlds=c.ListWorlds()).worlds.worlds[:], [])
        http = plain.re.search(r"health at (http://\S+)/metrics", server.output())[1]
        with urllib.request.urlopen(f"{http}/healthz") as health:
            self.assertEqual((health.status, health.read().decode()), (200, "ok\ndamaged world: a\n"))
        with urllib.request.urlopen(f"{http}/metrics") as metrics:
            self.assertIn("\nevod_worlds_damaged 1\n", metrics.read().decode())
        client.call(delete_world=c.DeleteWorld(world="a"))
        self.assertTrue(pathlib.Path(self.folder, "a.damaged-1.evod").exists())
        server.end()
        _, client = self.serve()
        self.assertEqual([world.name for world in client.call(list_worlds=c.ListWorlds()).worlds.worlds], ["default"])

    def test_verify_gives_the_reason_and_the_path(self):
        self.recorded("a")
        _, client = self.serve()
        reason = self.damaged(client)["a"].reason
        done = waiting.run([EVOD, "verify", str(self.path)], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (1, "", f"evod: {self.folder}/{reason}\n"))

    def test_damage_while_it_runs_stops_only_this_world(self):
        server, client = self.serve("--seed", "1", "--http-port", "0")
        for name in ("a", "b"):
            client.call(create_world=c.CreateWorld(name=name, seed=3, parameters=plain.assignments(**past.CREATE)))
            client.run_to(300, name)
        evoctl = [EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, "--world", "a"]
        waits = [subprocess.Popen([*evoctl, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                 for words in (("run", "--wait"), ("watch",))]
        for process in waits:
            self.addCleanup(process.stderr.close)
            self.addCleanup(process.wait)
            self.addCleanup(process.kill)
        listens, views = self.client(server), self.client(server)
        listens.call(subscribe_events=c.SubscribeEvents())
        views.call(subscribe_snapshots=c.SubscribeSnapshots(world="a", rate_hz=10))
        plain.until(lambda: client.world("a").tick > 400, "a runs")
        path = pathlib.Path(self.folder, "a.evod")
        for file in (path, pathlib.Path(f"{path}-wal"), pathlib.Path(f"{path}-shm")):
            with open(file, "r+b") as damaged:
                damaged.write(b"x" * file.stat().st_size)
        for process in waits:
            _, said = waiting.communicate(process)
            self.assertRegex(said, r"(?s)does not run: .*a\.evod is damaged.*; deleting the world moves the file away")
            self.assertEqual(process.returncode, 1)
        for session in listens, views:
            event = session.next_event("world_damaged")
            self.assertEqual(event.world, "a")
            self.assertIn("a.evod is damaged", event.world_damaged.reason)
        status = client.call(FAILED_PRECONDITION, run=c.Run(world="a")).status
        self.assertEqual(status.reason, c.REASON_WORLD_DAMAGED)
        damaged = self.damaged(client)
        self.assertEqual(list(damaged), ["a"])
        self.assertEqual(status.message, "the world does not run: " + damaged["a"].reason)
        client.run_to(600, "b")
        server.end()
        server, client = self.serve()
        self.assertEqual((list(self.damaged(client)), client.world("b").tick), (["a"], 600))


if __name__ == "__main__":
    unittest.main(argv=[past.sys.argv[0], *past.sys.argv[4:]])
