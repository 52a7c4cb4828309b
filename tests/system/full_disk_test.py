"""Real servers whose disk is full for a while: a small tmpfs, and a file that fills it.

    EVOD=… EVOCTL=… MESSAGES=… [MPIRUN=…] full_disk_test.py     skipped with status 77 where nothing may be mounted
"""
import os
import pathlib
import re
import select
import sqlite3
import struct
import subprocess
import tempfile
import unittest

import namespaces

if __name__ == "__main__":
    namespaces.enter(["--mount"], ["mount", "-t", "tmpfs", "-o", "size=1m", "none", "/mnt"],
                     "no tmpfs may be mounted here")

import recovery_test as recovery  # noqa: E402
import waiting  # noqa: E402
from open_mpi import OPEN_MPI  # noqa: E402
from recovery_test import Server, c, journal, set_parameter, session_pb2, until, w  # noqa: E402
from evod.v1 import stream_pb2  # noqa: E402

evoctl, UNAVAILABLE = os.environ["EVOCTL"], 14
KEEPS_UP, BEHIND = w.STORAGE_STATE_KEEPS_UP, w.STORAGE_STATE_BEHIND
FAILING, STALLED = w.STORAGE_STATE_FAILING, w.STORAGE_STATE_STALLED


class Client(recovery.Client):
    def ask(self, request_id, **request):
        self.send(session_pb2.ClientMessage(request=c.Request(request_id=request_id, client_key=self.key, **request)))

    def answer(self):
        return next(m.response for m in iter(self.receive, None) if m.HasField("response"))

    def storage_states(self, until):
        """The states of the disk in events, up to that state, except BEHIND, which may come while the machine is
        busy."""
        states = []
        while not states or states[-1] != until:
            event = next(m.event for m in iter(self.receive, None) if m.HasField("event"))
            if event.HasField("storage_changed"):
                storage = event.storage_changed.storage
                assert event.world == "" and (storage.reason == "") == (storage.state == KEEPS_UP), event
                if storage.state != BEHIND:
                    states.append(storage.state)
        return states

    def storage(self):
        return self.call(999, list_worlds=c.ListWorlds()).worlds.worlds[0].storage

    def gets_events(self):
        return bool(select.select([self.socket], [], [], 0)[0])

    def snapshot(self, condition):
        """The next snapshot for which the condition holds."""
        while True:
            _, _, channel, length = struct.unpack("<2sBBI", self.read(8))
            body = self.read(length)
            if channel == 2 and condition(snapshot := stream_pb2.SnapshotFrame.FromString(body)):
                return snapshot


