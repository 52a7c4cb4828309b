"""Bounds of a data folder: evod prune, --keep-runs, --disk-max and their metrics. EVOD and EVOCTL name the programs,
MESSAGES the folder of the message classes."""
import pathlib
import re
import unittest
import urllib.request

import past_test as past
import waiting
from past_test import EVOD, c, plain, w


class DiskSpace(past.Case):
    def evod(self, *words):
        done = waiting.run([EVOD, *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def serve(self, *options):
        server = self.server("--data", self.folder, "--seed", "1", *options)
        return server, self.client(server)

    def ended(self, world):
        return sorted(path.name for path in pathlib.Path(self.folder).glob(f"{world}.*.evod"))

    def reset(self, client, count):
        for _ in range(count):
            client.call(reset_world=c.ResetWorld(world="default"))

    def test_prune_deletes_old_runs_beside_a_server(self):
        _, client = self.serve()
        client.call(create_world=c.CreateWorld(name="w", seed=3, parameters=plain.assignments(**past.CREATE)))
        self.reset(client, 3)
        client.call(delete_world=c.DeleteWorld(world="w"))
        plain.until(lambda: len(self.ended("default")) == 3 and len(self.ended("w")) == 1, "ended runs")
        prune = ("prune", "--data", self.folder, "--keep-runs", "1")
        said = self.evod(*prune, "--dry-run")
        self.assertRegex(said, r"(\S+/default\.\w+\.evod: \d+ bytes\n){2}would delete 2 runs, \d+ bytes\n$")
        self.assertEqual(len(self.ended("default")), 3)
        self.assertEqual(self.evod(*prune), said.replace("would delete", "deleted"))
        self.assertEqual((len(self.ended("default")), len(self.ended("w"))), (1, 1))
        self.assertEqual(self.evod(*prune), "deleted 0 runs, 0 bytes\n")
        client.run_to(100, "default")

    def test_a_server_keeps_the_newest_runs(self):
        server, client = self.serve("--keep-runs", "2")
        self.reset(client, 4)
        plain.until(lambda: len(self.ended("default")) == 2, "two ended runs")
        self.reset(client, 1)
        self.assertRegex(server.output(), r"--keep-runs 2: deleted \S+/default\.\w+\.evod")
        server.end()
        newest = self.ended("default")
        self.assertEqual(len(newest), 2)
        server, client = self.serve("--keep-runs", "0")
        self.assertEqual(self.ended("default"), [])
        self.assertIn("--keep-runs 0: deleted 2 runs", server.output())
        client.run_to(100, "default")

    def test_above_disk_max_worlds_wait(self):
        server, client = self.serve("--disk-max", str(1 << 30), "--http-port", "0")
        self.reset(client, 1)
        port = int(re.search(r"http://127\.0\.0\.1:(\d+)/metrics", server.output())[1])

        def metric(name):
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics") as page:
                return float(re.search(rf"^{re.escape(name)} (\S+)", page.read().decode(), re.M)[1])

        self.assertEqual(metric("evod_disk_bytes_max"), 1 << 30)
        self.assertGreater(metric('evod_world_bytes{world="default"}'), 4096)
        filler = pathlib.Path(self.folder, f"default.{1:032x}.evod")  # an ended run

        def fill():
            with filler.open("wb") as file:
                file.truncate(1 << 30)  # takes no space

        fill()
        client.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(max=True)))
        client.call(run=c.Run(world="default"))
        plain.until(lambda: "contains more than --disk-max allows, 1073741824 bytes: delete old runs with evod prune"
                    in server.output(), "the quota")
        self.assertGreater(metric("evod_disk_bytes"), 1 << 30)
        plain.until(lambda: metric('evod_storage_state{state="failing"}') == 1, "the state in the metrics")
        refused = client.call(c.CODE_UNAVAILABLE, set_parameters=plain.set_parameters("default", food_health=7.0))
        self.assertIn("--disk-max", refused.status.message)
        self.assertNotIn(self.folder, refused.status.message)
        self.evod("prune", "--data", self.folder, "--keep-runs", "0")
        plain.until(lambda: "run files can be written again" in server.output(), "room")
        tick = client.world("default").tick
        client.wait_world(lambda world: world.tick > tick, "default")
        fill()
        plain.until(lambda: server.output().count("--disk-max allows") == 2, "the quota again")
        server.end()  # writes what waits

    def test_runs_of_another_model_version_are_read_only(self):
        server, client = self.serve()
        self.reset(client, 1)
        server.end()
        stored = pathlib.Path(__file__).parents[1] / "unit" / "run_file" / "format_5.evod"  # model version 3
        pathlib.Path(self.folder, "old.evod").write_bytes(stored.read_bytes())
        said = self.evod("data", "--data", self.folder)
        self.assertRegex(said, r"(?m)^default\.evod +\d+ +\d+ +\S+ +continues$")
        self.assertRegex(said, r"(?m)^default\.\w+\.evod +\d+ +\d+ +\S+ +ended$")
        self.assertRegex(said, r"(?m)^old\.evod +3 +\d+ +0\.2\.0 +read only$")
        server, client = self.serve()
        worlds = client.call(list_worlds=c.ListWorlds()).worlds
        self.assertEqual([world.name for world in worlds.damaged], ["old"])
        self.assertIn("it can read the file (`evod export`)", worlds.damaged[0].reason)
        pathlib.Path(self.folder, "bad.evod").write_text("text" * 10)
        done = waiting.run([EVOD, "data", "--data", self.folder], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"(?m)^bad\.evod .* unreadable$")
        self.assertIn("bad.evod is damaged or is not a run file", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[past.sys.argv[0], *past.sys.argv[4:]])
