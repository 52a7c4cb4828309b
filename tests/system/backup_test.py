"""Copies of a data folder that a server is using. EVOD and EVOCTL name the programs, MESSAGES the folder of the message
classes."""
import contextlib
import os
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import unittest

import past_test as past
import waiting
from past_test import EVOD, c, plain, w


def hashes(path):
    """The stored state hashes of a run, by tick."""
    with contextlib.closing(sqlite3.connect(path)) as run:
        return {tick: halves for tick, *halves in run.execute("SELECT tick, low, high FROM state_hash")}


class Backup(past.Case):
    def setUp(self):
        super().setUp()
        self.data, self.copy = f"{self.folder}/data", f"{self.folder}/copies/first"

    def run_world(self, client, name):
        """A world at full speed."""
        client.call(create_world=c.CreateWorld(name=name, seed=3, parameters=plain.assignments(**past.CREATE)))
        client.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
        client.call(run=c.Run(world=name))
        plain.until(lambda: len(hashes(f"{self.data}/{name}.evod")) > 5, "hashes on the disk")

    def evod(self, *words, status=0):
        done = waiting.run([EVOD, *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def backup(self, folder=None, status=0):
        return self.evod("backup", folder or self.copy, "--data", self.data, status=status)

    def test_a_copy_of_a_running_world_continues(self):
        self.evod("token", "add", "anna", "--role", "admin", "--data", self.data)
        server = self.server("--data", self.data)
        client = self.client(server)
        self.run_world(client, "w")
        self.assertRegex(self.backup(), r"first: 2 worlds, 0 ended runs and the tokens, \d+ bytes\n$")
        self.assertEqual(os.stat(f"{self.copy}/tokens").st_mode & 0o777, 0o600)
        self.assertIn("anna", self.evod("token", "list", "--data", self.copy))
        self.assertEqual(os.listdir(f"{self.folder}/copies"), ["first"])
        copied = max(hashes(f"{self.copy}/w.evod"))
        self.assertGreaterEqual(copied, 300)

        other = self.server("--data", self.copy)
        restored = self.client(other)
        tick = restored.world("w").tick
        self.assertGreaterEqual(tick, copied)
        restored.call(run=c.Run(world="w"))
        restored.wait_world(lambda world: world.tick > tick + 600, "w")
        client.wait_world(lambda world: world.tick > tick + 600, "w")
        other.end()
        server.end()
        first, second = hashes(f"{self.data}/w.evod"), hashes(f"{self.copy}/w.evod")
        common = sorted(set(first) & set(second))
        self.assertGreater(common[-1], copied)
        for tick in common:
            self.assertEqual(first[tick], second[tick], tick)
        self.assertIn("everything agrees", self.evod("verify", f"{self.copy}/w.evod"))

    def test_resets_meanwhile_lose_no_world(self):
        server = self.server("--data", self.data)
        client = self.client(server)
        self.run_world(client, "w")
        for number in range(40):
            with subprocess.Popen([EVOD, "backup", f"{self.copy}{number}", "--data", self.data],
                                  stdout=subprocess.DEVNULL) as copying:
                for _ in range(10):
                    client.call(reset_world=c.ResetWorld(world="w"))
                self.assertEqual(waiting.ended(copying), 0)
            for ended in pathlib.Path(self.data).glob("w.*.evod*"):
                ended.unlink()  # or each copy would take longer than the one before
            self.assertLessEqual({"default.evod", "w.evod"}, set(os.listdir(f"{self.copy}{number}")), number)
        restored = self.server("--data", f"{self.copy}{number}")
        worlds = self.client(restored).call(list_worlds=c.ListWorlds()).worlds
        self.assertEqual([world.name for world in worlds.worlds], ["default", "w"])
        self.assertEqual(len(worlds.damaged), 0)
        restored.end()

    def test_a_killed_backup_harms_nothing(self):
        server = self.server("--data", self.data)
        client = self.client(server)
        self.run_world(client, "w")
        for delay_s in (0.0, 0.01, 0.02, 0.04, 0.08):
            copying = subprocess.Popen([EVOD, "backup", self.copy, "--data", self.data], stdout=subprocess.DEVNULL)
            with contextlib.suppress(subprocess.TimeoutExpired):
                copying.wait(delay_s)
            copying.kill()
            waiting.ended(copying)
            tick = client.world("w").tick
            client.wait_world(lambda world, tick=tick: world.tick > tick, "w")
            shutil.rmtree(self.copy, ignore_errors=True)
        self.assertIn("2 worlds", self.backup())
        server.end()
        self.assertIn("everything agrees", self.evod("verify", f"{self.copy}/w.evod"))
        self.assertIn("everything agrees", self.evod("verify", f"{self.data}/w.evod"))

    def test_a_run_that_a_killed_server_left_is_copied(self):
        server = self.server("--data", self.data)
        client = self.client(server)
        self.run_world(client, "w")
        server.process.send_signal(signal.SIGKILL)
        waiting.ended(server.process)
        files = [pathlib.Path(self.data, name) for name in ("w.evod", "w.evod-wal")]
        before = [file.read_bytes() for file in files]
        self.backup()
        self.assertEqual([file.read_bytes() for file in files], before)
        self.assertIn("everything agrees", self.evod("verify", f"{self.copy}/w.evod"))

    def test_a_damaged_file_does_not_stop_the_others(self):
        server = self.server("--data", self.data)
        client = self.client(server)
        self.run_world(client, "w")
        server.end()
        with contextlib.closing(sqlite3.connect(f"{self.data}/w.evod", isolation_level=None)) as run:
            run.execute("UPDATE population SET chromosomes = zeroblob(288) WHERE generation = 1")
        said = self.backup(status=1)
        self.assertRegex(said, r"not copied: \S+/data/w\.evod is damaged: the population of generation 1")
        self.assertIn("1 world, 0 ended runs", said)
        self.assertEqual([name for name in os.listdir(self.copy) if name.endswith(".evod")], ["default.evod"])
        pathlib.Path(self.data, "w.evod").write_bytes(b"x" * 5000)
        self.assertIn("not copied: ", self.backup(self.copy + "2", status=1))

    def test_a_folder_in_use_is_refused(self):
        self.server("--data", self.data).end()
        self.assertIn("is not an empty folder", self.backup(self.data, status=1))
        pathlib.Path(self.copy).mkdir(parents=True)
        self.assertIn("1 world", self.backup(self.copy + "/"))
        self.assertIn("is not an empty folder", self.backup(status=1))
        self.assertIn("No such file", self.evod("backup", self.copy + "3", "--data", self.folder + "/none", status=1))
        pathlib.Path(self.folder, "empty").mkdir()
        self.assertIn("contains no runs and no tokens",
                      self.evod("backup", self.copy + "3", "--data", self.folder + "/empty", status=1))
        self.assertIn("is not an empty folder", self.backup("", status=1))
        self.assertIn("is in the data folder", self.backup(self.data + "/copy", status=1))
        pathlib.Path(self.folder, "link").symlink_to(self.folder + "/empty")
        self.assertIn("is not an empty folder", self.backup(self.folder + "/link", status=1))
        self.assertEqual(sorted(os.listdir(self.folder + "/copies")), ["first"])

    def test_nothing_else_is_deleted(self):
        """A data folder may have the name that a copy once had while it was made, and a link may lead there."""
        self.server("--data", self.data).end()
        precious = pathlib.Path(self.folder, "first.partial")
        pathlib.Path(self.data).rename(precious)
        self.data = str(precious)
        before = set(os.listdir(precious))
        self.assertIn("1 world", self.backup(self.folder + "/first"))
        pathlib.Path(self.folder, "second.partial").symlink_to(precious)
        self.assertIn("1 world", self.backup(self.folder + "/second"))
        self.assertLessEqual(before, set(os.listdir(precious)))  # SQLite adds two files

    def test_strange_tokens_do_not_stop_the_runs(self):
        self.server("--data", self.data).end()
        os.mkfifo(self.data + "/tokens")
        said = self.backup(status=1)
        self.assertRegex(said, "not copied: .*tokens: it is not a regular file")
        self.assertIn("1 world", said)


if __name__ == "__main__":
    unittest.main(argv=[past.sys.argv[0], *past.sys.argv[4:]])