class FullDisk(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.data, self.mounted, self.servers, self.readers = folder.name, False, [], []

    def tearDown(self):
        self.close_readers()
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
        """Fills the disk. A reader keeps the log of the run file in existence: otherwise SQLite would delete it, and
        free space, when the server closes the file before it tries again."""
        reader = sqlite3.connect(f"file:{self.data}/default.evod?mode=ro", uri=True)
        reader.execute("SELECT count(*) FROM journal").fetchall()
        self.readers.append(reader)
        with open(f"{self.data}/big", "wb", buffering=0) as big:
            for chunk in (bytes(1 << 20), bytes(1 << 12), b"x"):
                try:
                    while True:
                        big.write(chunk)
                except OSError as full:
                    self.assertEqual(full.errno, 28)

    def make_room(self):
        os.remove(f"{self.data}/big")
        self.close_readers()

    def close_readers(self):
        while self.readers:
            self.readers.pop().close()

    def status(self, server):
        return waiting.run([evoctl, "--server", f"127.0.0.1:{server.port}", "status"], capture_output=True, text=True,
                           check=True).stdout

    def verify(self):
        done = waiting.run([recovery.evod, "verify", f"{self.data}/default.evod"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def fill_and_ask_for_what_cannot_be_written(self, server, control):
        """The world runs, and no client was notified."""
        self.fill()
        asking = self.client(server, "waits")
        asking.ask(1, run=c.Run())
        until(lambda: "commands are refused until the file can be written again" in server.output(), "trouble")
        self.assertIn("full", server.output())
        refused = control.call(10, **set_parameter("food_health", 5))
        self.assertEqual(refused.status.code, UNAVAILABLE)
        self.assertIn("the server accepts no commands because it cannot record them", refused.status.message)
        self.assertIn("full", refused.status.message)
        return asking

    def test_commands_are_refused_until_there_is_room(self):
        self.mount(8)
        server = self.serve("--seed", "3", "--speed", "1000")
        control, viewer, listens = (self.client(server, name) for name in ("control", "viewer", "listens"))
        self.assertEqual(listens.welcome.storage.state, KEEPS_UP)
        self.assertEqual(control.storage().state, KEEPS_UP)
        listens.call(1, subscribe_events=c.SubscribeEvents(world="default"))
        viewer.call(1, subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
        self.assertEqual(control.call(1, **set_parameter("food_health", 30)).status.code, 0)
        asking = self.fill_and_ask_for_what_cannot_be_written(server, control)
        # Every client sees the state, also one that connects later.
        self.assertEqual(listens.storage_states(FAILING), [FAILING])
        for storage in control.storage(), self.client(server, "later").welcome.storage:
            self.assertEqual(storage.state, FAILING)
            self.assertIn("full", storage.reason)
        self.assertIn(f"commands are refused: {storage.reason}\n", self.status(server))
        # Everything that needs no disk continues: the world, its snapshots, queries.
        seen = viewer.snapshot(lambda snapshot: True).tick
        seen = viewer.snapshot(lambda snapshot: snapshot.tick > seen + 3000).tick
        self.assertGreaterEqual(control.world().tick, seen)
        self.assertEqual(control.call(11, set_parameters=c.SetParameters(dry_run=True)).status.code, 0)
        again = control.call(12, pause=c.Pause())
        self.assertEqual(again.status.code, UNAVAILABLE)
        self.assertFalse(asking.gets_events())
        self.make_room()
        self.assertEqual(asking.answer().status.code, 0)
        until(lambda: "run files can be written again" in server.output(), "the end of the trouble")
        self.assertEqual(listens.storage_states(KEEPS_UP), [KEEPS_UP])
        self.assertEqual(control.storage(), w.Storage(state=KEEPS_UP))
        self.assertNotIn("refused", self.status(server))
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

    def test_a_server_ending_on_a_full_disk_logs_what_is_lost(self):
        self.mount(8)
        server = self.serve("--seed", "3", "--speed", "1000")
        control = self.client(server, "control")
        self.assertEqual(control.call(1, **set_parameter("food_health", 30)).status.code, 0)
        before = control.world()
        self.fill_and_ask_for_what_cannot_be_written(server, control)
        server.end(status=4)
        self.assertRegex(server.output(), r'world "default": \d+ bytes could not be written: the results of \d+ '
                                          r'generations, '
                                          f"1 commands, and the last tick. {self.data}/default.evod contains every "
                                          "acknowledged command")
        self.make_room()
        server = self.serve()
        now = self.client(server, "control").world()
        self.assertEqual((now.tick, now.state_hash, now.state), (before.tick, before.state_hash, before.state))
        server.end()

    def test_a_kill_on_a_full_disk_loses_only_the_unanswered(self):
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
        until(lambda: "commands are refused until the file can be written again" in server.output(), "trouble")
        self.make_room()
        self.assertEqual(asking.answer().status.code, 0)
        until(lambda: control.world().tick > 1000, "ticks")
        server.end()
        self.assertEqual([row[2:] for row in journal(self.data)][-3:], [("control", 1), ("control", 2), ("waits", 1)])
        self.verify()

    def test_worlds_wait_while_too_much_is_unwritten(self):
        self.mount(400)
        crowd = pathlib.Path(self.data) / "default.json"
        # A generation is a tick, and weighs half a megabyte; so slow that trouble is noticed before there is no room.
        crowd.write_text('{"population_size": 10000, "scale_with_population": true, "fitness": "gene_sum"}')
        server = self.serve("--seed", "3", "--speed", "1", "--experiment", str(crowd))
        control, listens = self.client(server, "control"), self.client(server, "listens")
        listens.call(1, subscribe_events=c.SubscribeEvents())
        watching = tempfile.TemporaryFile()
        self.addCleanup(watching.close)
        watch = subprocess.Popen([evoctl, "--server", f"127.0.0.1:{server.port}", "watch"], stdout=subprocess.DEVNULL,
                                 stderr=watching)
        self.addCleanup(watch.wait)
        self.addCleanup(watch.kill)
        self.assertEqual(control.call(1, run=c.Run(generations=20)).status.code, 0)
        until(lambda: control.world().state == w.RUN_STATE_WAITING, "a past")
        # Answered when the file holds all that was before, so that the run is what finds the disk full.
        self.assertEqual(control.call(2, **set_parameter("food_health", 30)).status.code, 0)
        self.fill()
        asking = self.client(server, "waits")
        asking.ask(1, run=c.Run(generations=200))
        self.assertEqual(listens.storage_states(STALLED), [FAILING, STALLED])
        self.assertIn("worlds wait for the disk", server.output())

        # Those that live stand still, and say why.
        world = control.world()
        self.assertGreater(world.tick, 120)
        self.assertLess(world.tick, 219)
        self.assertEqual((world.state, world.ticks_per_s, world.storage.state), (w.RUN_STATE_RUNNING, 0, STALLED))
        self.assertIn("full", world.storage.reason)
        status = self.status(server)
        self.assertIn(f"worlds wait for the disk, commands are refused: {world.storage.reason}\n", status)
        self.assertRegex(status, r"default +waits for the disk +1×")
        self.assertEqual(control.call(3, **set_parameter("food_health", 5)).status.code, UNAVAILABLE)
        # Who comes now sees them, and the past.
        newcomer = self.client(server, "newcomer")
        self.assertEqual(newcomer.welcome.storage, world.storage)
        newcomer.call(1, subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
        self.assertEqual(newcomer.snapshot(lambda snapshot: True).tick, world.tick)
        look = newcomer.call(2, open_replay=c.OpenReplay(at=c.RunMoment(generation=5)))
        self.assertEqual((look.status.code, look.world.generation), (0, 5), look.status.message)
        self.assertFalse(look.world.HasField("storage"))
        name = look.world.name
        newcomer.call(3, subscribe_snapshots=c.SubscribeSnapshots(world=name, rate_hz=60))
        self.assertEqual(newcomer.call(4, run_until_tick=c.RunUntilTick(world=name, tick=15)).status.code, 0)
        newcomer.snapshot(lambda snapshot: (snapshot.world, snapshot.tick) == (name, 15))
        sought = newcomer.call(5, seek=c.Seek(world=name, to=c.RunMoment(generation=2)))
        self.assertEqual((sought.status.code, sought.world.generation), (0, 2), sought.status.message)
        self.assertEqual(control.world().tick, world.tick)

        self.make_room()
        self.assertEqual(asking.answer().status.code, 0)
        self.assertLessEqual(set(listens.storage_states(KEEPS_UP)[:-1]), {FAILING})
        self.assertIn("worlds continue", server.output())
        self.assertEqual(control.storage(), w.Storage(state=KEEPS_UP))
        until(lambda: control.world().state == w.RUN_STATE_WAITING, "all generations")
        last = control.world()
        self.assertEqual(last.tick, 220)
        until(lambda: b"again" in os.pread(watching.fileno(), 1 << 16, 0), "the end of the trouble")
        said = os.pread(watching.fileno(), 1 << 16, 0).decode()
        self.assertRegex(said, r"^commands are refused: .*full.*\nworlds wait for the disk, commands are refused: "
                               r"(.*\n)+"
                               r"run files can be written again\n$")
        server.end()
        self.verify()

    def test_a_run_without_a_server_ends_and_continues(self):
        self.mount(1)
        run = [recovery.evod, "run", "--set", "generation_s=2", "--set", "population_size=200", "--set",
               "island_count=2",
               "--generations", "40", "--threads", "1", "--seed", "3", "--run-file"]
        mpirun = os.environ.get("MPIRUN", "")
        for kind, prefix in ("alone", []), ("shared", [mpirun, "-n", "2"]):
            if prefix and not mpirun:
                continue
            file = f"{self.data}/{kind}.evod"
            with self.subTest(kind):
                done = waiting.run([*prefix, *run, file], capture_output=True, text=True,
                                   env={**os.environ, **OPEN_MPI})
                self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
                self.assertEqual(len(re.findall("^evod: ", done.stderr, re.MULTILINE)), 1, done.stderr)
                self.assertIn("full", done.stderr)
                printed = [line for line in done.stdout.splitlines() if line[:10].strip().isdigit()]
                subprocess.run(["mount", "-o", "remount,size=100m", self.data], check=True)
                done = waiting.run([*prefix, *run, file], capture_output=True, text=True,
                                   env={**os.environ, **OPEN_MPI})
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertIn(f"\ncontinues at generation {len(printed) // 2 + 1}\n", done.stdout)
                done = waiting.run([recovery.evod, "verify", file], capture_output=True, text=True)
                self.assertIn("everything agrees: 40 generations", done.stdout + done.stderr)
                os.remove(file)
                subprocess.run(["mount", "-o", "remount,size=1m", self.data], check=True)


if __name__ == "__main__":
    unittest.main()
