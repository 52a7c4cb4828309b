"""Kills real servers and starts them again: nothing that was answered is lost or repeated.

    EVOD=… MESSAGES=… recovery_test.py      how often a test kills: KILLS (15)
"""
import contextlib
import os
import pathlib
import random
import re
import secrets
import shutil
import signal
import socket
import sqlite3
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, os.environ["MESSAGES"])
from evod.v1 import commands_pb2 as c, session_pb2, world_pb2 as w  # noqa: E402
import waiting  # noqa: E402
from waiting import until  # noqa: E402

evod, kills = os.environ["EVOD"], int(os.environ.get("KILLS", "15"))


class Server:
    def __init__(self, *options, ready=True, **popen):
        self.log = tempfile.TemporaryFile()
        self.process = subprocess.Popen([evod, "--port", "0", *options], stdout=self.log, stderr=self.log, **popen)
        if not ready:
            return
        until(lambda: self.process.poll() is not None or "listening on" in self.output(), "ready")
        if self.process.poll() is not None:
            raise AssertionError("evod ended at once:\n" + self.output())
        self.port = int(re.search(r"listening on 127\.0\.0\.1:(\d+)", self.output())[1])

    def output(self):
        return os.pread(self.log.fileno(), 1 << 20, 0).decode(errors="replace")

    def kill(self):
        self.process.kill()
        waiting.ended(self.process)

    def end(self, status=0):
        self.process.send_signal(signal.SIGTERM)
        assert waiting.ended(self.process) == status, self.output()


class Client:
    """Sends one request after another; EOFError when the server has ended."""

    def __init__(self, server, key):
        self.key = key
        greeting = self.greeted(server)
        while waiting.LATE_HELLO in greeting.goodbye.status.message:
            self.socket.close()
            greeting = self.greeted(server)
        assert greeting.HasField("welcome")
        self.welcome = greeting.welcome

    def greeted(self, server):
        try:
            self.socket = socket.create_connection(("127.0.0.1", server.port))
        except ConnectionRefusedError as gone:
            raise EOFError from gone
        self.socket.settimeout(waiting.LONGEST_S)
        self.send(session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1, client_name="kills")))
        return self.receive()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, message):
        body = message.SerializeToString()
        try:
            self.socket.sendall(b"EV\x01\x01" + struct.pack("<I", len(body)) + body)
        except (BrokenPipeError, ConnectionResetError) as gone:
            raise EOFError from gone

    def read(self, count):
        data = b""
        while len(data) < count:
            try:
                more = waiting.receive(self.socket, count - len(data))
            except ConnectionResetError:
                more = b""
            if not more:
                raise EOFError
            data += more
        return data

    def receive(self):
        while True:
            _, _, channel, length = struct.unpack("<2sBBI", self.read(8))
            body = self.read(length)
            if channel == 1:
                return session_pb2.ServerMessage.FromString(body)

    def call(self, request_id, **request):
        self.send(session_pb2.ClientMessage(request=c.Request(request_id=request_id, client_key=self.key, **request)))
        while True:
            message = self.receive()
            if message.HasField("response") and message.response.request_id == request_id:
                return message.response

    def world(self, name=""):
        worlds = self.call(1 << 40, list_worlds=c.ListWorlds()).worlds.worlds
        return next((x for x in worlds if not name or x.name == name), None)


def set_parameter(name, value, world=""):
    return {"set_parameters": c.SetParameters(world=world, parameters=[
        w.ParameterAssignment(name=name, value=w.ParameterValue(real=value))])}


def journal(data, world="default"):
    with sqlite3.connect(f"file:{data}/{world}.evod?mode=ro", uri=True) as run:
        return run.execute("SELECT number, tick, client_key, request_id FROM journal ORDER BY number").fetchall()


def half_written(run):
    """The numbers of parts of incomplete checkpoints, by tick."""
    return dict(run.execute("SELECT tick, count(*) FROM checkpoint_part WHERE tick NOT IN (SELECT tick FROM checkpoint)"
                            " GROUP BY tick"))


