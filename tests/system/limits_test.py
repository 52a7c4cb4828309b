"""Every limit of docs/OPERATIONS.md driven to its edge over real sockets: at the limit it works, beyond it what the
table says happens, and everybody else goes on. EVOD and EVOCTL name the programs, MESSAGES the folder of the message
classes.

Driven elsewhere: waiting_events_max by tests/unit/runtime/outbox_test.cpp, for nothing outside can hold the network's
thread still; answers_cached_max and client_keys_max by tests/unit/network/reply_cache_test.cpp; lease_s, with all about
leases, and running out of file descriptors by protocol_*_test.py.
"""
import contextlib
import pathlib
import re
import resource
import socket
import struct
import sys
import tempfile
import threading
import time
import unittest

import access_test as access
import waiting
from access_test import c, plain
from attack import Attack

from evod.v1 import session_pb2  # noqa: E402  (its folder is in sys.path now)

program = pathlib.Path(access.EVOD).read_bytes()
SLOW = b"__tsan_init" in program
HELLO_S, STALLED_S = plain.limit("hello_timeout_s"), plain.limit("stalled_timeout_s")
SANITIZED = SLOW or b"__asan_init" in program  # sanitizers change the memory use
OK, INVALID, EXHAUSTED, PRECONDITION, UNIMPLEMENTED = 0, 3, 8, 9, 12


def frame(message):
    body = message.SerializeToString()
    return b"EV\x01\x01" + struct.pack("<I", len(body)) + body


def request(**fields):
    return session_pb2.ClientMessage(request=c.Request(**{"request_id": 1, **fields}))


def padded(message, size):
    """The bytes of a message, padded to that length by an unknown field."""
    body = message.SerializeToString()
    padding = size - len(body) - 5
    return body + b"\xa2\x06" + bytes([padding & 127 | 128, padding >> 7 & 127 | 128, padding >> 14]) + b"x" * padding


