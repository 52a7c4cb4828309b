"""No user can take what belongs to all. EVOD and EVOCTL name the programs, MESSAGES the folder of the message classes.

Each test is one pool that all clients share. Eve, a viewer, takes all of it that she gets, and keeps it
(greedy_user.py). Meanwhile Ada, a controller, does one of everything: each request of hers is answered right, at the
first attempt. Pools that are only places in a table have unit tests alone: exports, replays and running breedings
(background_queries_test, replay_places_test), the mailbox (mailbox_test) and the reply cache (reply_cache_test).
"""
import contextlib
import http.client
import json
import os
import pathlib
import re
import secrets
import subprocess
import sys
import tempfile
import time
import unittest

import past_test as past
import waiting
from past_test import EVOD, c, plain, w

MESSAGES = os.environ["MESSAGES"]
GREEDY_USER = str(pathlib.Path(__file__).with_name("greedy_user.py"))
SESSIONS_MAX, FAR_TICK = 64, 100_000
MEMORY_BYTES = plain.limit("client_buffer_bytes_max") + (128 << 20)  # docs/OPERATIONS.md
POOLS = {  # what each attack of greedy_user.py takes, and the address of Ada, who otherwise shares that of Eve
    "sessions": "127.0.0.1", "strangers": "127.0.0.2", "http": "127.0.0.2", "seeks": "127.0.0.1",
    "simulated_exports": "127.0.0.1", "queries": "127.0.0.1", "frames": "127.0.0.1", "memory": "127.0.0.1",
    "events": "127.0.0.1"}


class Client(past.Client):
    def __init__(self, server, token, come_from="127.0.0.1"):
        super().__init__(server, hello=False, over=self.connected(server, come_from))
        self.hello(token=token)
        first = self.control()
        assert first.HasField("welcome"), f"no session: {first}"


class Server(past.Server):
    def __init__(self, folder, *options):
        super().__init__("--data", folder, "--require-token", "--durability", "relaxed", "--http-port", "0",
                         "--sessions-max", str(SESSIONS_MAX), *options)
        self.http_port = int(re.search(r"http://127\.0\.0\.1:(\d+)/metrics", self.output())[1])

    def memory_bytes(self):
        with open(f"/proc/{self.process.pid}/status") as status:
            return int(re.search(r"VmRSS:\s+(\d+) kB", status.read())[1]) << 10