def kill_by_its_checkpoint(server, data, answered, after_s, parts, whole):
    """Kills a server by its first checkpoint, once so many parts of it are there, or, if it is to be whole, once it is
    and the server has answered again; or later, if that never comes."""
    def watch():
        time.sleep(after_s)
        # A checkpoint is due after two seconds of ticks, by the clock. Stopped within a tick for that long, it has one
        # due with little to simulate again; stopped between two, it comes to it by itself.
        server.process.send_signal(signal.SIGSTOP)
        time.sleep(2.05)
        with contextlib.closing(sqlite3.connect(f"file:{data}/crowd.evod?mode=ro", uri=True)) as run:
            def look():
                with contextlib.suppress(sqlite3.OperationalError):  # it was stopped while it held a lock
                    return half_written(run), run.execute("SELECT max(tick) FROM checkpoint").fetchone()
                return {}, None
            (left, newest), answers = look(), None

            def is_time():
                nonlocal answers
                if server.process.poll() is not None:
                    return True
                present, whole_one = look()
                if not whole:
                    return any(count >= parts for tick, count in present.items() if tick not in left)
                if answers is None and whole_one not in (None, newest):
                    answers = len(answered)
                return answers is not None and len(answered) > answers
            server.process.send_signal(signal.SIGCONT)
            with contextlib.suppress(AssertionError):  # it never comes
                until(is_time, "the checkpoint", pause_s=0.0002, longest_s=30)
            server.process.kill()
    threading.Thread(target=watch, daemon=True).start()