def nested(message, depth):
    """A request with unknown groups nested so deep."""
    body = message.SerializeToString() + b"\xa3\x06" * depth + b"\xa4\x06" * depth
    assert 128 <= len(body) < 128 * 128
    return b"\x12" + bytes([len(body) % 128 + 128, len(body) // 128]) + body


class Case(access.Access):
    def serve(self, *options):
        return super().serve("--durability", "relaxed", *options)

    @contextlib.contextmanager
    def served_once(self, *options):
        """A server with its own folder, for an attempt that may be repeated."""
        with tempfile.TemporaryDirectory() as self.folder:
            server = self.serve(*options)
            try:
                yield server
            finally:
                server.kill()

    def small(self, server):
        """A client with small kernel buffers."""
        over = socket.socket()
        self.addCleanup(over.close)
        over.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        over.connect(("127.0.0.1", server.port))
        over.settimeout(waiting.LONGEST_S)
        return plain.Client(server, over=over)

    def closed_with_goodbye(self, client, code, words):
        status = client.goodbye()
        self.assertEqual(status.code, code)
        self.assertIn(words, status.message)
        client.assert_closed()

    def counts(self, client):
        """How often each limit was reached, by name; empty if the server has no GetMetrics."""
        response = client.response(client.ask(get_metrics=c.GetMetrics()))
        if response.status.code == UNIMPLEMENTED:
            return None
        return {label.value: sample.value for family in response.metrics.families
                if family.name == "evod_limit_reached_total" for sample in family.samples for label in sample.labels}

    @contextlib.contextmanager
    def meets(self, client, *limits):
        """The block reaches these limits, and the client is served normally afterwards."""
        before = self.counts(client)
        yield
        client.call(list_worlds=c.ListWorlds())
        if before is not None:
            after = self.counts(client)
            for limit in limits:
                self.assertGreater(after[limit], before[limit], limit)

    def world_of_short_generations(self, client, generations, **parameters):
        client.call(create_world=c.CreateWorld(name="short", seed=1, parameters=plain.assignments(
            fitness="gene_sum", **parameters)))
        client.call(set_speed=c.SetSpeed(world="short", speed=plain.w.Speed(max=True)))
        self.run_short_generations(client, generations)

    def run_short_generations(self, client, generations):
        client.call(run=c.Run(world="short", generations=generations))
        client.wait_world(lambda world: world.state == plain.w.RUN_STATE_WAITING, "short")


class Frames(Case):
    def test_frame_sizes(self):
        server = self.serve()
        other = self.come(server)
        limits = other.welcome.limits
        hello = session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1))
        longest = plain.Client(server, hello=False)
        self.addCleanup(longest.socket.close)
        longest.send_body(padded(hello, limits.hello_frame_bytes_max))
        self.assertTrue(longest.control().HasField("welcome"))
        longest.send_body(padded(request(list_worlds=c.ListWorlds()), limits.control_frame_bytes_max))
        self.assertEqual(longest.response(1).status.code, OK)
        for too_long in (limits.hello_frame_bytes_max + 1, 0xffffffff):
            with self.meets(other, "hello_frame_bytes_max"), plain.Client(server, hello=False) as longer:
                longer.socket.sendall(b"EV\x01\x01" + struct.pack("<I", too_long))
                self.closed_with_goodbye(longer, INVALID, str(limits.hello_frame_bytes_max))
        with self.meets(other, "control_frame_bytes_max"):
            longest.socket.sendall(b"EV\x01\x01" + struct.pack("<I", limits.control_frame_bytes_max + 1))
            self.closed_with_goodbye(longest, INVALID, str(limits.control_frame_bytes_max))

    def test_nesting_depth(self):
        server = self.serve()
        client, other = self.come(server), self.come(server)
        depth = client.welcome.limits.message_depth_max
        asking = c.Request(request_id=7, list_worlds=c.ListWorlds())
        client.send_body(nested(asking, depth - 1))  # nested in the request, which is nested in a message
        self.assertEqual(client.response(7).status.code, OK)
        for deeper in (depth, 3000):
            with self.meets(other, "message_depth_max"):
                client.send_body(nested(asking, deeper))
                status = client.response(0).status
                self.assertEqual(status.code, INVALID)
                self.assertIn(f"more than {depth} deep", status.message)
        client.call(list_worlds=c.ListWorlds())
        with self.meets(other, "message_depth_max"), plain.Client(server, hello=False) as stranger:
            stranger.send_body(nested(asking, depth))
            self.closed_with_goodbye(stranger, INVALID, f"more than {depth} deep")


