"""Real servers whose disk is full for a while: a small tmpfs, and a file that takes what is left of it.

    EVOD=… MESSAGES=… full_disk_test.py     skipped with status 77 where nothing may be mounted
"""
import os
import pathlib
import select
import struct
import subprocess
import sys
import tempfile
import unittest

skipped = 77
if __name__ == "__main__" and "MOUNTS" not in os.environ:
    # Mounts of its own, which go with it; made by root, or by whoever may be root in a namespace.
    unshare = ["unshare", "--user", "--map-root-user", "--mount"]
    tried = subprocess.run([*unshare, "mount", "-t", "tmpfs", "-o", "size=1m", "none", "/mnt"], capture_output=True, text=True)
    if tried.returncode != 0:
        print("skipped: no tmpfs may be mounted here:", tried.stderr.strip())
        sys.exit(skipped)
    os.execvpe(unshare[0], [*unshare, sys.executable, __file__, *sys.argv[1:]], {**os.environ, "MOUNTS": "own"})

import recovery_test as recovery  # noqa: E402
from recovery_test import Server, c, journal, set_parameter, session_pb2, until, w  # noqa: E402
from evod.v1 import stream_pb2  # noqa: E402

UNAVAILABLE = 14


class Client(recovery.Client):
    def ask(self, request_id, **request):
        self.send(session_pb2.ClientMessage(request=c.Request(request_id=request_id, client_key=self.key, **request)))

    def answer(self):
        return next(m.response for m in iter(self.receive, None) if m.HasField("response"))

    def is_told_something(self):
        return bool(select.select([self.socket], [], [], 0)[0])

    def picture(self, condition):
        """The next picture of which that holds."""
        while True:
            _, _, channel, length = struct.unpack("<2sBBI", self.read(8))
            body = self.read(length)
            if channel == 2 and condition(picture := stream_pb2.SnapshotFrame.FromString(body)):
                return picture