class Recovery(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.data = self.folder.name
        self.servers = []

    def tearDown(self):
        for server in self.servers:
            if server.process.poll() is None:
                server.kill()
            server.log.close()
        self.folder.cleanup()

    def serve(self, *options):
        for ended in [x for x in self.servers if x.process.poll() is not None]:  # a thousand kills leave as many logs
            ended.log.close()
            self.servers.remove(ended)
        self.servers.append(Server("--data", self.data, *options))
        return self.servers[-1]

    def assert_as_if_never_stopped(self, answered, key, *options):
        """Checks that no command was lost or repeated. answered: by request id, tick and value of "food_health"."""
        # Every request is in the journal once, at the tick it was answered with.
        (file,) = pathlib.Path(self.data).glob("*.evod")
        kept = [row for row in journal(self.data, file.stem) if row[2] == key]
        self.assertEqual([row[3] for row in kept], sorted(answered))
        self.assertEqual([row[1] for row in kept], [answered[i][0] for i in sorted(answered)])

        # A run that was never stopped, with the same commands at the same ticks, has the same hashes.
        server = self.serve()
        with Client(server, key) as client:
            self.assertEqual(client.call(max(answered) + 1, pause=c.Pause()).status.code, 0)
            last = client.world()
        server.end()
        whole = Server("--keep-nothing", *options)  # so that thousands of commands wait for no disk
        self.servers.append(whole)
        number = 0
        with Client(whole, "again") as client:
            def run_to(tick):
                nonlocal number
                number += 1
                client.call(number, run_until_tick=c.RunUntilTick(tick=tick))
                until(lambda: client.world().tick == tick, f"tick {tick}")
            for i in sorted(answered):
                tick, value = answered[i]
                run_to(tick)
                number += 1
                self.assertEqual(client.call(number, **set_parameter("food_health", value)).applied_tick, tick)
            run_to(last.tick)
            self.assertEqual(client.world().state_hash, last.state_hash)
        whole.end()

    def ask_until_it_has_gone(self, server, chance, key, answered, look=lambda: None):
        """Asks for one change after another until the server has been killed, then looks. What it was asked last may
        have been done and may not; the next one, which is killed too, is asked again."""
        request_id = max(answered, default=0)
        try:
            with Client(server, key) as client:
                # What had been answered before is answered the same.
                for known in sorted(answered)[-3:]:
                    again = client.call(known, **set_parameter("food_health", answered[known][1]))
                    self.assertEqual(again.applied_tick, answered[known][0])
                while True:
                    request_id += 1
                    value = chance.uniform(1, 9)
                    try:
                        response = client.call(request_id, **set_parameter("food_health", value))
                    except EOFError:
                        answered[request_id] = (None, value)
                        raise
                    self.assertEqual(response.status.code, 0, response)
                    answered[request_id] = (response.applied_tick, value)
        except EOFError:
            pass
        waiting.ended(server.process)
        look()
        # Sent again to the next server, the last one is done now if it was not.
        if request_id in answered and answered[request_id][0] is None:
            server = self.serve()
            with Client(server, key) as client:
                response = client.call(request_id, **set_parameter("food_health", answered[request_id][1]))
                answered[request_id] = (response.applied_tick, answered[request_id][1])
            server.kill()

    def test_random_kills_lose_and_repeat_nothing(self):
        chance, options = random.Random(3), ["--seed", "11", "--speed", "max"]
        at_once = 100  # kills of one world: every start reads its answers
        for first in range(0, kills, at_once):
            for file in pathlib.Path(self.data).iterdir():
                file.unlink()
            key, answered = secrets.token_hex(8), {}
            server = self.serve(*options)
            with Client(server, "start") as client:  # once that is answered, all later servers have this world
                self.assertEqual(client.call(1, run=c.Run()).status.code, 0)
            server.kill()
            for kill in range(first, min(kills, first + at_once)):
                server = self.serve("--threads", str(1 + kill % 3))
                threading.Timer(chance.uniform(0.005, 0.3), server.process.kill).start()
                self.ask_until_it_has_gone(server, chance, key, answered)
            self.assert_as_if_never_stopped(answered, key, *options)
            print(f"killed {kill + 1} times; {len(answered)} commands since {first}", flush=True)

    def test_kills_during_a_checkpoint_lose_and_repeat_nothing(self):
        # One generation, slow to simulate, in which no organism starves. So the server writes commands, hashes and
        # checkpoints of two megabytes only.
        crowd = pathlib.Path(self.data) / "crowd.json"
        crowd.write_text('{"population_size": 40000, "scale_with_population": true, "reference_population": 50,'
                         ' "generation_s": 3600, "health_loss_per_s": 0.1}')
        options = ["--experiment", str(crowd), "--seed", "13", "--speed", "max"]
        chance, key, answered = random.Random(5), secrets.token_hex(8), {}
        server = self.serve(*options)
        with Client(server, "start") as client:  # once that is answered, all later servers have this world
            self.assertEqual(client.call(1, run=c.Run()).status.code, 0)
        server.kill()
        wanted, lives, half_written_count, begun_with_one = max(3, kills // 25), 0, 0, 0
        self.left_half = {}
        while half_written_count < wanted:
            lives += 1
            self.assertLessEqual(lives, 5 * wanted + 10, f"only {half_written_count} kills came while a checkpoint was "
                                                         "written")
            server = self.serve("--threads", str(1 + lives % 3))
            before = self.left_half
            kill_by_its_checkpoint(server, self.data, answered, after_s=chance.uniform(0, 0.3),
                                   parts=chance.randint(1, 3),
                                   whole=lives % 2 == 1)
            self.ask_until_it_has_gone(server, chance, key, answered, self.look_at_what_is_left)
            half_written_count += any(tick not in before for tick in self.left_half)
            begun_with_one += self.left_checkpoint is not None
        print(f"killed {lives} times: {half_written_count} while a checkpoint was written; {begun_with_one} times the "
              "next server"
              " began with one", flush=True)
        self.assertGreater(begun_with_one, 0)
        self.assert_as_if_never_stopped(answered, key, *options)

    def look_at_what_is_left(self):
        """A file of a server that the test above killed; this leaves it unchanged."""
        with tempfile.TemporaryDirectory() as copy:
            shutil.copytree(self.data, copy, dirs_exist_ok=True)
            with sqlite3.connect(f"{copy}/crowd.evod") as run:
                self.left_half = half_written(run)
                (self.left_checkpoint,) = run.execute("SELECT max(tick) FROM checkpoint").fetchone()
                run.execute("UPDATE checkpoint SET state = zeroblob(length(state)) WHERE tick = ?",
                            (self.left_checkpoint,))
            run.close()
            # whether the next server begins with it: it would know that it is none
            if self.left_checkpoint is not None:
                server = Server("--data", copy)
                self.servers.append(server)
                server.end()
                self.assertIn(f'world "crowd" does not run: {copy}/crowd.evod is damaged: the row '
                              f'{self.left_checkpoint} of '
                              "its table checkpoint", server.output())

    def test_kills_during_recovery_lose_and_repeat_nothing(self):
        crowd = pathlib.Path(self.data) / "crowd.json"
        crowd.write_text('{"population_size": 5000, "scale_with_population": true, "reference_population": 50}')
        options = ["--experiment", str(crowd), "--seed", "12", "--speed", "max"]
        chance, key, answered, killed_before_ready = random.Random(4), secrets.token_hex(8), {}, 0
        server = self.serve(*options, "--start")
        for life in range(3):
            first = 2 * life + 1
            with Client(server, key) as client:
                begun = client.world().tick
                until(lambda: client.world().tick > begun + 400, "ticks to simulate again")
                answered[first] = (client.call(first, **set_parameter("food_health", first)).applied_tick, first)
                until(lambda: client.world().tick > answered[first][0] + 100, "ticks after the command")
                # One that may have been done and may not, when the server dies.
                client.send(session_pb2.ClientMessage(request=c.Request(
                    request_id=first + 1, client_key=key, **set_parameter("food_health", first + 1))))
                time.sleep(chance.uniform(0, 0.01))
            server.kill()
            began = time.monotonic()
            server = self.serve("--threads", str(1 + life))
            takes_s = time.monotonic() - began
            server.kill()
            kills_left, wanted = max(4, kills // 6), killed_before_ready + 2
            while kills_left > 0 or killed_before_ready < wanted:
                kills_left -= 1
                self.servers.append(Server("--data", self.data, ready=False))
                lives_s = chance.uniform(0, takes_s)
                time.sleep(lives_s)
                self.servers[-1].kill()
                if "listening on" in self.servers[-1].output():
                    takes_s = lives_s  # the machine was slower when this was measured
                else:
                    killed_before_ready += 1
            server = self.serve("--threads", str(3 - life))
            with Client(server, key) as client:
                for i in first, first + 1:
                    response = client.call(i, **set_parameter("food_health", i))
                    self.assertEqual(response.status.code, 0, response)
                    if i in answered:
                        self.assertEqual(response.applied_tick, answered[i][0])
                    answered[i] = (response.applied_tick, i)
        server.kill()
        self.assert_as_if_never_stopped(answered, key, *options)

    def test_a_closed_server_continues_with_its_run_control(self):
        server = self.serve("--seed", "5", "--speed", "max")
        with Client(server, "k") as client:
            client.call(1, run=c.Run(generations=3))
            until(lambda: client.world().generation == 3 and client.world().state == w.RUN_STATE_WAITING,
                  "3 generations")
            client.call(2, run_until_tick=c.RunUntilTick(tick=7777))
            until(lambda: client.world().tick == 7777, "tick 7777")
            client.call(3, create_world=c.CreateWorld(name="second", seed=2))
            before = {x.name: x for x in client.call(99, list_worlds=c.ListWorlds()).worlds.worlds}
        server.end()
        server = self.serve("--threads", "3")
        with Client(server, "k") as client:
            after = {x.name: x for x in client.call(99, list_worlds=c.ListWorlds()).worlds.worlds}
            self.assertEqual(set(after), {"default", "second"})
            for name in before:
                for field in ("tick", "generation", "state_hash", "state", "run_id", "seed", "speed"):
                    self.assertEqual(getattr(after[name], field), getattr(before[name], field), f"{name}: {field}")
        server.end()

    def test_runs_are_stored_in_the_state_folder_by_default(self):
        for variable, folder in (("XDG_STATE_HOME", f"{self.data}/evod"), ("HOME", f"{self.data}/.local/state/evod")):
            server = Server(env={variable: self.data})
            self.servers.append(server)
            server.end()
            self.assertIn(f"runs are stored in {folder}", server.output())
            self.assertTrue(os.path.exists(f"{folder}/default.evod"))
        refused = waiting.run([evod, "--port", "0"], env={}, capture_output=True, text=True)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("--data", refused.stderr)
        before = set(pathlib.Path(self.data).rglob("*"))
        server = Server("--keep-nothing", env={"HOME": self.data})
        self.servers.append(server)
        server.end()
        self.assertEqual(set(pathlib.Path(self.data).rglob("*")), before)

    def test_a_file_without_a_world_name_is_ignored(self):
        strange = pathlib.Path(self.data, "my run.evod")
        strange.write_text("not ours")
        server = self.serve("--seed", "5")
        self.assertIn(f"{strange} is ignored", server.output())
        server.end()
        self.assertEqual(strange.read_text(), "not ours")


if __name__ == "__main__":
    unittest.main()