class Sessions(Case):
    def test_an_address_has_half_of_the_sessions(self):
        server = self.serve("--sessions-max", "8")
        here = [self.come(server) for _ in range(4)]
        self.assertEqual(here[0].welcome.limits.sessions_max, 8)
        self.assertEqual(here[0].call(describe=c.Describe()).description.limits, here[0].welcome.limits)
        with self.meets(here[0], "sessions_max"):
            refused = self.come(server)
            self.assertEqual(refused.refusal.code, EXHAUSTED)
            self.assertIn("there are 4 sessions of this user, or from this address", refused.refusal.message)
            refused.assert_closed()
        there = [self.come(server, come_from="127.0.0.2") for _ in range(4)]
        self.assertIsNotNone(self.come(server, come_from="127.0.0.3").welcome)  # here loses its oldest session
        self.closed_with_goodbye(here[0], EXHAUSTED, "another user needs the place")
        for client in (*here[1:], *there):
            client.call(list_worlds=c.ListWorlds())
        here[3].socket.close()
        plain.until(lambda: self.come(server, come_from="127.0.0.3").welcome, "a place is free again")

    def test_silent_connections_make_room_for_new_ones(self):
        def make_room(_):
            with self.served_once("--sessions-max", "6") as server:
                self.make_room(server)
        waiting.quicker_than(HELLO_S, make_room)

    def make_room(self, server):
        first = self.come(server)
        half = (first.welcome.limits.newcomers_max + 1) // 2
        silent = [self.enterContext(plain.Client(server, hello=False, come_from="127.0.0.2")) for _ in range(half)]
        with self.meets(first, "newcomers_max"):
            newcomer = self.come(server, come_from="127.0.0.2")
            self.assertEqual(newcomer.welcome.limits.sessions_max, 6)
        self.closed_with_goodbye(silent[0], EXHAUSTED, "no Hello was received")
        silent[1].hello()  # only the first was closed
        self.assertTrue(silent[1].control().HasField("welcome"))
        for client in (first, newcomer):
            client.call(list_worlds=c.ListWorlds())

    def test_connections_without_hello_block_no_client(self):
        few = resource.RLIMIT_NOFILE, (400, 400)
        server = self.server("--data", self.folder, preexec_fn=lambda: resource.setrlimit(*few))
        attack = self.enterContext(Attack(plain.messages_path, server.port, "strangers", 500))
        tries = 0

        def welcomed():
            nonlocal tries
            tries += 1
            with contextlib.suppress(EOFError):
                client = plain.Client(server)
                if client.welcome.instance_id:
                    return client
                client.socket.close()  # it was silent so long that the server closed it to make room
        for i in range(20):
            # a new connection each time, and each needs file descriptors
            with plain.until(welcomed, "a welcome") as honest:
                honest.call(create_world=c.CreateWorld(name=f"w{i}", seed=1, parameters=plain.assignments(
                    population_size=5)))
        self.assertLess(tries, 30)
        plain.until(lambda: attack.counts()["closed"] > 0, "strangers that are closed")
        self.assertNotIn("unable to open", server.output())

    def test_a_thousand_idle_sessions_take_little_memory(self):
        server = self.serve("--sessions-max", "2200")
        first = self.come(server)
        before = memory_kib(server)
        idle = []
        for _ in range(1000):
            client = self.come(server)
            client.send_body(padded(request(list_worlds=c.ListWorlds()), 3000))
            idle.append(client)
        for client in idle:
            self.assertEqual(client.response(1).status.code, OK)
        first.call(list_worlds=c.ListWorlds())
        each = (memory_kib(server) - before) / len(idle)
        print(f"{each:.1f} KiB for each session", file=sys.stderr)
        if not SANITIZED:
            self.assertLess(each, 32)