class Ground:
    """A data folder with the runs that are attacked, and what Ada must be answered."""

    def __init__(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = self.temporary.name
        self.secrets = {name: waiting.run([EVOD, "token", "add", name, "--role", role, "--data", self.folder],
                                          capture_output=True, text=True, check=True).stdout.strip()
                        for name, role in (("root", "admin"), ("ada", "controller"), ("eve", "viewer"),
                                           ("bob", "viewer"))}
        self.serve(self.simulate, "--keep-every", "1000")
        self.serve(self.store_answers)

    def serve(self, use, *options):
        server = Server(self.folder, *options)
        try:
            with Client(server, self.secrets["root"]) as root:
                use(root)
            server.end()
        finally:
            server.kill()
            server.log.close()

    def simulate(self, root):
        for name, generations, parameters in (
                ("sparse", 30, {"population_size": 300, "scale_with_population": True, "generation_s": 5.0}),
                ("w", 400, {"population_size": 20, "generation_s": 0.2}),
                ("long", 0, {"population_size": 500, "scale_with_population": True, "generation_s": 86400.0}),
                ("big", 0, {"population_size": 5000, "scale_with_population": True}),
                ("islands", 0, {"island_count": 4096, "population_size": 4}), ("live", 0, {"population_size": 50})):
            root.call(create_world=c.CreateWorld(name=name, seed=1, parameters=plain.assignments(**parameters)))
            if generations:
                root.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
                root.call(run=c.Run(world=name, generations=generations))
                root.wait_world(lambda x: x.state == w.RUN_STATE_WAITING, name)
        root.call(set_speed=c.SetSpeed(world="long", speed=w.Speed(max=True)))
        root.run_to(FAR_TICK + FAR_TICK // 2, "long")

    def store_answers(self, root):
        self.table, self.breeding = export(root), root.call(get_breeding=BREEDING).breeding

    def cleanup(self):
        self.temporary.cleanup()


BREEDING = c.GetBreeding(world="w", generation=2)


def export(client):
    """The table of generations of the world w."""
    part = client.call(export_run=c.ExportRun(world="w", table=c.RUN_TABLE_GENERATIONS,
                                              format=c.TEXT_FORMAT_CSV)).export_part
    text = part.text
    while not part.last:
        part = client.call(continue_export=c.ContinueExport(export_id=part.export_id)).export_part
        text += part.text
    return text


class Greedy:
    """Eve, while she attacks; as a context manager."""

    def __init__(self, ground, server, pool):
        self.process = subprocess.Popen(
            [sys.executable, GREEDY_USER, MESSAGES, str(server.port), str(server.http_port), ground.secrets["eve"], "w",
             "islands", pool], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env={**os.environ, "FAR_TICK": str(FAR_TICK)})

    def __enter__(self):
        assert self.process.stdout.readline() == "ready\n"
        return self

    def __exit__(self, *_):
        self.process.kill()
        waiting.communicate(self.process)

    def end(self):
        """Ends the attack and returns its counts."""
        return json.loads(waiting.communicate(self.process)[0])


class Ada:
    """A user who does one of everything. As a context manager: her session, which is open before the attack."""

    def __init__(self, ground, server, pool):
        self.ground, self.server, self.come_from = ground, server, POOLS[pool]
        self.key, self.commands = secrets.token_hex(8), 0
        self.session = self.open_session()

    def __enter__(self):
        self.session.call(subscribe_events=c.SubscribeEvents())
        self.session.call(run=c.Run(world="live"))
        self.first = self.command(self.session, 1)
        return self

    def __exit__(self, *_):
        self.session.socket.close()

    def open_session(self):
        return Client(self.server, self.ground.secrets["ada"], self.come_from)

    def command(self, client, number):
        """A command whose id is its number. The answer to a repeated one is that to the first."""
        speed = w.Speed(real_time_factor=1 + number % 5)
        answer = client.call(request_id=number, client_key=self.key, set_speed=c.SetSpeed(world="live", speed=speed))
        assert answer.world.speed == speed, answer
        return answer

    def one_of_everything(self):
        """The duration of each request, in seconds, by what it does."""
        times = {}

        @contextlib.contextmanager
        def doing(what):
            began = time.perf_counter()
            try:
                yield
            except (AssertionError, EOFError, OSError) as fault:
                raise AssertionError(f"{what}: {fault}") from fault
            times[what] = time.perf_counter() - began

        with doing("session"):
            client = self.open_session()
        with client:
            with doing("query"):
                assert client.call(get_statistics=c.GetStatistics(world="live")).statistics.world.name == "live"
            with doing("command"):
                self.commands += 1
                answer = self.command(client, 1 + self.commands)
            with doing("repeated command"):
                assert self.command(client, 1 + self.commands) == answer
                assert self.command(client, 1) == self.first
            with doing("event"):
                self.session.next_event("run_control_changed", lambda event: event.tick == answer.applied_tick)
            with doing("replay"):
                replay = client.call(open_replay=c.OpenReplay(world="w", at=c.RunMoment(generation=1))).world
                assert (replay.replay.replay_of, replay.tick) == ("w", 0), replay
            with doing("seek"):
                there = client.call(seek=c.Seek(world=replay.name, to=c.RunMoment(generation=2))).world
                assert (there.generation, there.generation_tick) == (2, 0), there
            with doing("breeding"):
                assert client.call(get_breeding=BREEDING).breeding == self.ground.breeding
            with doing("export"):
                assert export(client) == self.ground.table
            with doing("snapshot"):
                client.call(subscribe_snapshots=c.SubscribeSnapshots(world="live", rate_hz=20))
                client.next_snapshot(lambda snapshot: snapshot.world == "live")
        with doing("page"):
            page = http.client.HTTPConnection("127.0.0.1", self.server.http_port, source_address=(self.come_from, 0),
                                              timeout=waiting.LONGEST_S)
            with contextlib.closing(page):
                page.request("GET", "/healthz")
                assert page.getresponse().status == 200
        with doing("old session"):
            self.session.call(list_worlds=c.ListWorlds())
        return times


ROUNDS = 3


class Pools(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.ground = Ground()
        cls.addClassCleanup(cls.ground.cleanup)

    def attacked(self, pool, bytes_max=None):
        """bytes_max: by how much the server's memory may grow."""
        server = Server(self.ground.folder)
        self.addCleanup(server.log.close)
        self.addCleanup(server.kill)
        before = server.memory_bytes()
        with Ada(self.ground, server, pool) as ada:
            with Greedy(self.ground, server, pool) as eve:
                for _ in range(ROUNDS):
                    ada.one_of_everything()
                if bytes_max is not None:
                    self.assertLess(server.memory_bytes() - before, bytes_max)
                counts = eve.end()
            if pool != "http" and pool != "strangers":
                self.assertGreater(counts["sent_bytes"], 0)
            ada.one_of_everything()
            self.assertFalse([event for event in ada.session.events if event.HasField("events_dropped")])
        server.end()
        self.assertNotIn("Sanitizer", server.output())

    def test_sessions(self):
        self.attacked("sessions")

    def test_connections_without_a_hello(self):
        self.attacked("strangers")

    def test_http_connections(self):
        self.attacked("http")

    def test_seeks(self):
        self.attacked("seeks")

    def test_exports_of_simulated_generations(self):
        self.attacked("simulated_exports")

    def test_queries(self):
        self.attacked("queries")

    def test_the_time_for_long_messages(self):
        self.attacked("frames")

    def test_memory(self):
        self.attacked("memory", MEMORY_BYTES)

    def test_events(self):
        self.attacked("events")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