class FullDisk(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.data, self.mounted, self.servers = folder.name, False, []

    def tearDown(self):
        for server in self.servers:
            if server.process.poll() is None:
                server.kill()
            server.log.close()
        if self.mounted:
            subprocess.run(["umount", "--lazy", self.data], check=True)

    def mount(self, megabytes):
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "none", self.data], check=True)
        self.mounted = True

    def serve(self, *options):
        self.servers.append(Server("--data", self.data, *options))
        return self.servers[-1]

    def client(self, server, key):
        client = Client(server, key)
        self.addCleanup(client.socket.close)
        return client

    def fill(self):
        """Takes every byte that is left."""
        with open(f"{self.data}/big", "wb", buffering=0) as big:
            for chunk in (bytes(1 << 20), bytes(1 << 12), b"x"):
                try:
                    while True:
                        big.write(chunk)
                except OSError as full:
                    self.assertEqual(full.errno, 28)

    def make_room(self):
        os.remove(f"{self.data}/big")

    def verify(self):
        done = subprocess.run([recovery.evod, "verify", f"{self.data}/default.evod"], capture_output=True, text=True,
                              timeout=600)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def fill_and_ask_for_what_cannot_be_written(self, server, control):
        """The world runs, and nobody was told so."""
        self.fill()
        asking = self.client(server, "waits")
        asking.ask(1, run=c.Run())
        until(lambda: "commands are refused until it can be written again" in server.output(), "trouble")
        self.assertIn("full", server.output())
        refused = control.call(10, **set_parameter("food_health", 5))
        self.assertEqual(refused.status.code, UNAVAILABLE)
        self.assertIn("nothing can be changed while it cannot be written down", refused.status.message)
        self.assertIn("full", refused.status.message)
        return asking

    def test_commands_are_refused_and_worlds_go_on_until_there_is_room_again(self):
        self.mount(8)
        server = self.serve("--seed", "3", "--speed", "1000")
        control, viewer = self.client(server, "control"), self.client(server, "viewer")
        viewer.call(1, subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
        self.assertEqual(control.call(1, **set_parameter("food_health", 30)).status.code, 0)
        asking = self.fill_and_ask_for_what_cannot_be_written(server, control)
        # What needs no disk goes on: the world, its pictures, questions, what leaves no trace.
        seen = viewer.picture(lambda picture: True).tick
        seen = viewer.picture(lambda picture: picture.tick > seen + 3000).tick
        self.assertGreaterEqual(control.world().tick, seen)
        self.assertEqual(control.call(11, set_parameters=c.SetParameters(dry_run=True)).status.code, 0)
        again = control.call(12, pause=c.Pause())
        self.assertEqual(again.status.code, UNAVAILABLE)
        self.assertFalse(asking.is_told_something())
        self.make_room()
        self.assertEqual(asking.answer().status.code, 0)
        until(lambda: "run files can be written again" in server.output(), "the end of the trouble")
        # What was refused left no trace, and may be asked for again.
        self.assertEqual(control.call(10, **set_parameter("food_health", 5)).status.code, 0)
        paused = control.call(12, pause=c.Pause())
        self.assertEqual(paused.status.code, 0)
        last = control.world()
        self.assertGreater(last.tick, seen)
        server.kill()
        self.assertEqual([(key, request) for _, _, key, request in journal(self.data) if key != ""][-4:],
                         [("control", 1), ("waits", 1), ("control", 10), ("control", 12)])
        self.verify()
        server = self.serve()
        control = self.client(server, "control")
        now = control.world()
        self.assertEqual((now.tick, now.state_hash), (last.tick, last.state_hash))
        self.assertEqual(control.call(12, pause=c.Pause()).applied_tick, paused.applied_tick)
        server.end()

    def test_killed_while_its_disk_is_full_it_goes_on_without_what_nobody_was_told_of(self):
        self.mount(8)
        server = self.serve("--seed", "3", "--speed", "1000")
        control = self.client(server, "control")
        answered = control.call(1, run_until_tick=c.RunUntilTick(tick=400))
        self.assertEqual(answered.status.code, 0)
        until(lambda: control.world().tick == 400, "tick 400")
        self.assertEqual(control.call(2, **set_parameter("food_health", 30)).status.code, 0)
        before = control.world()
        self.fill_and_ask_for_what_cannot_be_written(server, control)
        until(lambda: control.world().tick > 1000, "ticks that are not written down")
        server.kill()
        server = self.serve()  # the disk is still full
        control = self.client(server, "control")
        now = control.world()
        self.assertEqual((now.tick, now.state_hash, now.state), (before.tick, before.state_hash, before.state))
        asking = self.client(server, "waits")
        asking.ask(1, run=c.Run())
        until(lambda: "commands are refused until it can be written again" in server.output(), "trouble")
        self.make_room()
        self.assertEqual(asking.answer().status.code, 0)
        until(lambda: control.world().tick > 1000, "ticks")
        server.end()
        self.assertEqual([row[2:] for row in journal(self.data)][-3:], [("control", 1), ("control", 2), ("waits", 1)])
        self.verify()

    def test_worlds_wait_when_too_much_waits_for_the_disk(self):
        self.mount(400)
        crowd = pathlib.Path(self.data) / "default.json"
        # A generation is a tick, and weighs half a megabyte.
        crowd.write_text('{"population_size": 10000, "scale_with_population": true, "fitness": "gene_sum"}')
        server = self.serve("--seed", "3", "--speed", "max", "--experiment", str(crowd))
        control = self.client(server, "control")
        # Answered when the file is there with all that was before, so that the run is what finds the disk full.
        self.assertEqual(control.call(1, **set_parameter("food_health", 30)).status.code, 0)
        self.fill()
        asking = self.client(server, "waits")
        asking.ask(1, run=c.Run(generations=200))
        until(lambda: "commands are refused until it can be written again" in server.output(), "trouble")

        def stands():
            ticks = {control.world().tick for _ in range(200)}
            return len(ticks) == 1 and ticks.pop() > 100
        until(stands, "it waits")
        self.assertLess(control.world().tick, 199)
        self.assertEqual(control.call(2, **set_parameter("food_health", 5)).status.code, UNAVAILABLE)
        self.assertFalse(asking.is_told_something())
        self.make_room()
        self.assertEqual(asking.answer().status.code, 0)
        until(lambda: control.world().state == w.RUN_STATE_WAITING, "all generations")
        last = control.world()
        self.assertEqual(last.tick, 200)
        server.end()
        self.verify()


if __name__ == "__main__":
    unittest.main()