class Requests(Case):
    @contextlib.contextmanager
    def busy(self, admin, tick, organisms=100_000):
        """Occupies the simulation with one tick of a large world."""
        if tick == 1:
            admin.call(create_world=c.CreateWorld(name="large", seed=1, parameters=plain.assignments(
                population_size=organisms, scale_with_population=True, reference_population=50)))
        asked = admin.ask(run_until_tick=c.RunUntilTick(world="large", tick=tick))
        yield
        self.assertEqual(admin.response(asked).status.code, OK)

    def test_in_flight(self):
        server = self.serve()
        client, other = self.come(server), self.come(server)
        limit = client.welcome.limits.requests_in_flight_max
        ticks = iter(range(1, 1000))

        def codes(count):
            with self.busy(other, next(ticks)):
                client.socket.sendall(b"".join(frame(request(request_id=i + 1, list_worlds=c.ListWorlds()))
                                               for i in range(count)))
                return [client.response(i + 1).status.code for i in range(count)]
        self.assertEqual(codes(limit), [OK] * limit)
        with self.meets(other, "requests_in_flight_max"):
            plain.until(lambda: codes(limit + 1) == [OK] * limit + [EXHAUSTED], "one too many")
        client.call(list_worlds=c.ListWorlds())

    def test_an_address_has_half_of_the_mailbox(self):
        server = self.serve()
        admin = self.come(server)
        limits = admin.welcome.limits
        clients = [self.come(server) for _ in range(limits.mailbox_commands_max // limits.requests_in_flight_max + 1)]
        ticks = iter(range(1, 1000))

        def crowd():
            tick = next(ticks)
            bursts = [b"".join(frame(request(request_id=i + 1, client_key=f"{tick} {number}", pause=c.Pause()))
                               for i in range(limits.requests_in_flight_max)) for number in range(len(clients))]
            with self.busy(admin, tick, 500_000):
                for client, burst in zip(clients, bursts):
                    client.socket.sendall(burst)
                codes = [client.response(i + 1).status.code for client in clients
                         for i in range(limits.requests_in_flight_max)]
            self.assertLessEqual(set(codes), {OK, EXHAUSTED})
            # the command to the large world may still be in the mailbox
            self.assertGreaterEqual(codes.count(OK), limits.mailbox_commands_max // 2 - 1)
            return EXHAUSTED in codes
        with self.meets(admin, "mailbox_commands_max"):
            plain.until(crowd, "one too many")

    @unittest.skipIf(SANITIZED, "such a server reads no more than it may")
    def test_rate(self):
        server = self.serve()
        flooding, other = self.come(server), self.come(server)
        limits = other.welcome.limits
        frames = limits.requests_per_s_max + limits.request_burst_max
        damaged = b"EV\x01\x01\x03\0\0\0\xff\xff\xff"
        calls, faults, over = 0, [], threading.Event()

        def go_on():
            nonlocal calls
            try:
                while not over.is_set():
                    other.call(list_worlds=c.ListWorlds())
                    calls += 1
            except BaseException as fault:  # reported below by the main thread
                faults.append(fault)
        with self.meets(self.come(server), "requests_per_s_max", "request_burst_max"):
            began = time.monotonic()
            sender = threading.Thread(target=flooding.socket.sendall, args=(damaged * frames,))
            neighbour = threading.Thread(target=go_on)
            sender.start()
            neighbour.start()
            try:
                answers = 0
                while answers < frames:  # each frame is answered, and none refused for exceeding the rate
                    response = flooding.control().response
                    self.assertEqual((response.request_id, response.status.code), (0, INVALID))
                    answers += 1
                took = time.monotonic() - began
            finally:
                over.set()
                sender.join()
                neighbour.join()
        self.assertEqual(faults, [])
        self.assertGreater(took, 0.9)
        self.assertGreater(calls, 20)  # one at a time during 55,000 frames: they do not wait for all of these
        flooding.call(list_worlds=c.ListWorlds())

    def test_subscriptions_and_their_snapshots(self):
        server = self.serve()
        client, other = self.come(server), self.come(server)
        limits = client.welcome.limits
        with self.meets(other, "snapshot_rate_hz_max"):
            for asked, got in ((limits.snapshot_rate_hz_max, limits.snapshot_rate_hz_max),
                               (limits.snapshot_rate_hz_max + 1, limits.snapshot_rate_hz_max)):
                answer = client.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=asked)).subscription
                self.assertEqual(answer.rate_hz, got)
        for _ in range(limits.subscriptions_max - 2):
            last = client.call(subscribe_events=c.SubscribeEvents()).subscription
        with self.meets(other, "subscriptions_max"):
            client.call(EXHAUSTED, subscribe_events=c.SubscribeEvents())
            client.call(EXHAUSTED, subscribe_snapshots=c.SubscribeSnapshots(rate_hz=1))
        client.call(unsubscribe=c.Unsubscribe(subscription_id=last.subscription_id))
        client.call(subscribe_events=c.SubscribeEvents())
        other.call(subscribe_events=c.SubscribeEvents())

    def test_islands_that_a_session_watches(self):
        server = self.serve()
        client, other = self.come(server), self.come(server)
        client.call(create_world=c.CreateWorld(name="islands", parameters=plain.assignments(
            island_count=4096, population_size=2, food_count=1, poison_count=0)))
        most = client.welcome.limits.watched_islands_max // 4096
        for _ in range(most):
            last = client.call(subscribe_snapshots=c.SubscribeSnapshots(world="islands", rate_hz=0.01)).subscription
        with self.meets(other, "watched_islands_max"):
            client.call(EXHAUSTED, subscribe_snapshots=c.SubscribeSnapshots(world="islands", rate_hz=0.01))
            client.call(EXHAUSTED, subscribe_snapshots=c.SubscribeSnapshots(world="islands", rate_hz=0.01, island=1))
        client.call(unsubscribe=c.Unsubscribe(subscription_id=last.subscription_id))
        for island in range(10):
            client.call(subscribe_snapshots=c.SubscribeSnapshots(world="islands", rate_hz=0.01, island=island))

    def test_names(self):
        server = self.serve()
        client = self.come(server)
        limits = client.welcome.limits
        client.call(create_world=c.CreateWorld(name="n" * limits.world_name_bytes_max))
        with self.meets(client, "world_name_bytes_max"):
            client.call(INVALID, create_world=c.CreateWorld(name="n" * (limits.world_name_bytes_max + 1)))
            client.call(INVALID, fork_world=c.ForkWorld(name="n" * (limits.world_name_bytes_max + 1)))
        client.call(client_key="k" * limits.client_key_bytes_max, pause=c.Pause(world="default"))
        with self.meets(client, "client_key_bytes_max"):
            client.call(INVALID, client_key="k" * (limits.client_key_bytes_max + 1), pause=c.Pause(world="default"))


class Worlds(Case):
    def test_worlds_replays_and_planned_changes(self):
        server = self.serve("--replays-max", "6", "--worlds-max", "9")
        client, other = self.come(server), self.come(server)
        limits = client.welcome.limits
        self.assertEqual((limits.replays_max, limits.worlds_max), (6, 9))
        for _ in range(limits.replays_max // 2):
            client.call(open_replay=c.OpenReplay(world="default"))
        with self.meets(other, "replays_max"):
            client.call(EXHAUSTED, open_replay=c.OpenReplay(world="default"))
        self.come(server, come_from="127.0.0.2").call(open_replay=c.OpenReplay(world="default"))
        small = plain.assignments(population_size=1, food_count=0, poison_count=0)
        while len(client.call(list_worlds=c.ListWorlds()).worlds.worlds) < limits.worlds_max:
            client.call(create_world=c.CreateWorld(name=f"w{client.request_id}", parameters=small))
        for _ in range(limits.planned_changes_max):
            client.call(set_parameters=c.SetParameters(world="default", at_tick=10**9))
        with self.meets(other, "planned_changes_max"):
            client.call(EXHAUSTED, set_parameters=c.SetParameters(world="default", at_tick=10**9))
        with self.meets(other, "worlds_max"):
            client.call(EXHAUSTED, request_id=100_000, create_world=c.CreateWorld(name="one_more", parameters=small))
        client.call(delete_world=c.DeleteWorld(world="default"))
        # The same request again: a temporary refusal is not cached.
        client.call(request_id=100_000, create_world=c.CreateWorld(name="one_more", parameters=small))

    def test_history(self):
        server = self.serve()
        client = self.come(server)
        limits = client.welcome.limits
        self.world_of_short_generations(client, limits.history_generations_kept + 20, population_size=2)
        with self.meets(client, "history_generations_max", "history_generations_kept"):
            history = client.call(get_history=c.GetHistory(world="short")).history
        self.assertEqual(history.generations[0].generation, 21)
        self.assertEqual(len(history.generations), limits.history_generations_max)
        self.assertEqual(history.next_generation, 21 + limits.history_generations_max)
        kept = client.call(get_history=c.GetHistory(world="short", first_generation=21, last_generation=1020)).history
        self.assertEqual((len(kept.generations), kept.HasField("next_generation")), (1000, False))

    def test_exports(self):
        server = self.serve()
        client = self.come(server)
        self.world_of_short_generations(client, 300)
        limits = client.welcome.limits
        export = c.ExportRun(world="short", table=c.RUN_TABLE_ORGANISMS, format=c.TEXT_FORMAT_CSV)
        busy = [self.come(server) for _ in range(limits.exports_max // 2)]  # a user has at most half of them
        for one in busy:
            self.assertFalse(one.call(export_run=export).export_part.last)
        with self.meets(client, "exports_max"):
            client.call(EXHAUSTED, export_run=export)
        busy[0].socket.close()
        plain.until(lambda: client.response(client.ask(export_run=export)).status.code == OK, "one has ended")


class Unread(Case):
    def test_answers(self):
        def flood(_):
            with self.served_once() as server:
                other = self.come(server)
                with self.meets(other, "queued_response_bytes_max"), self.small(server) as silent:
                    many = frame(request(describe=c.Describe())) * 1000
                    with self.assertRaises((BrokenPipeError, ConnectionResetError)):
                        while True:
                            silent.socket.sendall(many)
                    plain.until(lambda: " closed: " in server.output(), "it is logged")
                    self.assertIn("does not read its answers", server.output())
        waiting.quicker_than(STALLED_S, flood)

    def test_events(self):
        def sleep(_):
            with self.served_once() as server:
                other, silent = self.come(server), self.small(server)
                silent.call(subscribe_events=c.SubscribeEvents())
                with self.meets(other, "queued_event_bytes_max"):
                    before = self.counts(other)["queued_event_bytes_max"]
                    self.world_of_short_generations(other, 500)
                    while self.counts(other)["queued_event_bytes_max"] == before:
                        self.run_short_generations(other, 500)
                    dropped = silent.next_event("events_dropped")
                    self.assertGreater(dropped.events_dropped.dropped_count, 0)
                silent.call(list_worlds=c.ListWorlds())
        waiting.quicker_than(STALLED_S, sleep)

    @unittest.skipIf(SLOW, "it takes minutes until so much waits")
    def test_the_memory_of_all_sessions_is_bounded(self):
        def wait(_):
            with self.served_once() as server:
                self.fill_the_buffers(server)  # with sessions of one user, who may use half of the memory
        waiting.quicker_than(STALLED_S, wait)

    def fill_the_buffers(self, server):
        other = self.come(server)
        limits = other.welcome.limits
        self.world_of_short_generations(other, 1100, island_count=1)
        asking = b"".join(frame(request(request_id=i + 1, get_history=c.GetHistory(world="short")))
                          for i in range(limits.requests_in_flight_max))
        modest = self.small(server)
        answer_bytes = len(modest.call(get_history=c.GetHistory(world="short")).SerializeToString())
        fits = limits.client_buffer_bytes_max // 2 // (answer_bytes * limits.requests_in_flight_max)
        modest.ask(get_history=c.GetHistory(world="short"))  # and does not read the answer
        with self.meets(other, "client_buffer_bytes_max"):
            for _ in range(fits - 2):
                self.small(server).socket.sendall(asking)
                other.call(list_worlds=c.ListWorlds())  # answered after the others
            self.assertNotIn("closed: the sessions of one user use more than", server.output())
            for _ in range(6):
                self.small(server).socket.sendall(asking)
            plain.until(lambda: "closed: the sessions of one user use more than" in server.output(), "one is closed")
        if not SANITIZED:  # sanitizers keep freed memory
            self.assertLess(memory_kib(server), (limits.client_buffer_bytes_max >> 10) + (100 << 10))
        closed = re.findall(r"closed: the sessions of one user use more than 128 MiB of memory, and this one uses "
                            r"(\d+) KiB", server.output())
        self.assertLess(len(closed), 10)
        self.assertGreater(min(map(int, closed)), 1024)
        self.assertEqual(modest.response(modest.request_id).status.code, OK)  # sessions with little memory continue


class Times(Case):
    def test_timeouts_and_stalled_clients(self):
        """Run in parallel, because each takes long."""
        certificates = pathlib.Path(self.folder) / "certificates"
        access.Tls.pair(self, "certificates")
        self.assertTrue(certificates.exists())
        server = self.serve("--sessions-max", "500")
        encrypted = access.Access.server(self, "--keep-nothing", *access.Tls.files(self))
        other = self.come(server)
        limits = other.welcome.limits
        other.call(create_world=c.CreateWorld(name="w", seed=1, parameters=plain.assignments(
            population_size=3000, scale_with_population=True, reference_population=50)))
        other.call(run=c.Run(world="w"))
        faults = []

        def part(of, *arguments):
            def run():
                try:
                    of(*arguments)
                except BaseException as fault:  # reported below by the main thread
                    faults.append((of.__name__, fault))
            thread = threading.Thread(target=run)
            thread.start()
            return thread
        with self.meets(other, "hello_timeout_s", "frame_timeout_s", "stalled_timeout_s", "export_patience_s"):
            parts = [part(self.no_hello, server, limits), part(self.frames_byte_by_byte, server, limits),
                     part(self.subscribers_that_never_read, server, limits), part(self.a_slow_one_stays, server),
                     part(self.one_of_tls_that_never_reads, encrypted), part(self.an_abandoned_export, server)]
            while any(thread.is_alive() for thread in parts):
                other.call(list_worlds=c.ListWorlds())
                parts[-1].join(0.05)
        self.assertEqual(faults, [])

    def no_hello(self, server, limits):
        began = time.monotonic()
        client = plain.Client(server, hello=False)
        self.closed_with_goodbye(client, PRECONDITION, "no Hello")
        self.assertGreater(time.monotonic() - began, limits.hello_timeout_s - 0.5)
        client.socket.close()

    def frames_byte_by_byte(self, server, limits):
        clients, idle = [self.come(server) for _ in range(50)], self.come(server)
        slow = frame(request(list_worlds=c.ListWorlds(), client_key="k" * 60))
        began, closed = time.monotonic(), []
        for sent, byte in enumerate(slow):
            for client in [x for x in clients if x not in closed]:
                try:
                    client.socket.sendall(bytes([byte]))
                except OSError:
                    closed.append(client)
            if len(closed) == len(clients):
                break
            time.sleep(1)
        self.assertEqual(len(closed), len(clients))
        self.assertGreater(time.monotonic() - began, limits.frame_timeout_s)
        # a byte per second; the server notices at the next byte but one
        self.assertLess(sent, limits.frame_timeout_s + 8)
        self.closed_with_goodbye(clients[0], PRECONDITION, "did not arrive")
        idle.call(list_worlds=c.ListWorlds())  # the time limit applies only to frames that have begun

    def subscribers_that_never_read(self, server, limits):
        before, most, deaf = memory_kib(server), 0, 100

        def all_are_closed():
            nonlocal most
            most = max(most, memory_kib(server) - before)
            return server.output().count("the client has received nothing") >= deaf
        with Attack(plain.messages_path, server.port, "deaf", deaf) as attack:
            plain.until(all_are_closed, "all are closed", pause_s=0.05)
            self.assertGreater(attack.end()["closed_after_s"][0], limits.stalled_timeout_s)
        if not SANITIZED:
            self.assertLess(most, deaf * 2048)

    def a_slow_one_stays(self, server):
        def read_slowly(lap):
            client = self.small(server)
            client.ask(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=60))
            end = time.monotonic() + STALLED_S + 4
            while time.monotonic() < end:
                self.assertTrue(waiting.receive(client.socket, 500))
                lap()
                time.sleep(0.25)
        waiting.quicker_than(STALLED_S, read_slowly)

    def one_of_tls_that_never_reads(self, server):
        client = self.come(server, tls=access.Tls.context(self))
        client.call(run=c.Run())
        for _ in range(30):
            client.ask(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=120))
        plain.until(lambda: "the client has received nothing" in server.output(), "it is closed")

    def an_abandoned_export(self, server):
        client = self.come(server)
        self.world_of_short_generations(client, 300)
        part = client.call(export_run=c.ExportRun(world="short", table=c.RUN_TABLE_ORGANISMS,
                                                  format=c.TEXT_FORMAT_CSV)).export_part
        self.assertFalse(part.last)
        # Nothing outside the server shows that the export is cancelled, so the test waits until it must be.
        began, patience_s = time.monotonic(), client.welcome.limits.export_patience_s
        plain.until(lambda: time.monotonic() - began > patience_s + 5, "the export's end", stalled_s=2 * patience_s)
        client.call(PRECONDITION, continue_export=c.ContinueExport(export_id=part.export_id))


def memory_kib(server):
    text = pathlib.Path(f"/proc/{server.process.pid}/smaps_rollup").read_text()
    return int(re.search(r"Pss_Anon: +(\d+)", text)[1])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
