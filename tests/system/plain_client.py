"""An independent client against a real server: everything that docs/PROTOCOL.md promises, abuse included.

Plain Python 3, protobuf and numpy, with message classes made by protoc, and the decoder of docs/PROTOCOL.md; nothing
else of this repository. Each class below is one subject, and one test of ctest:

    plain_client.py EVOD MESSAGES PROTOCOL.md [CLASS …]

No test waits for a fixed time. How long each waits for a condition is in waiting.py.
"""
import contextlib
import ctypes
import itertools
import math
import os
import re
import resource
import secrets
import select
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import types
import unittest

evod_path, messages_path, protocol_path = sys.argv[1:4]
sys.path.insert(0, messages_path)

import numpy  # noqa: E402
from google.protobuf import descriptor_pb2  # noqa: E402
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2 as w  # noqa: E402
from delta_decoder import KINDS, Decoder, TilesDecoder  # noqa: E402
import waiting  # noqa: E402
from waiting import until  # noqa: E402

OK, INVALID, NOT_FOUND, EXISTS, EXHAUSTED = 0, 3, 5, 6, 8
PRECONDITION, ABORTED, UNIMPLEMENTED, UNAVAILABLE = 9, 10, 12, 14


class Server:
    def __init__(self, *options, **popen):
        self.log, self.data = tempfile.TemporaryFile(), tempfile.TemporaryDirectory()
        self.process = subprocess.Popen([evod_path, "--port", "0", "--data", self.data.name, *options],
                                        stdout=self.log, stderr=self.log, **popen)
        line = until(lambda: self.process.poll() is not None or
                     re.search(r"listening on 127\.0\.0\.1:(\d+), world \"(\S+)\", seed (\d+)", self.output()), "ready")
        if line is True:
            raise AssertionError("evod ended at once:\n" + self.output())
        self.port, self.world, self.seed = int(line[1]), line[2], int(line[3])

    def output(self):
        return os.pread(self.log.fileno(), 1 << 24, 0).decode(errors="replace")

    def end(self, how=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(how)
        try:
            status = waiting.ended(self.process)
        finally:
            self.process.kill()
        if status != 0:
            raise AssertionError(f"evod ended with {status}:\n" + self.output())


class Client:
    def __init__(self, server, hello=True, key=None, come_from="127.0.0.1", over=None):
        """over: a connected socket to use."""
        self.key, self.request_id = key or secrets.token_hex(8), 0
        self.events, self.snapshots, self.responses = [], [], {}
        self.farewell = None  # the status of a Goodbye
        self.socket = over or self.connected(server, come_from)
        if hello:
            self.hello()
            greeting = self.control()
            while waiting.LATE_HELLO in greeting.goodbye.status.message:
                self.socket.close()
                self.socket = self.connected(server, come_from)
                self.hello()
                greeting = self.control()
            self.welcome = greeting.welcome

    @staticmethod
    def connected(server, come_from="127.0.0.1"):
        connection = socket.create_connection(("127.0.0.1", server.port), source_address=(come_from, 0))
        connection.settimeout(waiting.LONGEST_S)
        return connection

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def hello(self, **fields):
        self.send(session_pb2.ClientMessage(
            hello=session_pb2.Hello(**{"protocol_version": 1, "client_name": "plain", **fields})))

    def send(self, message):
        self.send_body(message.SerializeToString())

    def send_body(self, body):
        self.socket.sendall(b"EV\x01\x01" + struct.pack("<I", len(body)) + body)

    def read(self, count):
        data = bytearray()
        while len(data) < count:
            try:
                more = waiting.receive(self.socket, count - len(data))
            except ConnectionResetError:
                more = b""
            if not more:
                raise EOFError(f"closed after {len(data)} of {count} bytes")
            data += more
        return bytes(data)

    def frame(self):
        magic, version, channel, length = struct.unpack("<2sBBI", self.read(8))
        assert (magic, version) == (b"EV", 1)
        return channel, self.read(length)

    def control(self):
        """Returns the next control message and stores snapshots."""
        while True:
            channel, body = self.frame()
            if channel == 1:
                return session_pb2.ServerMessage.FromString(body)
            assert channel == 2
            self.snapshots.append(stream_pb2.SnapshotFrame.FromString(body))

    def step(self):
        """Reads one frame and stores it by its kind."""
        channel, body = self.frame()
        if channel == 2:
            self.snapshots.append(stream_pb2.SnapshotFrame.FromString(body))
            return
        message = session_pb2.ServerMessage.FromString(body)
        if message.HasField("event"):
            self.events.append(message.event)
        elif message.HasField("goodbye"):
            assert self.farewell is None, "said goodbye twice"
            self.farewell = message.goodbye.status
        else:
            assert message.HasField("response")
            response = message.response
            assert response.request_id == 0 or response.request_id not in self.responses, "answered twice"
            self.responses[response.request_id] = response

    def ask(self, **request):
        """Sends a request; returns its id."""
        if "request_id" not in request:
            self.request_id += 1
            request["request_id"] = self.request_id
        request.setdefault("client_key", self.key)
        self.send(session_pb2.ClientMessage(request=c.Request(**request)))
        return request["request_id"]

    def response(self, request_id):
        while request_id not in self.responses:
            self.step()
        return self.responses.pop(request_id)

    def goodbye(self):
        """The status of the server's Goodbye."""
        while self.farewell is None:
            self.step()
        return self.farewell

    def call(self, expected=OK, **request):
        response = self.response(self.ask(**request))
        assert response.status.code == expected, f"{request}: {response.status}"
        assert bool(response.status.message) == (expected != OK)
        return response

    def world(self, name=""):
        worlds = self.call(list_worlds=c.ListWorlds()).worlds.worlds
        return next(x for x in worlds if not name or x.name == name)

    def wait_world(self, condition, name=""):
        return until(lambda: (lambda x: x if condition(x) else None)(self.world(name)), "world in a state")

    def next_snapshot(self, condition=lambda snapshot: True):
        while True:
            while self.snapshots:
                snapshot = self.snapshots.pop(0)
                if condition(snapshot):
                    return snapshot
            self.step()

    def next_event(self, kind, condition=lambda event: True):
        while True:
            while self.events:
                event = self.events.pop(0)
                if event.WhichOneof("kind") == kind and condition(event):
                    return event
            self.step()

    def run_to(self, tick, world=""):
        self.call(run_until_tick=c.RunUntilTick(world=world, tick=tick))
        return self.wait_world(lambda x: x.tick == tick and x.state == w.RUN_STATE_PAUSED, world)

    def assert_closed(self):
        """Asserts that the server has closed the connection."""
        while True:
            try:
                self.step()
            except EOFError:
                return


def value(number_or_text):
    kind = {bool: "flag", int: "count", float: "real", str: "choice"}[type(number_or_text)]
    return w.ParameterValue(**{kind: number_or_text})


def assignments(**values):
    return [w.ParameterAssignment(name=name, value=value(x)) for name, x in values.items()]


def set_parameters(world="", dry_run=False, expected_revision=None, **values):
    return c.SetParameters(world=world, parameters=assignments(**values), dry_run=dry_run,
                           expected_revision=expected_revision)


def as_dict(parameter_set):
    return {p.name: p for p in parameter_set.parameters}


def columns(snapshot):
    """The entities of a snapshot of CODEC_PLAIN as numpy arrays: {"organisms": {"id": …, "x": …, …}, "food": …, …},
    px."""
    result = {}
    for kind, sizes in KINDS:
        of_kind = getattr(snapshot.plain, kind)
        fields = {field.name: numpy.array(getattr(of_kind, field.name), numpy.uint32 if field.name == "id" else float)
                  # no subscription asks for headings
                  for field in of_kind.DESCRIPTOR.fields if field.name != "heading"}
        assert {len(column) for column in fields.values()} == {getattr(snapshot, COUNTS[kind])}
        result[kind] = {name.removesuffix("_px"): column for name, column in fields.items()}
    return result


COUNTS = {"organisms": "organism_count", "food": "food_count", "poison": "poison_count", "crates": "crate_count",
          "obstacles": "obstacle_count"}
zstd = ctypes.CDLL("libzstd.so.1")
zstd.ZSTD_getFrameContentSize.restype, zstd.ZSTD_decompress.restype = ctypes.c_ulonglong, ctypes.c_size_t


def zstd_content(frame):
    content = ctypes.create_string_buffer(zstd.ZSTD_getFrameContentSize(frame, ctypes.c_size_t(len(frame))))
    size = zstd.ZSTD_decompress(content, ctypes.c_size_t(len(content)), frame, ctypes.c_size_t(len(frame)))
    assert size == len(content)
    return content.raw


def limit(name):
    """A limit of the server, as `evod limits` lists it."""
    return int(re.search(rf"^\| `{name}` \| (\d+) \|", waiting.run([evod_path, "limits"], capture_output=True,
                                                                     text=True).stdout, re.M)[1])


class WithServer(unittest.TestCase):
    options = ()

    @classmethod
    def setUpClass(cls):
        cls.server = Server(*cls.options)

    @classmethod
    def tearDownClass(cls):
        cls.server.end()
        assert "Sanitizer" not in cls.server.output(), cls.server.output()

    def setUp(self):
        self.client = self.enterContext(Client(self.server))

    def enterContext(self, context):  # as in Python 3.11's, for older ones
        result = context.__enter__()
        self.addCleanup(context.__exit__, None, None, None)
        return result

    def tearDown(self):
        with Client(self.server) as stranger:  # the server still works after the test
            stranger.call(list_worlds=c.ListWorlds())

    def new_world(self, name=None, seed=1, **parameters):
        name = name or "w" + secrets.token_hex(4)
        self.client.call(create_world=c.CreateWorld(name=name, seed=seed, parameters=assignments(**parameters)))
        self.addCleanup(self.delete_world, name)
        return name

    def delete_world(self, name):
        with Client(self.server) as client:
            client.call(delete_world=c.DeleteWorld(world=name))


class Handshake(WithServer):
    def refused(self, client, code, words):
        message = client.control()
        self.assertEqual(message.goodbye.status.code, code)
        self.assertIn(words, message.goodbye.status.message)
        client.assert_closed()
        return message.goodbye.status

    def raw(self, data):
        client = self.enterContext(Client(self.server, hello=False))
        client.socket.sendall(data)
        return client

    def test_welcome_identifies_the_server(self):
        welcome = self.client.welcome
        self.assertEqual(welcome.protocol_version, 1)
        self.assertRegex(welcome.server_version, r"^\d+\.\d+\.\d+$")
        self.assertRegex(welcome.instance_id, r"^[0-9a-f]{32}$")
        self.assertLessEqual({"codec:plain", "codec:delta", "compression:zstd", "acknowledgements", "view"},
                             set(welcome.features))
        for field, limit in welcome.limits.ListFields():
            self.assertGreater(limit, 0, field.name)
        self.assertEqual(len(welcome.limits.ListFields()), len(c.Limits.DESCRIPTOR.fields))

    def test_a_hello_may_come_byte_by_byte(self):
        client = self.enterContext(Client(self.server, hello=False))
        client.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        body = session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1)).SerializeToString()
        for byte in b"EV\x01\x01" + struct.pack("<I", len(body)) + body:
            client.socket.sendall(bytes([byte]))
        self.assertEqual(client.control().welcome.protocol_version, 1)

    def test_other_protocols_get_a_goodbye(self):
        self.refused(self.raw(b"GET / HTTP/1.1\r\nHost: evod\r\n\r\n"), INVALID, "'EV'")

    def test_a_wrong_framing_version_gets_a_goodbye(self):
        self.refused(self.raw(b"EV\x02\x01\0\0\0\0"), INVALID, "version 2")

    def test_a_wrong_channel_gets_a_goodbye(self):
        self.refused(self.raw(b"EV\x01\x02\0\0\0\0"), INVALID, "channel 2")
        self.refused(self.raw(b"EV\x01\x09\0\0\0\0"), INVALID, "channel 9")

    def test_requests_before_a_damaged_frame_are_answered(self):
        world = self.new_world(population_size=20)
        for _ in range(20):
            client = self.enterContext(Client(self.server))
            requests = [dict(run=c.Run(world=world)), dict(get_statistics=c.GetStatistics(world=world)),
                        dict(pause=c.Pause(world=world))]
            messages = [session_pb2.ClientMessage(request=c.Request(request_id=id, client_key="damaged", **request))
                        for id, request in enumerate(requests, 1)]
            client.socket.sendall(b"".join(b"EV\x01\x01" + struct.pack("<I", m.ByteSize()) + m.SerializeToString()
                                           for m in messages) + b"no frame")
            for id in range(1, len(requests) + 1):
                self.assertEqual(client.response(id).status.code, 0)
            self.refused(client, INVALID, "'EV'")

    def test_a_long_first_frame_is_refused_by_its_header_alone(self):
        self.refused(self.raw(b"EV\x01\x01" + struct.pack("<I", 4097)), INVALID, "4096")
        self.refused(self.raw(b"EV\x01\x01" + struct.pack("<I", 0xffffffff)), INVALID, "4096")

    def test_a_request_before_the_hello_is_refused(self):
        client = self.enterContext(Client(self.server, hello=False))
        client.ask(list_worlds=c.ListWorlds())
        self.refused(client, PRECONDITION, "Hello")

    def test_an_empty_first_message_is_refused(self):
        self.refused(self.raw(b"EV\x01\x01\0\0\0\0"), PRECONDITION, "Hello")

    def test_another_protocol_version_is_refused(self):
        client = self.enterContext(Client(self.server, hello=False))
        client.hello(protocol_version=2)
        status = self.refused(client, PRECONDITION, "version")
        self.assertEqual([(v.field, v.allowed, v.got) for v in status.violations],
                         [("hello.protocol_version", "1", "2")])

    def test_a_range_of_versions_is_welcome(self):
        client = self.enterContext(Client(self.server, hello=False))
        client.hello(protocol_version=1, protocol_version_max=7, features=["none that exists"])
        self.assertEqual(client.control().welcome.protocol_version, 1)

    def test_frames_respect_the_clients_size_limit(self):
        small = self.enterContext(Client(self.server, hello=False))
        small.hello(frame_bytes_max=65535)
        status = self.refused(small, INVALID, "frame_bytes_max")
        self.assertEqual([v.field for v in status.violations], ["hello.frame_bytes_max"])
        client = self.enterContext(Client(self.server, hello=False))
        client.hello(frame_bytes_max=65536)
        self.assertTrue(client.control().HasField("welcome"))
        world = self.new_world(population_size=2000, island_width_px=6000.0, island_height_px=6000.0)
        refused = client.call(EXHAUSTED, get_population=c.GetPopulation(world=world))
        self.assertIn("the client accepts only 65536", refused.status.message)
        self.assertEqual(refused.status.reason, c.REASON_ANSWER_TOO_LARGE)
        client.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=60))
        large = self.new_world(population_size=20_000, island_width_px=20_000.0, island_height_px=20_000.0)
        client.call(subscribe_snapshots=c.SubscribeSnapshots(world=large, rate_hz=60))
        self.assertEqual(client.next_snapshot().world, world)
        self.client.call(run_until_tick=c.RunUntilTick(world=large, tick=5))
        self.client.wait_world(lambda x: x.tick == 5, large)
        self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=5))
        client.next_snapshot(lambda p: p.world == world and p.tick == 5)
        self.assertEqual([p for p in client.snapshots if p.world == large], [])
        client.call(list_worlds=c.ListWorlds())  # the session continues

    def test_long_names_are_refused_each(self):
        client = self.enterContext(Client(self.server, hello=False))
        client.hello(client_name="n" * 65, client_version="v" * 65)
        status = self.refused(client, INVALID, "2 fields")
        self.assertEqual({v.field for v in status.violations}, {"hello.client_name", "hello.client_version"})

    def test_a_second_hello_is_refused_and_the_session_lives(self):
        self.client.hello()
        response = self.client.control().response
        self.assertEqual((response.request_id, response.status.code), (0, PRECONDITION))
        self.client.call(list_worlds=c.ListWorlds())

    def test_a_silent_connection_is_closed_in_time(self):
        began = time.monotonic()
        client = self.enterContext(Client(self.server, hello=False))
        self.refused(client, PRECONDITION, "no Hello")
        self.assertGreater(time.monotonic() - began, self.client.welcome.limits.hello_timeout_s - 0.5)

    def test_one_session_too_many_gets_a_goodbye(self):
        limit = self.client.welcome.limits.sessions_max
        with contextlib.ExitStack() as stack:
            sessions = [stack.enter_context(Client(self.server)) for _ in range(limit // 2 - 1)]
            neighbour = stack.enter_context(Client(self.server, hello=False))
            neighbour.hello()
            self.refused(neighbour, EXHAUSTED, "from this address")
            sessions[0].call(list_worlds=c.ListWorlds())
            sessions[0].socket.close()
            until(lambda: self.admitted(), "a place is free again")

    def test_an_incomplete_frame_ends_its_session(self):
        client, patient = self.enterContext(Client(self.server)), self.enterContext(Client(self.server))
        began = time.monotonic()
        client.socket.sendall(b"EV\x01\x01\x08\x00\x00\x00")  # a header without its body
        message = client.control()
        self.assertEqual(message.goodbye.status.code, PRECONDITION)
        self.assertIn("did not arrive", message.goodbye.status.message)
        client.assert_closed()
        self.assertGreater(time.monotonic() - began, self.client.welcome.limits.frame_timeout_s - 0.5)
        patient.call(list_worlds=c.ListWorlds())  # an idle session may stay

    def test_a_dense_sequence_of_frames_is_not_late(self):
        body = session_pb2.ClientMessage(request=c.Request(request_id=1,
                                                           list_worlds=c.ListWorlds())).SerializeToString()
        frame = b"EV\x01\x01" + struct.pack("<I", len(body)) + body
        limit_s = self.client.welcome.limits.frame_timeout_s

        def go_on(lap):
            with Client(self.server) as client:
                client.socket.sendall(frame[:5])
                end = time.monotonic() + limit_s + 1
                while time.monotonic() < end:  # a frame is incomplete at every moment
                    client.socket.sendall(frame[5:] + frame[:5])
                    client.response(1)
                    lap()
        waiting.quicker_than(limit_s, go_on)

    def admitted(self):
        with Client(self.server, hello=False) as client:
            client.hello()
            return client.control().HasField("welcome")


class Requests(WithServer):
    def test_an_unknown_request_does_not_end_the_session(self):
        body = session_pb2.ClientMessage(request=c.Request(request_id=7, client_key="k")).SerializeToString()
        unknown = b"\xfa\x3e\x02\x08\x01"  # field 1007, two bytes
        inner = c.Request(request_id=7, client_key="k").SerializeToString() + unknown
        self.client.send_body(b"\x12" + bytes([len(inner)]) + inner)
        self.assertEqual(self.client.response(7).status.code, UNIMPLEMENTED)
        self.client.send_body(body)  # without a request
        self.assertEqual(self.client.response(7).status.code, UNIMPLEMENTED)
        self.client.send_body(unknown)  # an unknown message
        self.assertEqual(self.client.response(0).status.code, UNIMPLEMENTED)
        self.client.call(list_worlds=c.ListWorlds())

    def test_refusals_have_a_reason_for_programs(self):
        world = self.new_world(generation_limit=1)
        nowhere = "no_such_world"
        for reason, request in (
                ("FIELD_INVALID", {"run": c.Run(world=world, generations=0)}),
                ("FIELD_INVALID", {"reset_world": c.ResetWorld()}),
                ("WORLD_NOT_FOUND", {"pause": c.Pause(world=nowhere)}),
                ("WORLD_NOT_FOUND", {"get_parameters": c.GetParameters(world=nowhere)}),
                ("WORLD_EXISTS", {"create_world": c.CreateWorld(name=world)}),
                ("NOTHING_TO_RESUME", {"resume": c.Resume(world=world)}),
                ("REVISION_CHANGED", {"set_parameters": set_parameters(world, expected_revision=99, food_health=1.0)}),
                ("PLANNED_CHANGE_NOT_FOUND", {"cancel_change": c.CancelChange(world=world, id=5)}),
                ("NO_LEASE", {"renew_lease": c.RenewLease(world=world)}),
                ("ISLAND_NOT_FOUND", {"get_motion": c.GetMotion(world=world, island=9)}),
                ("ORGANISM_NOT_FOUND", {"get_organism": c.GetOrganism(world=world, organism=10**6)}),
                ("WORLD_IS_LIVE", {"seek": c.Seek(world=world, to=c.RunMoment(tick=1))}),
                ("SUBSCRIPTION_NOT_FOUND", {"unsubscribe": c.Unsubscribe(subscription_id=77)}),
                ("EXPORT_NOT_FOUND", {"continue_export": c.ContinueExport(export_id=3)})):
            status = self.client.response(self.client.ask(**request)).status
            self.assertEqual(c.Reason.Name(status.reason), "REASON_" + reason, status)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world))
        self.client.wait_world(lambda x: x.state == w.RUN_STATE_TERMINATED, world)
        status = self.client.call(PRECONDITION, run=c.Run(world=world)).status
        self.assertEqual(status.reason, c.REASON_RUN_ENDED)
        self.client.send_body(b"\xff\xff\xff")
        self.assertEqual(self.client.response(0).status.reason, c.REASON_MESSAGE_UNREADABLE)

    def test_an_unknown_field_refuses_a_command_and_no_query(self):
        world = self.new_world()
        unknown = b"\xfa\x3e\x02\x08\x01"  # field 1007, two bytes
        pause = c.Pause(world=world).SerializeToString() + unknown
        head = c.Request(request_id=7, client_key="k").SerializeToString()
        inner = head + b"\x7a" + bytes([len(pause)]) + pause  # 15: pause
        self.client.send_body(b"\x12" + bytes([len(inner)]) + inner)
        status = self.client.response(7).status
        self.assertEqual((status.code, [v.field for v in status.violations]), (UNIMPLEMENTED, ["pause.1007"]))
        query = c.Request(request_id=8, list_worlds=c.ListWorlds()).SerializeToString() + unknown
        self.client.send_body(b"\x12" + bytes([len(query)]) + query)
        self.assertEqual(self.client.response(8).status.code, OK)

    def test_an_invalid_body_does_not_end_the_session(self):
        for body in (b"\xff\xff\xff", b"\x12\x7f", os.urandom(100), b"\x12\x06\x12\x04\xff\xfe\xfd\xfc"):
            self.client.send_body(body)
            self.client.responses.clear()
            self.assertIn(self.client.response(0).status.code, (INVALID, UNIMPLEMENTED))
        self.client.call(list_worlds=c.ListWorlds())
        self.assertNotIn("libprotobuf", self.server.output())  # otherwise clients could fill the log

    def test_a_frame_too_long_gets_a_goodbye(self):
        self.client.socket.sendall(b"EV\x01\x01" + struct.pack("<I", (1 << 20) + 1))
        status = self.client.goodbye()
        self.assertEqual(status.code, INVALID)
        self.assertIn("1048576", status.message)
        self.client.assert_closed()

    def test_a_stream_out_of_step_gets_a_goodbye(self):
        self.client.send(session_pb2.ClientMessage(request=c.Request(request_id=1, list_worlds=c.ListWorlds())))
        self.client.socket.sendall(b"xx" * 100)
        self.assertEqual(self.client.response(1).status.code, OK)
        self.assertEqual(self.client.goodbye().code, INVALID)
        self.client.assert_closed()

    def test_noise_never_ends_the_server(self):
        for seed in range(50):
            noise = numpy.random.default_rng(seed).bytes(2000)
            with Client(self.server, hello=seed % 2 == 0) as client:
                with contextlib.suppress(OSError):
                    client.socket.sendall((b"EV\x01\x01" if seed % 4 > 1 else b"") + noise)
                    client.socket.shutdown(socket.SHUT_WR)
                client.assert_closed()

    def test_half_a_frame_and_gone(self):
        for cut in (1, 5, 8, 9):
            with Client(self.server) as client:
                client.socket.sendall((b"EV\x01\x01" + struct.pack("<I", 100) + b"x" * 50)[:cut])

    def test_request_ids_begin_at_1(self):
        status = self.client.call(INVALID, request_id=0, list_worlds=c.ListWorlds()).status
        self.assertEqual(status.violations[0].field, "request_id")

    def test_commands_need_a_client_key(self):
        for key in ("", "k" * 65):
            status = self.client.call(INVALID, client_key=key, pause=c.Pause()).status
            self.assertEqual([v.field for v in status.violations], ["client_key"])
        self.client.call(client_key="", list_worlds=c.ListWorlds())

    def test_every_request_sent_ahead_is_answered_once(self):
        ids = [self.client.ask(list_worlds=c.ListWorlds()) for _ in range(500)]
        codes = [self.client.response(i).status.code for i in ids]
        self.assertEqual(set(codes) - {OK, EXHAUSTED}, set())
        self.assertGreaterEqual(codes.count(OK), self.client.welcome.limits.requests_in_flight_max)
        self.client.call(list_worlds=c.ListWorlds())

    def test_requests_are_answered_in_order(self):
        ids = [self.client.ask(run_until_tick=c.RunUntilTick(tick=0)) for _ in range(20)]
        order = []
        while len(order) < len(ids):
            order.append(self.client.control().response.request_id)
        self.assertEqual(order, ids)

    def test_a_half_closed_client_still_gets_its_answers(self):
        ids = [self.client.ask(get_parameters=c.GetParameters()) for _ in range(20)]
        self.client.socket.shutdown(socket.SHUT_WR)
        for i in ids:
            self.assertEqual(self.client.response(i).status.code, OK)
        self.client.assert_closed()

    @unittest.skipIf(os.environ.get("SANITIZED"), "such a server is too slow to have as many answers waiting in time")
    def test_a_client_that_reads_no_answers_is_closed(self):
        one = session_pb2.ClientMessage(request=c.Request(request_id=1, describe=c.Describe())).SerializeToString()
        frame = b"EV\x01\x01" + struct.pack("<I", len(one)) + one

        def flood(_):
            logged = len(self.server.output())
            with Client(self.server) as silent, self.assertRaises((BrokenPipeError, ConnectionResetError)):
                while True:
                    silent.socket.sendall(frame * 1000)
            until(lambda: " closed: " in self.server.output()[logged:], "it is logged")
            self.assertIn("does not read its answers", self.server.output()[logged:])
        waiting.quicker_than(self.client.welcome.limits.stalled_timeout_s, flood)

    def test_describe_has_messages_parameters_and_limits(self):
        description = self.client.call(describe=c.Describe()).description
        files = descriptor_pb2.FileDescriptorSet.FromString(description.file_descriptor_set)
        names = [f.name for f in files.file]
        self.assertEqual(sorted(names), ["evod/v1/commands.proto", "evod/v1/session.proto", "evod/v1/stream.proto",
                                         "evod/v1/world.proto", "google/protobuf/descriptor.proto"])
        for index, file in enumerate(files.file):  # a file after its imports
            self.assertLessEqual(set(file.dependency), set(names[:index]))
        self.assertEqual(description.limits, self.client.welcome.limits)
        self.assertGreater(len(description.parameters), 60)
        for p in description.parameters:
            self.assertTrue(p.name and p.help and p.kind and p.effect, p.name)

    def test_an_unknown_world_is_not_found_by_any_request(self):
        for field in c.Request.DESCRIPTOR.oneofs_by_name["kind"].fields:
            kind = getattr(c, field.message_type.name)
            if "world" not in kind.DESCRIPTOR.fields_by_name:
                continue
            extra = {"set_speed": {"speed": w.Speed(max=True)}, "subscribe_snapshots": {"rate_hz": 1},
                     "place": {"items": [c.PlacedItem(kind=c.ITEM_KIND_FOOD, x_px=640, y_px=360)]},
                     "remove": {"food": [0]}, "set_fitness": {"fitness": [0]}, "fork_world": {"name": "new"},
                     "seek": {"to": c.RunMoment(tick=1)},
                     "export_run": {"table": c.RUN_TABLE_EVENTS, "format": c.TEXT_FORMAT_CSV}}
            for world in ("nowhere", "no\nwhere", "ü" * 1000):
                request = {field.name: kind(world=world, **extra.get(field.name, {}))}
                status = self.client.call(NOT_FOUND, **request).status
                self.assertEqual([v.field for v in status.violations], [field.name + ".world"])


class Commands(WithServer):
    def test_worlds_are_created_and_deleted_or_refused(self):
        world = self.client.call(create_world=c.CreateWorld(
            name="a_World-1", seed=5, parameters=assignments(population_size=7))).world
        self.assertEqual((world.name, world.seed, world.tick, world.generation, world.state),
                         ("a_World-1", 5, 0, 1, w.RUN_STATE_WAITING))
        self.assertRegex(world.run_id, r"^[0-9a-f]{32}$")
        self.assertRegex(world.state_hash, r"^[0-9a-f]{32}$")
        self.client.call(EXISTS, create_world=c.CreateWorld(name="a_World-1"))
        for name in ("", "a b", "ä", "a/b", "x" * 65, "a\n"):
            status = self.client.call(INVALID, create_world=c.CreateWorld(name=name)).status
            self.assertEqual([v.field for v in status.violations], ["create_world.name"])
        status = self.client.call(INVALID, create_world=c.CreateWorld(
            name="", parameters=assignments(mutation_chance=2.0, food_count=-0.5))).status
        self.assertEqual({v.field for v in status.violations},
                         {"create_world.name", "create_world.mutation_chance", "create_world.food_count"})
        status = self.client.call(INVALID, delete_world=c.DeleteWorld()).status
        self.assertEqual([v.field for v in status.violations], ["delete_world.world"])
        answer = self.client.call(delete_world=c.DeleteWorld(world="a_World-1"))
        self.assertIsNone(answer.WhichOneof("answer"))
        self.client.call(NOT_FOUND, delete_world=c.DeleteWorld(world="a_World-1"))

    def test_an_absent_seed_is_drawn_and_0_is_a_seed(self):
        a, b, zero = self.new_world(seed=None), self.new_world(seed=None), self.new_world(seed=0)
        self.assertNotEqual(self.client.world(a).seed, self.client.world(b).seed)
        self.assertEqual(self.client.world(zero).seed, 0)

    def test_no_more_worlds_than_the_limit(self):
        for _ in range(self.client.welcome.limits.worlds_max - 1):
            self.new_world(population_size=1, food_count=0, poison_count=0)
        self.client.call(EXHAUSTED, create_world=c.CreateWorld(name="one_more"))

    def test_an_empty_name_is_the_only_world_or_the_default_one(self):
        self.assertEqual(self.client.call(pause=c.Pause()).world.name, "default")
        self.new_world()
        self.assertEqual(self.client.call(pause=c.Pause()).world.name, "default")

    def test_run_pause_resume_step(self):
        world = self.new_world(generation_s=0.5)  # 30 ticks
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(PRECONDITION, resume=c.Resume(world=world))
        answer = self.client.call(run=c.Run(world=world, generations=2))
        self.assertEqual((answer.applied_tick, answer.world.state), (0, w.RUN_STATE_RUNNING))
        self.assertEqual(answer.world.run_until_generation, 3)
        ended = self.client.wait_world(lambda x: x.state == w.RUN_STATE_WAITING, world)
        self.assertEqual((ended.tick, ended.generation, ended.HasField("run_until_generation")), (60, 2, False))
        self.assertAlmostEqual(ended.simulated_s, 1, places=9)

        self.client.call(run=c.Run(world=world))
        self.client.wait_world(lambda x: x.tick > 100, world)
        paused = self.client.call(pause=c.Pause(world=world)).world
        self.assertEqual(paused.state, w.RUN_STATE_PAUSED)
        self.assertEqual(self.client.world(world).state_hash, paused.state_hash)
        stepped = self.client.run_to(paused.tick + 7, world)
        self.assertEqual(stepped.tick, paused.tick + 7)
        again = self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=3)).world  # reached long ago
        self.assertEqual((again.state, again.tick), (w.RUN_STATE_PAUSED, stepped.tick))
        self.assertEqual(self.client.call(resume=c.Resume(world=world)).world.state, w.RUN_STATE_RUNNING)
        self.client.wait_world(lambda x: x.tick > stepped.tick, world)

        status = self.client.call(INVALID, run=c.Run(world=world, generations=0)).status
        self.assertEqual([v.field for v in status.violations], ["run.generations"])

    def test_a_run_can_be_as_long_as_the_numbers_go(self):
        world = self.new_world()
        for generations in (1 << 40, (1 << 64) - 1):
            answer = self.client.call(run=c.Run(world=world, generations=generations)).world
            self.assertEqual(answer.state, w.RUN_STATE_RUNNING)
            self.assertGreater(answer.run_until_generation, 1)
        answer = self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=(1 << 64) - 1)).world
        self.assertEqual(answer.run_until_tick, (1 << 64) - 1)

    def test_speed(self):
        world = self.new_world()
        for factor in (0.001, 1.5, 10000.0):
            answer = self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=factor)))
            self.assertEqual(answer.world.speed.real_time_factor, factor)
        self.assertTrue(self.client.call(
            set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True))).world.speed.max)
        for factor in (0.0, -1.0, 0.0009, 10001.0, math.nan, math.inf, -math.inf):
            status = self.client.call(
                INVALID, set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=factor))).status
            self.assertEqual([(v.field, v.allowed) for v in status.violations],
                             [("set_speed.speed.real_time_factor", "0.001 to 10000")])
        self.client.call(INVALID, set_speed=c.SetSpeed(world=world))
        self.client.call(INVALID, set_speed=c.SetSpeed(world=world, speed=w.Speed()))
        self.client.call(INVALID, set_speed=c.SetSpeed(world=world, speed=w.Speed(max=False)))
        self.assertTrue(self.client.world(world).speed.max)

    def test_a_paced_world_keeps_its_pace_beside_a_fast_one(self):
        busy, paced = self.new_world(), self.new_world()
        self.client.call(set_speed=c.SetSpeed(world=busy, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=busy))
        self.client.call(run=c.Run(world=paced))
        began, first = time.monotonic(), self.client.world(paced).tick
        self.client.wait_world(lambda x: x.tick >= first + 90, paced)
        self.assertGreater(time.monotonic() - began, 1.3)  # 90 ticks take at least 1.5 s
        self.assertGreater(self.client.world(busy).tick, 1)
        self.client.wait_world(lambda x: abs(x.ticks_per_s - 60) < 45, paced)  # unless the machine stalls

    def test_only_the_same_seed_gives_the_same_hashes(self):
        world = self.new_world(seed=42, generation_s=2)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        first = [self.client.run_to(t, world).state_hash for t in (1, 100, 333)]
        before = self.client.world(world)
        reset = self.client.call(reset_world=c.ResetWorld(world=world)).world
        self.assertEqual((reset.tick, reset.generation, reset.seed, reset.state), (0, 1, 42, w.RUN_STATE_WAITING))
        self.assertNotEqual(reset.run_id, before.run_id)
        self.assertTrue(reset.speed.max)
        self.assertEqual([self.client.run_to(t, world).state_hash for t in (1, 100, 333)], first)
        self.client.call(reset_world=c.ResetWorld(world=world, seed=43))
        self.assertNotEqual(self.client.run_to(333, world).state_hash, first[-1])
        self.assertEqual(self.client.world(world).seed, 43)

    def test_viewers_and_speed_change_nothing(self):
        parameters = {"generation_s": 2}
        watched, alone = self.new_world(seed=9, **parameters), self.new_world(seed=9, **parameters)
        viewer = self.enterContext(Client(self.server))
        viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=watched, rate_hz=120))
        viewer.call(subscribe_events=c.SubscribeEvents())
        self.client.call(set_speed=c.SetSpeed(world=watched, speed=w.Speed(real_time_factor=20)))
        self.client.call(set_speed=c.SetSpeed(world=alone, speed=w.Speed(max=True)))
        for world in (watched, alone):
            self.client.run_to(77, world)
            self.client.call(set_parameters=set_parameters(world, food_health=60.0, mutation_chance=0.5))
            self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=400))
        hashes = {self.client.wait_world(lambda x: x.tick == 400, world).state_hash for world in (watched, alone)}
        self.assertEqual(len(hashes), 1)

    def test_a_run_that_has_ended_says_so(self):
        world = self.new_world(fitness="gene_sum", generation_limit=3)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world))
        ended = self.client.wait_world(lambda x: x.state == w.RUN_STATE_TERMINATED, world)
        self.assertEqual((ended.generation, ended.outcome), (3, w.OUTCOME_GENERATION_LIMIT))
        for request in ({"run": c.Run(world=world)}, {"resume": c.Resume(world=world)},
                        {"run_until_tick": c.RunUntilTick(world=world, tick=1 << 30)}):
            status = self.client.call(PRECONDITION, **request).status
            self.assertIn("generation_limit", status.message)
        self.client.call(set_parameters=set_parameters(world, generation_limit=5))  # and it continues
        self.client.wait_world(lambda x: x.state == w.RUN_STATE_TERMINATED and x.generation == 5, world)


class Control(WithServer):
    """Several controllers of one world: none blocks the others, and all see the same order of events."""
    OF_SERVER = w.ACTOR_KIND_SERVER

    def setUp(self):
        super().setUp()
        self.other = self.enterContext(Client(self.server))
        self.other.call(subscribe_events=c.SubscribeEvents())
        self.name = self.new_world()
        self.client.call(set_speed=c.SetSpeed(world=self.name, speed=w.Speed(real_time_factor=50)))
        self.client.call(run=c.Run(world=self.name))

    def borrow(self):
        """Steps the running world by half a second. Returns its tick."""
        tick = self.client.world(self.name).tick + 1500
        lent = self.client.call(run_until_tick=c.RunUntilTick(world=self.name, tick=tick))
        self.assertTrue(lent.world.leased)
        return max(tick, lent.applied_tick)  # it may have been there before the command arrived

    def wait_standing(self, tick):
        def stands(world):
            self.assertLessEqual(world.tick, tick, "the lease has ended and the world went on")
            return world.tick == tick and world.state == w.RUN_STATE_PAUSED
        return self.client.wait_world(stands, self.name)

    def while_lent(self, attempt):
        """The result of attempt(), which must finish within a lease."""
        return waiting.quicker_than(self.client.welcome.limits.lease_s, attempt)

    def next_control(self, kind, condition=lambda world: True):
        event = self.other.next_event("run_control_changed",
                                      lambda e: e.run_control_changed.by.kind == kind and e.world == self.name and
                                      condition(e.run_control_changed.world))
        return event.run_control_changed.world

    def renew(self, expected=OK, client=None):
        return (client or self.client).call(expected, renew_lease=c.RenewLease(world=self.name))

    def test_a_lease_expires_and_the_world_continues(self):
        def stand(_):
            tick = self.borrow()
            self.assertTrue(self.wait_standing(tick).leased)
            return tick
        tick = self.while_lent(stand)
        gone_on = self.next_control(self.OF_SERVER)
        self.assertEqual((gone_on.leased, gone_on.state), (False, w.RUN_STATE_RUNNING))
        self.client.wait_world(lambda x: x.tick > tick, self.name)
        self.assertIn("lease", self.renew(PRECONDITION).status.message)

    def test_a_lease_lasts_as_long_as_it_is_renewed(self):
        lease_s = self.client.welcome.limits.lease_s

        def go_on(lap):
            tick, end = self.borrow(), time.monotonic() + 1.5 * lease_s
            while time.monotonic() < end:
                self.renew()
                lap()
                time.sleep(lease_s / 20)
            self.assertEqual(self.wait_standing(tick).tick, tick)
        self.while_lent(go_on)

    def test_a_lease_ends_with_its_client(self):
        with Client(self.server) as brief:
            tick = brief.call(run_until_tick=c.RunUntilTick(world=self.name, tick=0)).applied_tick
        self.next_control(self.OF_SERVER)
        self.client.wait_world(lambda x: x.tick > tick, self.name)

    def test_a_lease_can_be_given_back(self):
        def give_back(_):
            tick = self.borrow()
            self.wait_standing(tick)
            back = self.client.call(release_lease=c.ReleaseLease(world=self.name)).world
            self.assertEqual((back.leased, back.state, back.tick), (False, w.RUN_STATE_RUNNING, tick))
        self.while_lent(give_back)
        self.renew(PRECONDITION)
        again = self.client.call(release_lease=c.ReleaseLease(world=self.name)).world
        self.assertEqual(again.state, w.RUN_STATE_RUNNING)

    def test_a_goal_in_generations_is_still_there_after_a_lease(self):
        self.client.call(run=c.Run(world=self.name, generations=1 << 40))
        goal = self.client.world(self.name).run_until_generation
        self.borrow()
        back = self.client.call(release_lease=c.ReleaseLease(world=self.name)).world
        self.assertEqual((back.run_until_generation, back.HasField("run_until_tick")), (goal, False))

    def test_another_clients_command_ends_the_lease(self):
        for request, state in (({"pause": c.Pause(world=self.name)}, w.RUN_STATE_PAUSED),
                               ({"resume": c.Resume(world=self.name)}, w.RUN_STATE_RUNNING),
                               ({"run": c.Run(world=self.name)}, w.RUN_STATE_RUNNING)):
            self.client.call(run=c.Run(world=self.name))
            self.borrow()
            answer = self.other.call(**request).world
            self.assertEqual((answer.leased, answer.state), (False, state))
            self.renew(PRECONDITION)

    def test_another_client_that_steps_takes_the_lease(self):
        def take_over(_):
            self.borrow()
            self.assertTrue(self.other.call(run_until_tick=c.RunUntilTick(world=self.name, tick=0)).world.leased)
            self.renew(client=self.other)
        self.while_lent(take_over)
        self.renew(PRECONDITION)

    def test_a_world_paused_before_stays_paused(self):
        paused = self.client.call(pause=c.Pause(world=self.name)).world
        self.assertFalse(self.client.run_to(paused.tick + 5, self.name).leased)
        self.renew(PRECONDITION)

    def test_all_see_one_order_of_two_controllers(self):
        rounds, clients = 200, [self.client, self.other]
        listeners = [self.enterContext(Client(self.server)) for _ in range(2)]
        for listener in listeners:
            listener.call(subscribe_events=c.SubscribeEvents(world=self.name))
        first = self.client.world(self.name).parameter_revision
        asked = [[(client, client.ask(set_parameters=set_parameters(self.name, food_health=float(1 + 2 * i + j))))
                  for j, client in enumerate(clients)] for i in range(rounds // 20)]
        answers = [client.response(request) for pairs in asked for client, request in pairs]
        for i in range(rounds // 20, rounds):
            asked = [(client, client.ask(set_parameters=set_parameters(self.name, food_health=1 + i / 8 + j / 16)))
                     for j, client in enumerate(clients)]
            answers += [client.response(request) for client, request in asked]
        by_revision = {answer.parameters.revision: answer for answer in answers}
        self.assertEqual(sorted(by_revision), list(range(first + 1, first + 1 + 2 * rounds)))
        seen = [[listener.next_event("parameters_changed") for _ in range(2 * rounds)] for listener in listeners]
        self.assertEqual(seen[0], seen[1])
        addresses = {f"127.0.0.1:{client.socket.getsockname()[1]}" for client in clients}
        self.assertEqual({event.parameters_changed.by.address for event in seen[0]}, addresses)
        for event, revision in zip(seen[0], sorted(by_revision)):
            changed, answer = event.parameters_changed, by_revision[revision]
            self.assertEqual((changed.revision, event.tick), (revision, answer.applied_tick))
            self.assertEqual(changed.changed[0].value, as_dict(answer.parameters)["food_health"].value)
        self.assertEqual([e.tick for e in seen[0]], sorted(e.tick for e in seen[0]))

    def test_a_world_too_fast_for_the_machine_is_slowed(self):
        world = self.new_world("crowd" + secrets.token_hex(4), population_size=2000, scale_with_population=True)
        self.client.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=60))
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=10000)))
        self.client.call(run=c.Run(world=world))
        self.assertFalse(self.client.next_snapshot().slowed)
        slowed = self.client.next_snapshot(lambda snapshot: snapshot.slowed)
        self.assertTrue(self.client.world(world).slowed)
        self.client.next_snapshot(lambda snapshot: snapshot.tick > slowed.tick)  # it continues
        paused = self.client.call(pause=c.Pause(world=world)).world
        self.assertFalse(self.client.world(world).slowed)
        # No tick was skipped: an unhurried run gives the same result.
        twin = self.new_world(population_size=2000, scale_with_population=True)
        self.client.call(set_speed=c.SetSpeed(world=twin, speed=w.Speed(max=True)))
        self.assertEqual(self.client.run_to(paused.tick, twin).state_hash, paused.state_hash)


class Parameters(WithServer):
    def setUp(self):
        super().setUp()
        self.registry = self.client.call(describe=c.Describe()).description.parameters
        self.world = self.new_world()

    def get(self):
        return self.client.call(get_parameters=c.GetParameters(world=self.world)).parameters

    def refused(self, **values):
        """The field paths of a refusal; asserts that nothing has changed."""
        before = self.get()
        status = self.client.call(INVALID, set_parameters=set_parameters(self.world, **values)).status
        self.assertEqual(self.get(), before)
        for v in status.violations:
            self.assertTrue(v.field and v.allowed and v.got, v)
        return {v.field for v in status.violations}

    def test_a_new_world_has_the_defaults_of_the_registry(self):
        parameters = self.get()
        self.assertEqual([p.name for p in parameters.parameters], [p.name for p in self.registry])
        for p, description in zip(parameters.parameters, self.registry):
            self.assertEqual(p.value, description.default_value, p.name)
            self.assertFalse(p.HasField("pending"), p.name)

    def test_every_parameter_refuses_invalid_values(self):
        for p in self.registry:
            wrong = {w.PARAMETER_KIND_REAL: [math.nan, math.inf, -math.inf, math.nextafter(p.max, math.inf),
                                             math.nextafter(p.min, -math.inf), True, "much"],
                     w.PARAMETER_KIND_COUNT: [1.0, False, "many"] + ([int(p.max) + 1] if p.max < 0xffffffff else [])
                                             + ([int(p.min) - 1] if p.min > 0 else []),
                     w.PARAMETER_KIND_FLAG: [1, 1.0, "true"],
                     w.PARAMETER_KIND_CHOICE: [0, "", "nothing", p.choices[0].upper() if p.choices else "",
                                               True]}[p.kind]
            for x in wrong:
                self.assertEqual(self.refused(**{p.name: x}), {"set_parameters." + p.name}, x)

    def test_all_or_nothing_and_every_fault_is_named(self):
        self.assertEqual(
            self.refused(food_health=30.0, mutation_chance=1.5, selection="best", mutate_chance=0.1, tick_s=math.nan),
            {"set_parameters." + n for n in ("mutation_chance", "selection", "mutate_chance", "tick_s")})

    def test_a_missing_value_and_a_repeated_name_are_faults(self):
        bad = c.SetParameters(world=self.world, parameters=[
            w.ParameterAssignment(name="mutation_step"), w.ParameterAssignment(name="elite_count",
                                                                               value=w.ParameterValue()),
            *assignments(mutation_chance=7.0)])
        status = self.client.call(INVALID, set_parameters=bad).status
        self.assertEqual({v.field for v in status.violations},
                         {"set_parameters." + n for n in ("mutation_step", "elite_count", "mutation_chance")})
        twice = c.SetParameters(world=self.world, parameters=assignments(food_health=1.0) +
                                assignments(food_health=2.0))
        self.assertEqual(self.client.call(INVALID, set_parameters=twice).status.violations[0].got, "given twice")

    def test_values_that_do_not_go_together_are_refused(self):
        self.assertEqual(self.refused(initial_gene_min=200.0), {"set_parameters.initial_gene_max"})

    def test_a_misspelt_name_is_answered_with_the_right_one(self):
        status = self.client.call(INVALID, set_parameters=set_parameters(self.world, mutation_chanse=0.1)).status
        self.assertIn("mutation_chance", status.violations[0].allowed)

    def test_a_hundred_thousand_assignments_are_refused_quickly(self):
        many = c.SetParameters(world=self.world, parameters=[w.ParameterAssignment(name="x")] * 100_000)
        status = self.client.call(INVALID, set_parameters=many).status
        self.assertEqual([v.field for v in status.violations], ["set_parameters.parameters"])

    def test_current_and_pending_values_are_shown(self):
        answer = self.client.call(set_parameters=set_parameters(
            self.world, food_health=31.0, population_size=60, island_count=2, steering_lookahead_s=1))
        self.assertEqual(answer.applied_tick, 0)
        now = as_dict(answer.parameters)
        self.assertEqual(len(now), len(self.registry))
        self.assertEqual((now["food_health"].value.real, now["food_health"].HasField("pending")), (31, False))
        self.assertEqual(now["steering_lookahead_s"].value.real, 1)  # a whole number is accepted for a real
        self.assertEqual((now["population_size"].value.count, now["population_size"].pending.count), (50, 60))
        self.assertEqual((now["island_count"].value.count, now["island_count"].pending.count), (1, 2))
        self.assertEqual(answer.parameters, self.get())
        self.assertEqual(self.client.call(reset_world=c.ResetWorld(world=self.world)).world.island_count, 2)
        after = as_dict(self.get())
        self.assertEqual((after["population_size"].value.count, after["population_size"].HasField("pending")),
                         (60, False))

    def test_a_dry_run_answers_and_changes_nothing(self):
        before = self.get()
        answer = self.client.call(set_parameters=set_parameters(self.world, dry_run=True, food_health=99.0))
        self.assertEqual(as_dict(answer.parameters)["food_health"].value.real, 99)
        self.assertEqual(self.get(), before)
        self.client.call(INVALID, set_parameters=set_parameters(self.world, dry_run=True, food_health=-1.0))

    def test_compare_and_set(self):
        revision = self.get().revision
        answer = self.client.call(set_parameters=set_parameters(self.world, expected_revision=revision,
                                                                food_health=1.0))
        self.assertGreater(answer.parameters.revision, revision)
        status = self.client.call(ABORTED, set_parameters=set_parameters(
            self.world, expected_revision=revision, food_health=2.0)).status
        self.assertEqual([(v.field, v.allowed, v.got) for v in status.violations],
                         [("set_parameters.expected_revision", str(answer.parameters.revision), str(revision))])
        self.client.call(ABORTED, set_parameters=set_parameters(self.world, expected_revision=0, food_health=2.0))
        self.assertEqual(as_dict(self.get())["food_health"].value.real, 1)


class Resending(WithServer):
    def again(self, client, request):
        client.send(session_pb2.ClientMessage(request=request))
        return client.response(request.request_id)

    def test_the_first_answer_is_repeated_on_any_session(self):
        request = c.Request(request_id=1, client_key="retry-create", create_world=c.CreateWorld(name="once"))
        first = self.again(self.client, request)
        self.assertEqual(first.status.code, OK)
        self.assertEqual(self.again(self.client, request), first)
        with Client(self.server) as other:
            other.call(run_until_tick=c.RunUntilTick(world="once", tick=3))
            self.assertEqual(self.again(other, request), first)
        self.client.call(delete_world=c.DeleteWorld(world="once"))
        self.assertEqual(self.again(self.client, request), first)
        self.client.call(NOT_FOUND, get_parameters=c.GetParameters(world="once"))

    def test_a_refusal_by_the_world_is_kept_too(self):
        world = self.new_world()
        request = c.Request(request_id=1, client_key="retry-resume", resume=c.Resume(world=world))
        first = self.again(self.client, request)
        self.assertEqual(first.status.code, PRECONDITION)
        self.client.call(run=c.Run(world=world))
        self.assertEqual(self.again(self.client, request), first)

    def test_an_invalid_request_may_be_corrected_with_its_id(self):
        world = self.new_world()
        self.client.call(INVALID, request_id=900, run=c.Run(world=world, generations=0))
        self.client.call(request_id=900, run=c.Run(world=world, generations=1))

    def test_an_id_serves_one_request(self):
        self.client.call(request_id=5, client_key="retry-different", run_until_tick=c.RunUntilTick(tick=0))
        status = self.client.call(INVALID, request_id=5, client_key="retry-different",
                                  run_until_tick=c.RunUntilTick(tick=1)).status
        self.assertEqual([v.field for v in status.violations], ["request_id"])
        self.client.call(request_id=5, client_key="retry-other-key", pause=c.Pause())

    def test_one_too_old_is_refused_and_not_run_again(self):
        kept = self.client.welcome.limits.retries_kept
        world = self.new_world()
        old = c.Request(request_id=1, client_key="retry-old", run=c.Run(world=world))
        self.again(self.client, old)
        self.again(self.client, c.Request(request_id=2, client_key="retry-old", pause=c.Pause(world=world)))
        for i in range(3, kept + 3):
            self.again(self.client, c.Request(request_id=i, client_key="retry-old",
                                              run_until_tick=c.RunUntilTick(world=world, tick=0)))
        answer = self.again(self.client, old)
        self.assertEqual(answer.status.code, PRECONDITION)
        self.assertEqual(self.client.world(world).state, w.RUN_STATE_PAUSED)
        newest = c.Request(request_id=kept + 2, client_key="retry-old",
                           run_until_tick=c.RunUntilTick(world=world, tick=0))
        self.assertEqual(self.again(self.client, newest).status.code, OK)

    def test_a_reconnecting_client_gets_its_answer(self):
        request = c.Request(request_id=1, client_key="retry-gone", create_world=c.CreateWorld(name="gone"))
        with Client(self.server) as hasty:
            hasty.send(session_pb2.ClientMessage(request=request))
        self.assertEqual(self.again(self.client, request).status.code, OK)
        self.client.call(delete_world=c.DeleteWorld(world="gone"))


class Events(WithServer):
    def setUp(self):
        super().setUp()
        self.watcher = self.enterContext(Client(self.server))

    def subscribe(self, world=None):
        return self.watcher.call(subscribe_events=c.SubscribeEvents(world=world)).subscription.subscription_id

    def test_subscribers_get_commands_with_their_actor(self):
        self.subscribe()
        world = self.new_world(seed=3)
        event = self.watcher.next_event("world_created")
        self.assertEqual((event.world, event.world_created.world.seed), (world, 3))
        by = event.world_created.by
        self.assertEqual((by.kind, by.user, by.client), (w.ACTOR_KIND_CLIENT, "", "plain"))
        self.assertRegex(by.address, r"^127\.0\.0\.1:\d+$")
        self.client.call(set_parameters=set_parameters(world, food_health=5.0, population_size=9))
        changed = self.watcher.next_event("parameters_changed").parameters_changed
        self.assertEqual([(p.name, p.HasField("pending")) for p in changed.changed],
                         [("food_health", False), ("population_size", True)])
        self.assertEqual(changed.revision, self.client.world(world).parameter_revision)
        for request in ({"run": c.Run(world=world)}, {"pause": c.Pause(world=world)}, {"resume": c.Resume(world=world)},
                        {"set_speed": c.SetSpeed(world=world, speed=w.Speed(max=True))}):
            answer = self.client.call(**request)
            event = self.watcher.next_event("run_control_changed")
            self.assertEqual(event.run_control_changed.world, answer.world)
            self.assertEqual((event.tick, event.run_id), (answer.applied_tick, answer.world.run_id))
        reset = self.client.call(reset_world=c.ResetWorld(world=world)).world
        self.assertEqual(self.watcher.next_event("world_reset").world_reset.world.run_id, reset.run_id)
        self.client.call(set_parameters=set_parameters(world, dry_run=True, food_health=6.0))  # causes no event
        self.client.call(create_world=c.CreateWorld(name="brief"))
        self.client.call(delete_world=c.DeleteWorld(world="brief"))
        following = [self.watcher.next_event(kind) for kind in ("world_created", "world_deleted")]
        self.assertEqual({e.world for e in following}, {"brief"})

    def test_a_subscription_to_one_world_hears_of_that_alone(self):
        mine, other = self.new_world(), self.new_world()
        self.subscribe(mine)
        self.client.call(pause=c.Pause(world=other))
        self.client.call(pause=c.Pause(world=mine))
        self.watcher.next_event("run_control_changed")
        self.client.call(run=c.Run(world=mine))
        self.watcher.next_event("run_control_changed")
        self.assertEqual([e.world for e in self.watcher.events], [])

    def test_a_reached_goal_causes_an_event(self):
        world = self.new_world()
        self.subscribe(world)
        self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=5))
        event = self.watcher.next_event("run_control_changed",
                                        lambda e: e.run_control_changed.by.kind == w.ACTOR_KIND_GOAL)
        self.assertEqual((event.tick, event.run_control_changed.world.state), (5, w.RUN_STATE_PAUSED))

    def test_generations_migrations_and_the_end_of_a_run(self):
        world = self.new_world(fitness="gene_sum", island_count=3, migration="ring", migration_epoch=2, migrant_count=2,
                               generation_limit=5)
        self.subscribe(world)
        self.client.call(run=c.Run(world=world))
        kinds = []
        while "run_terminated" not in kinds:
            self.watcher.step()
            while self.watcher.events:
                event = self.watcher.events.pop(0)
                kinds.append(event.WhichOneof("kind"))
                if kinds[-1] == "generation_finished":
                    statistics = event.generation_finished.statistics
                    self.assertEqual([s.island for s in statistics], [0, 1, 2])
                    self.assertEqual(len(statistics[0].genes), 6)
                if kinds[-1] == "migration":
                    self.assertEqual([(e.from_island, e.to_island, e.migrant_count) for e in event.migration.edges],
                                     [(2, 0, 2), (0, 1, 2), (1, 2, 2)])
        self.assertEqual(kinds.count("generation_finished"), 5)
        self.assertEqual(kinds.count("migration"), 2)
        self.assertEqual(event.run_terminated.outcome, w.OUTCOME_GENERATION_LIMIT)
        history = self.client.call(get_history=c.GetHistory(world=world)).history
        self.assertEqual([(s.generation, s.island) for s in history.generations],
                         list(itertools.product(range(1, 6), range(3))))

    def test_an_extinction_causes_an_event(self):
        world = self.new_world(food_count=0, poison_count=0, generation_s=600)
        self.subscribe(world)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world, generations=1))
        extinction = self.watcher.next_event("extinction")
        self.assertEqual((extinction.extinction.island, extinction.extinction.generation), (0, 1))
        finished = self.watcher.next_event("generation_finished").generation_finished.statistics[0]
        self.assertEqual((finished.alive_count, finished.starved_count), (0, 50))

    def test_the_answer_comes_before_its_event(self):
        self.subscribe()
        request_id = self.watcher.ask(pause=c.Pause())
        self.watcher.response(request_id)
        self.assertEqual(self.watcher.events, [])
        self.watcher.next_event("run_control_changed")

    def test_no_more_events_after_unsubscribing(self):
        subscription = self.subscribe()
        self.watcher.call(unsubscribe=c.Unsubscribe(subscription_id=subscription))
        status = self.watcher.call(NOT_FOUND, unsubscribe=c.Unsubscribe(subscription_id=subscription)).status
        self.assertEqual([v.field for v in status.violations], ["unsubscribe.subscription_id"])
        self.client.call(pause=c.Pause())
        self.watcher.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.watcher.events, [])


class Snapshots(WithServer):
    def setUp(self):
        super().setUp()
        self.viewer = self.enterContext(Client(self.server))

    def subscribe(self, world, rate_hz=100.0, island=None):
        return self.viewer.call(subscribe_snapshots=c.SubscribeSnapshots(
            world=world, rate_hz=rate_hz, island=island)).subscription

    def test_a_snapshot_shows_the_world_as_it_is(self):
        world = self.new_world(seed=11, obstacle_count=3, crate_count=2, obstacle_size_px=50, crate_size_px=30)
        self.client.run_to(50, world)
        subscription = self.subscribe(world)
        snapshot = self.viewer.next_snapshot()
        info = self.client.world(world)
        for field in ("tick", "generation", "generation_tick", "simulated_s", "state"):
            self.assertEqual(getattr(snapshot, field), getattr(info, field), field)
        self.assertEqual((snapshot.state_hash.hex(), snapshot.run_id.hex()), (info.state_hash, info.run_id))
        self.assertEqual((snapshot.world, snapshot.island, snapshot.island_count), (world, 0, 1))
        self.assertEqual((snapshot.width_px, snapshot.height_px, snapshot.item_radius_px), (1280, 720, 4))
        self.assertEqual((snapshot.codec, snapshot.subscription_id),
                         (stream_pb2.CODEC_PLAIN, subscription.subscription_id))
        live = self.client.call(get_statistics=c.GetStatistics(world=world)).statistics.live[0]
        self.assertEqual(snapshot.live, live)
        self.assertEqual(snapshot.organism_count, live.alive_count)
        self.assertEqual((snapshot.crate_count, snapshot.obstacle_count), (2, 3))
        self.assertLessEqual(snapshot.food_count, 25)
        seen = columns(snapshot)
        self.assertEqual(set(seen["obstacles"]["half_width"]), {25.0})
        self.assertEqual(set(seen["crates"]["half_height"]), {15.0})
        for kind in ("organisms", "food", "poison"):
            self.assertTrue((numpy.diff(seen[kind]["id"].astype(int)) > 0).all())
            self.assertTrue((seen[kind]["x"] <= 1280).all() and (seen[kind]["y"] <= 720).all())
        organisms = seen["organisms"]
        for row, organism in enumerate(organisms["id"]):
            answer = self.client.call(get_organism=c.GetOrganism(world=world, organism=int(organism))).organism
            self.assertTrue(answer.alive)
            self.assertLessEqual(abs(answer.x_px - organisms["x"][row]), 1 / 32)
            self.assertLessEqual(abs(answer.y_px - organisms["y"][row]), 1 / 32)
            self.assertLessEqual(abs(answer.radius_px - organisms["radius"][row]), 1 / 32)
            self.assertLessEqual(abs(answer.health - organisms["health"][row]), 1 / 32)
            self.assertAlmostEqual(answer.lived_s, 50 / 60)
            self.assertAlmostEqual(answer.radius_px, answer.genes[2] * 0.1, places=4)

    def test_snapshots_end_with_the_last_tick(self):
        world = self.new_world()
        began = time.monotonic()
        self.subscribe(world, 30.0)
        self.assertEqual(self.viewer.next_snapshot().tick, 0)
        self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=40))
        ticks, snapshot = [], None
        while snapshot is None or snapshot.tick < 40:
            snapshot = self.viewer.next_snapshot()
            ticks.append(snapshot.tick)
        self.assertEqual(ticks, sorted(ticks))
        # At 30 Hz with a few extra snapshots: 40 ticks take 2/3 s, so about 20 are shown.
        self.assertLess(len(ticks), 30 * (time.monotonic() - began) + 8)
        self.assertEqual((snapshot.state, snapshot.state_hash.hex()),
                         (w.RUN_STATE_PAUSED, self.client.world(world).state_hash))
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])  # the world is idle

    def test_a_new_viewer_sees_a_paused_world(self):
        world = self.new_world()
        self.subscribe(world)
        self.viewer.next_snapshot()
        with Client(self.server) as newcomer:
            newcomer.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=1))
            self.assertEqual(newcomer.next_snapshot().tick, 0)

    def test_changes_are_shown_at_once_however_low_the_rate(self):
        world = self.new_world()
        self.subscribe(world, 0.001)
        self.viewer.next_snapshot()
        for request in ({"run_until_tick": c.RunUntilTick(world=world, tick=3)},
                        {"reset_world": c.ResetWorld(world=world)},
                        {"set_speed": c.SetSpeed(world=world, speed=w.Speed(max=True))}):
            answer = self.client.call(**request).world
            self.viewer.next_snapshot(lambda p: p.run_id.hex() == answer.run_id and p.speed == answer.speed)
        self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=9))
        self.viewer.next_snapshot(lambda p: p.tick == 9 and p.state == w.RUN_STATE_PAUSED)

    def test_islands_alone_and_together(self):
        world = self.new_world(island_count=3)
        everyone, one = self.subscribe(world), self.subscribe(world, island=2)
        self.assertEqual((everyone.subscription_id, one.subscription_id), (1, 2))
        seen = {}
        while len(seen) < 4:
            snapshot = self.viewer.next_snapshot()
            seen[snapshot.subscription_id, snapshot.island] = snapshot
        self.assertEqual(set(seen), {(1, 0), (1, 1), (1, 2), (2, 2)})
        self.assertEqual(seen[1, 2].plain, seen[2, 2].plain)
        status = self.viewer.call(NOT_FOUND, subscribe_snapshots=c.SubscribeSnapshots(
            world=world, rate_hz=1, island=3)).status
        self.assertEqual([(v.field, v.allowed, v.got) for v in status.violations],
                         [("subscribe_snapshots.island", "0 to 2", "3")])

    def test_rates(self):
        world = self.new_world()
        self.assertEqual(self.subscribe(world, 1e6).rate_hz, self.viewer.welcome.limits.snapshot_rate_hz_max)
        for rate in (0.0, -1.0, math.nan, math.inf):
            status = self.viewer.call(INVALID, subscribe_snapshots=c.SubscribeSnapshots(world=world,
                                                                                        rate_hz=rate)).status
            self.assertEqual([v.field for v in status.violations], ["subscribe_snapshots.rate_hz"])

    def test_no_more_subscriptions_than_the_limit(self):
        world = self.new_world()
        limit = self.viewer.welcome.limits.subscriptions_max
        ids = [self.subscribe(world).subscription_id for _ in range(limit)]
        self.viewer.call(EXHAUSTED, subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=1))
        self.viewer.call(EXHAUSTED, subscribe_events=c.SubscribeEvents())
        self.viewer.call(unsubscribe=c.Unsubscribe(subscription_id=ids[0]))
        self.viewer.call(subscribe_events=c.SubscribeEvents())

    def test_a_fitness_of_genes_alone_has_empty_snapshots(self):
        world = self.new_world(fitness="rastrigin")
        self.subscribe(world)
        snapshot = self.viewer.next_snapshot()
        self.assertEqual((snapshot.organism_count, len(snapshot.plain.organisms.id)), (0, 0))
        self.assertGreater(snapshot.width_px, 0)

    def test_a_wide_island_has_wide_positions(self):
        world = self.new_world(island_width_px=5000.0)
        self.subscribe(world)
        snapshot = self.viewer.next_snapshot()
        self.assertGreater(columns(snapshot)["food"]["x"].max(), 1280)

    def test_a_slow_viewer_gets_the_newest_and_a_drop_count(self):
        world = self.new_world(food_count=50_000, island_width_px=4000.0, island_height_px=4000.0)  # 400 KB each
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))

        def watch_slowly(_):
            with Client(self.server) as viewer, Client(self.server) as reader:
                for one in (viewer, reader):
                    one.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=120))
                self.client.call(run=c.Run(world=world))
                for _ in range(20):  # 8 MB, more than fits between the programs
                    reader.next_snapshot()
                paused = self.client.call(pause=c.Pause(world=world)).world
                newest = reader.next_snapshot(lambda p: p.tick == paused.tick)
                snapshot = viewer.next_snapshot(lambda p: p.tick == paused.tick)
            self.assertGreater(snapshot.dropped_count, 0)
            self.assertEqual(snapshot.plain, newest.plain)
        waiting.quicker_than(self.client.welcome.limits.stalled_timeout_s, watch_slowly)

    def test_a_viewer_that_dies_in_mid_snapshot_leaves_no_trace(self):
        world = self.new_world(food_count=50_000, island_width_px=4000.0, island_height_px=4000.0)
        self.client.call(run=c.Run(world=world))
        for _ in range(5):
            with Client(self.server) as viewer:
                viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=120))
                viewer.read(100)
        now = self.client.world(world).tick
        self.client.wait_world(lambda x: x.tick > now, world)


class Deltas(WithServer):
    """CODEC_DELTA. Every delta received is decoded, so its base must be the snapshot sent before it."""

    def setUp(self):
        super().setUp()
        self.viewer = self.enterContext(Client(self.server))
        self.decoders = {}

    def subscribe(self, world, codec=stream_pb2.CODEC_DELTA, rate_hz=120.0, **fields):
        return self.viewer.call(subscribe_snapshots=c.SubscribeSnapshots(
            world=world, codec=codec, rate_hz=rate_hz, **fields)).subscription.subscription_id

    def acknowledge(self, snapshot):
        self.viewer.send(session_pb2.ClientMessage(acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
            subscription_id=snapshot.subscription_id, island=snapshot.island, sequence=snapshot.sequence)))

    def next(self, condition=lambda snapshot: True):
        """The next snapshot that fulfils the condition, and its entities. Earlier ones are decoded, too."""
        while True:
            snapshot = self.viewer.next_snapshot()
            self.assertGreater(snapshot.sequence, 0)
            if snapshot.codec == stream_pb2.CODEC_PLAIN:
                seen = columns(snapshot)
            else:
                decoder = self.decoders.setdefault((snapshot.subscription_id, snapshot.island), Decoder(zstd_content))
                seen = {kind: {field: column if field in ("id", "dx", "dy") else column / 16
                               for field, column in fields.items()} for kind,
                        fields in decoder.decode(snapshot).items()}
            if condition(snapshot):
                return snapshot, seen

    def assert_same(self, seen, expected):
        for kind, fields in expected.items():
            for field, column in fields.items():
                numpy.testing.assert_array_equal(seen[kind][field], column, f"{kind} {field}")

    def compare(self, world, generations):
        """Views the world with every codec at once until all have shown many equal ticks."""
        kinds = {self.subscribe(world, stream_pb2.CODEC_PLAIN): "plain", self.subscribe(world): "delta",
                 self.subscribe(world, compression=stream_pb2.COMPRESSION_ZSTD): "zstd"}
        self.client.call(run=c.Run(world=world))
        shown, alike, deltas, last_generation = {}, 0, 0, 0
        while alike < 100 or deltas < 100 or last_generation < generations:
            snapshot, seen = self.next()
            deltas += snapshot.base_sequence > 0
            if snapshot.base_sequence > 0:
                self.assertEqual((snapshot.world, snapshot.run_id, snapshot.width_px), ("", b"", 0))
            of_hash = shown.setdefault((snapshot.state_hash, snapshot.island), {})
            of_hash[kinds[snapshot.subscription_id]] = seen
            if len(of_hash) == 3:
                self.assert_same(of_hash["delta"], of_hash["plain"])
                self.assert_same(of_hash["zstd"], of_hash["plain"])
                shown.pop((snapshot.state_hash, snapshot.island))
                alike += 1
                last_generation = snapshot.generation

    def test_they_equal_plain_snapshots(self):
        world = self.new_world(seed=3, obstacle_count=3, crate_count=4, obstacle_size_px=50, crate_size_px=30,
                               island_count=2, generation_s=2)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=4)))
        self.compare(world, 3)

    def test_they_show_wide_islands(self):
        self.compare(self.new_world(island_width_px=5000.0, crate_count=4), 1)

    def test_deltas_omit_constant_fields(self):
        world = self.new_world()
        self.subscribe(world)
        self.client.run_to(30, world)
        info = self.client.world(world)
        snapshot, _ = self.next(lambda p: p.tick == 30)
        for field in ("tick", "generation", "generation_tick", "simulated_s"):
            self.assertEqual(getattr(snapshot, field), getattr(info, field), field)
        self.assertEqual(snapshot.state_hash.hex(), info.state_hash)

    def test_every_viewer_gets_keyframes_now_and_then(self):
        world = self.new_world()
        self.subscribe(world)
        self.client.call(run=c.Run(world=world))
        before, snapshot = None, self.next()[0]
        # A snapshot caused by time only: none was dropped before it, and the generation is the same.
        while not before or snapshot.base_sequence > 0 or before.base_sequence == 0 or (
                snapshot.dropped_count, snapshot.generation) != (before.dropped_count, before.generation):
            before, snapshot = snapshot, self.next()[0]
        self.assertEqual(snapshot.world, world)

    def test_islands_and_worlds_that_are_gone_are_not_sent(self):
        world = self.new_world(island_count=3)
        self.subscribe(world)
        for _ in range(3):
            self.next()
        self.client.call(set_parameters=set_parameters(world, island_count=1))
        run = self.client.call(reset_world=c.ResetWorld(world=world)).world.run_id
        keyframe, _ = self.next(lambda p: p.base_sequence == 0 and p.run_id.hex() == run)
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=keyframe.subscription_id))
        again, _ = self.next()
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(([again.island, again.run_id.hex()], self.viewer.snapshots), ([0, run], []))
        self.client.call(delete_world=c.DeleteWorld(world=world))
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=keyframe.subscription_id))
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])
        self.client.call(create_world=c.CreateWorld(name=world))  # for the end of the test
        self.next(lambda p: p.base_sequence == 0)

    def test_a_new_viewer_costs_the_others_nothing(self):
        world = self.new_world()
        self.viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=0.01,
                                                                  codec=stream_pb2.CODEC_DELTA))
        self.next()
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world))
        with Client(self.server) as restless:
            for _ in range(50):
                subscription = restless.call(subscribe_snapshots=c.SubscribeSnapshots(
                    world=world, rate_hz=0.01, codec=stream_pb2.CODEC_DELTA)).subscription
                self.assertEqual(restless.next_snapshot().base_sequence, 0)
                restless.call(unsubscribe=c.Unsubscribe(subscription_id=subscription.subscription_id))
                restless.snapshots.clear()
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertLess(len(self.viewer.snapshots), 5)  # only those of the commands, none for the new viewer

    def test_a_new_run_begins_with_a_keyframe(self):
        world = self.new_world()
        self.subscribe(world)
        self.client.call(run=c.Run(world=world))
        self.next(lambda p: p.base_sequence > 0)
        again = self.client.call(reset_world=c.ResetWorld(world=world)).world
        snapshot, _ = self.next(lambda p: p.generation_tick == 0 and p.base_sequence == 0)
        self.assertEqual(snapshot.run_id.hex(), again.run_id)

    def test_a_requested_keyframe_comes_from_a_paused_world(self):
        world = self.new_world()
        self.client.run_to(20, world)
        subscription = self.subscribe(world)
        first, seen = self.next()
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription))
        again, seen_again = self.next()
        self.assertEqual((again.base_sequence, again.sequence, again.body), (0, first.sequence, first.body))
        self.assert_same(seen_again, seen)
        status = self.viewer.call(NOT_FOUND, request_keyframe=c.RequestKeyframe(subscription_id=99)).status
        self.assertEqual([v.field for v in status.violations], ["request_keyframe.subscription_id"])

    def test_a_keyframe_follows_a_damaged_snapshot(self):
        world = self.new_world()
        subscription = self.subscribe(world)
        self.client.call(run=c.Run(world=world))
        snapshot, _ = self.next(lambda p: p.base_sequence > 0)
        decoder = self.decoders[subscription, 0]
        damaged = self.viewer.next_snapshot(lambda p: p.base_sequence > 0)
        damaged.body = bytes([damaged.body[0] ^ 1]) + damaged.body[1:]
        with self.assertRaisesRegex(ValueError, "damaged|not the last"):
            decoder.decode(damaged)
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription))
        keyframe = self.viewer.next_snapshot(lambda p: p.base_sequence == 0)  # deltas are discarded meanwhile
        decoder.decode(keyframe)
        self.next(lambda p: p.base_sequence > 0)

    def test_the_newest_snapshot_waits_for_acknowledgements(self):
        world = self.new_world()
        subscription = self.subscribe(world, unacknowledged_max=2)
        self.client.call(run=c.Run(world=world))
        first, second = self.next()[0], self.next()[0]
        with Client(self.server) as other:
            other.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=120))
            other.next_snapshot(lambda p: p.tick > second.tick + 60)
            paused = self.client.call(pause=c.Pause(world=world)).world
            other.next_snapshot(lambda p: p.tick == paused.tick)
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])  # two are unacknowledged
        self.acknowledge(first)
        newest, _ = self.next()
        self.assertEqual((newest.tick, newest.base_sequence), (paused.tick, 0))
        self.assertGreater(newest.dropped_count, 0)
        self.acknowledge(newest)
        self.client.call(run=c.Run(world=world))
        for _ in range(20):
            snapshot, _ = self.next()
            self.acknowledge(snapshot)
        self.viewer.send(session_pb2.ClientMessage(acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
            subscription_id=subscription + 1, island=7, sequence=1)))  # is ignored

    def test_plain_snapshots_can_be_acknowledged_too(self):
        world = self.new_world()
        self.subscribe(world, stream_pb2.CODEC_PLAIN, unacknowledged_max=1)
        self.client.call(run=c.Run(world=world))
        last = 0
        for _ in range(10):
            snapshot, _ = self.next()
            self.assertGreater(snapshot.tick + 1, last)
            last = snapshot.tick
            self.viewer.call(list_worlds=c.ListWorlds())
            self.assertEqual(self.viewer.snapshots, [])
            self.acknowledge(snapshot)

    def test_viewers_at_other_rates_keep_their_deltas(self):
        world = self.new_world()
        self.client.call(run=c.Run(world=world))
        subscriptions = [self.subscribe(world, rate_hz=rate_hz) for rate_hz in (120.0, 40.0, 30.0)]
        deltas = dict.fromkeys(subscriptions, 0)
        while min(deltas.values()) < 50:
            snapshot, _ = self.next(lambda p: p.base_sequence > 0)
            deltas[snapshot.subscription_id] += 1

    def test_invalid_subscriptions_are_refused(self):
        world = self.new_world()
        plain_by_zstd = c.SubscribeSnapshots(world=world, rate_hz=1, compression=stream_pb2.COMPRESSION_ZSTD)
        status = self.viewer.call(INVALID, subscribe_snapshots=plain_by_zstd).status
        self.assertEqual([v.field for v in status.violations], ["subscribe_snapshots.codec"])
        for field, number in (("codec", 1), ("codec", 99), ("compression", 99), ("unacknowledged_max", 0),
                              ("unacknowledged_max", 1001)):
            status = self.viewer.call(INVALID, subscribe_snapshots=c.SubscribeSnapshots(
                world=world, rate_hz=1, **{field: number})).status
            self.assertEqual([v.field for v in status.violations], ["subscribe_snapshots." + field])


class Views(WithServer):
    """Snapshots in tiles, compared with CODEC_PLAIN of the same ticks."""

    def setUp(self):
        super().setUp()
        self.viewer = self.enterContext(Client(self.server))
        self.decoders = {}

    def wide_world(self, **parameters):
        return self.new_world(**{"seed": 3, "population_size": 200, "food_count": 300, "poison_count": 200,
                                 "island_width_px": 2600.0, "island_height_px": 1700.0, "obstacle_count": 6,
                                 "crate_count": 20, **parameters})

    def subscribe(self, world, view=None, rate_hz=120.0, **fields):
        codec = stream_pb2.CODEC_PLAIN if view is None else stream_pb2.CODEC_DELTA
        return self.viewer.call(subscribe_snapshots=c.SubscribeSnapshots(
            world=world, codec=codec, rate_hz=rate_hz, view=view, **fields)).subscription.subscription_id

    def set_view(self, subscription, **view):
        answer = self.viewer.call(set_view=c.SetView(subscription_id=subscription, view=c.View(**view))).subscription
        self.assertEqual(answer.subscription_id, subscription)

    def change_view(self, subscription, **view):
        """Sends set_view. Afterwards next() returns only snapshots sent after the change."""
        self.set_view(subscription, **view)
        while self.viewer.snapshots:
            self.next()

    def next(self, condition=lambda snapshot: True):
        """The next snapshot that fulfils the condition, and the contents of its tiles. Earlier ones are decoded,
        too."""
        while True:
            snapshot = self.viewer.next_snapshot()
            seen = None
            if snapshot.codec == stream_pb2.CODEC_DELTA:
                self.assertEqual(snapshot.base_sequence, 0)
                self.assertEqual((snapshot.tile_px, snapshot.body), (512, b""))
                decoder = self.decoders.setdefault((snapshot.subscription_id, snapshot.island),
                                                   TilesDecoder(zstd_content))
                seen = decoder.decode(snapshot)
            if condition(snapshot):
                return snapshot, seen

    def tiles_of(self, snapshot):
        return math.ceil(snapshot.width_px / 512), math.ceil(snapshot.height_px / 512)

    def in_tiles(self, plain_snapshot):
        """{kind: {"tile": …, "id": …, "x": …, …}} in 1/16 px, of a snapshot of CODEC_PLAIN."""
        across, down = self.tiles_of(plain_snapshot)
        entities = {}
        for kind, fields in columns(plain_snapshot).items():
            of_kind = {field: numpy.asarray(column * (1 if field == "id" else 16), numpy.int64)
                       for field, column in fields.items()}
            of_kind.setdefault("id", numpy.arange(len(of_kind["x"])))
            of_kind["tile"] = (numpy.minimum(of_kind["y"] // 8192, down - 1) * across +
                               numpy.minimum(of_kind["x"] // 8192, across - 1))
            entities[kind] = of_kind
        return entities

    def assert_full(self, seen, entities):
        """Asserts that the tiles of DETAIL_FULL together show exactly the entities in them."""
        for kind, expected in entities.items():
            there = numpy.isin(expected["tile"], list(seen))
            order = numpy.argsort(numpy.concatenate([of[kind]["id"] for of in seen.values()] or [[]]), kind="stable")
            for field in set(expected) - {"tile"}:
                together = numpy.concatenate([of[kind][field] for of in seen.values()] or [[]])
                numpy.testing.assert_array_equal(together[order], expected[field][there], f"{kind} {field}")

    def touched(self, snapshot, region):
        across, down = self.tiles_of(snapshot)
        return [row * across + column for row in range(down) for column in range(across)
                if column * 512 < region.left_px + region.width_px and (column + 1) * 512 > region.left_px and
                row * 512 < region.top_px + region.height_px and (row + 1) * 512 > region.top_px and
                region.left_px < snapshot.width_px and region.top_px < snapshot.height_px]

    def watch_together(self, world, generations=1, **fields):
        """Subscribes to plain snapshots, to all tiles, and to a region that moves with every snapshot."""
        whole, all_tiles = self.subscribe(world), self.subscribe(world, c.View(), **fields)
        panning = self.subscribe(world, c.View(region=c.Region(left_px=-500, width_px=600, height_px=600)), **fields)
        regions, step = {}, 0
        self.client.call(run=c.Run(world=world))
        shown, alike, bases, last_generation = {}, 0, {all_tiles: 0, panning: 0}, 0
        while alike < 150 or min(bases.values()) < 150 or last_generation < generations:
            snapshot, seen = self.next()
            subscription = snapshot.subscription_id
            if seen is not None:
                bases[subscription] += sum(tile.base_sequence > 0 for tile in snapshot.tiles)
                self.assertEqual([tile.tile for tile in snapshot.tiles], sorted(seen))
                self.assertTrue(all(tile.detail == stream_pb2.DETAIL_FULL for tile in snapshot.tiles))
            if subscription == panning:
                step += 1
                if step % 3 == 0:
                    region = c.Region(left_px=step * 17 % 3400 - 500, top_px=step * 11 % 2200 - 300, width_px=600,
                                      height_px=600)
                    self.set_view(panning, region=region)
                    regions[tuple(self.touched(snapshot, region))] = True
                    if len(seen) > 0:
                        self.assertLess(len(seen), 10)
            of_hash = shown.setdefault(snapshot.state_hash, {})
            of_hash[subscription] = snapshot if seen is None else seen
            if whole in of_hash and len(of_hash) > 1:
                entities = self.in_tiles(of_hash[whole])
                for seen in [of_hash.pop(name) for name in (all_tiles, panning) if name in of_hash]:
                    self.assert_full(seen, entities)
                    alike += 1
                last_generation = snapshot.generation
        self.assertGreater(len(regions), 3)

    def test_all_tiles_and_regions_equal_plain_snapshots(self):
        world = self.wide_world(generation_s=2)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=3)))
        self.watch_together(world, 2)

    def test_compressed_too_and_on_wide_islands(self):
        self.watch_together(self.wide_world(island_width_px=5000.0), compression=stream_pb2.COMPRESSION_ZSTD)

    def test_dots_and_densities_are_counted_right(self):
        world = self.wide_world()
        whole = self.subscribe(world)
        kinds = {self.subscribe(world, c.View(detail=detail), compression=compression): detail
                 for detail in (stream_pb2.DETAIL_DOTS, stream_pb2.DETAIL_DENSITY) for compression in (1, 2)}
        self.client.run_to(30, world)
        snapshots = {}
        while len(snapshots) < 5:
            snapshot, seen = self.next(lambda p: p.tick == 30)
            snapshots[snapshot.subscription_id] = snapshot, seen
        entities = self.in_tiles(snapshots[whole][0])
        across, down = self.tiles_of(snapshots[whole][0])
        for subscription, detail in kinds.items():
            snapshot, seen = snapshots[subscription]
            self.assertEqual(sorted(seen), list(range(across * down)))
            self.assertEqual({tile.detail for tile in snapshot.tiles}, {detail})
            for kind, of_kind in list(entities.items())[:5 if detail == stream_pb2.DETAIL_DOTS else 3]:
                for tile, shown in seen.items():
                    there = of_kind["tile"] == tile
                    x, y = of_kind["x"][there] - tile % across * 8192, of_kind["y"][there] - tile // across * 8192
                    if detail == stream_pb2.DETAIL_DOTS:
                        numpy.testing.assert_array_equal(shown[kind]["x"], x // 32)
                        numpy.testing.assert_array_equal(shown[kind]["y"], y // 32)
                    else:
                        cells = len(shown[kind])
                        self.assertGreater(cells, 1)
                        expected = numpy.zeros((cells, cells), int)
                        numpy.add.at(expected, (y * cells // 8192, x * cells // 8192), 1)
                        numpy.testing.assert_array_equal(shown[kind], expected)

    def test_a_moved_region_is_sent_from_a_paused_world(self):
        world = self.wide_world()
        self.client.run_to(20, world)
        subscription = self.subscribe(world, c.View(region=c.Region(width_px=600, height_px=100)))
        first, seen = self.next()
        self.assertEqual(sorted(seen), [0, 1])
        self.assertGreater(first.organism_count, sum(tile.organism_count for tile in first.tiles))
        self.set_view(subscription, region=c.Region(left_px=520, width_px=600, height_px=100))
        moved, seen_moved = self.next()
        self.assertEqual([(t.tile, t.base_sequence) for t in moved.tiles], [(1, first.sequence), (2, 0)])
        for kind, fields in seen_moved[1].items():
            for field, column in fields.items():
                numpy.testing.assert_array_equal(column, seen[1][kind][field])
        self.set_view(subscription, region=c.Region(width_px=10, height_px=10))
        back, _ = self.next()
        self.assertEqual([(t.tile, t.base_sequence) for t in back.tiles], [(0, 0)])
        for outside in ({"left_px": -700}, {"left_px": 2600}, {"top_px": 5000}, {"left_px": 1e300}):
            self.set_view(subscription, region=c.Region(width_px=600, height_px=600, **outside))
            self.assertEqual(self.next()[1], {})
        self.set_view(subscription)
        self.assertEqual(len(self.next()[1]), 6 * 4)

    def test_a_paused_world_reaches_full_detail_in_time(self):
        world = self.wide_world()
        self.client.run_to(20, world)

        def details():
            snapshot, _ = self.next()
            self.assertEqual(snapshot.tick, 20)
            shown.append((snapshot.sequence, snapshot.dropped_count))
            return {tile.detail for tile in snapshot.tiles}
        shown = []
        everything = self.subscribe(world, c.View())
        keyframe_bytes = 8 + self.next()[0].ByteSize()
        self.viewer.call(unsubscribe=c.Unsubscribe(subscription_id=everything))

        def ask_for_too_much(_):
            # Two seconds of budget are saved at first: 1.2 keyframes. The rest of the second takes 1.3 s.
            shown.clear()
            subscription = self.subscribe(world, c.View(bytes_per_s_max=keyframe_bytes * 6 // 10))
            try:
                self.assertEqual(details(), {stream_pb2.DETAIL_FULL})
                self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription))
                self.assertNotIn(stream_pb2.DETAIL_FULL, details())
            except AssertionError:
                self.viewer.call(unsubscribe=c.Unsubscribe(subscription_id=subscription))
                self.viewer.snapshots.clear()
                raise
            return subscription
        subscription = waiting.quicker_than(1.3, ask_for_too_much)
        self.assertEqual(details(), {stream_pb2.DETAIL_FULL})  # now the budget suffices
        # A raised budget takes effect at once.
        self.change_view(subscription, bytes_per_s_max=1000)
        details()
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription))
        self.assertNotIn(stream_pb2.DETAIL_FULL, details())
        self.change_view(subscription, bytes_per_s_max=10 * keyframe_bytes)
        self.assertEqual(details(), {stream_pb2.DETAIL_FULL})
        self.change_view(subscription, bytes_per_s_max=10 * keyframe_bytes, detail=stream_pb2.DETAIL_DOTS)
        self.assertEqual(details(), {stream_pb2.DETAIL_DOTS})
        self.change_view(subscription, bytes_per_s_max=10 * keyframe_bytes)
        self.assertEqual(details(), {stream_pb2.DETAIL_FULL})
        self.assertEqual(set(shown), {(shown[0][0], 0)})  # all show the same snapshot, and none was dropped

    def test_a_damaged_tile_is_mended_by_a_keyframe(self):
        world = self.wide_world()
        subscription = self.subscribe(world, c.View())
        self.client.call(run=c.Run(world=world))
        self.next(lambda p: any(t.base_sequence for t in p.tiles))
        decoder = self.decoders[subscription, 0]
        damaged = self.viewer.next_snapshot()
        damaged.tiles[3].body = bytes([damaged.tiles[3].body[0] ^ 1]) + damaged.tiles[3].body[1:]
        with self.assertRaisesRegex(ValueError, "damaged|not the last"):
            decoder.decode(damaged)
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription))
        decoder.decode(self.viewer.next_snapshot(lambda p: not any(t.base_sequence for t in p.tiles)))
        self.next(lambda p: all(t.base_sequence for t in p.tiles))

    def test_every_tile_takes_a_keyframe_now_and_then(self):
        world = self.wide_world()
        self.subscribe(world, c.View())
        self.client.call(run=c.Run(world=world))
        keyframes = dict.fromkeys(range(24), 0)
        before = self.next()[0]
        while min(keyframes.values()) < 2:
            snapshot = self.next()[0]
            if (snapshot.dropped_count, snapshot.generation) == (before.dropped_count, before.generation):
                for tile in snapshot.tiles:
                    keyframes[tile.tile] += tile.base_sequence == 0
            before = snapshot

    def test_they_wait_for_acknowledgements_and_the_newest_wins(self):
        world = self.wide_world()
        subscription = self.subscribe(world, c.View(), unacknowledged_max=1)
        self.client.call(run=c.Run(world=world))
        first = self.next()[0]
        with Client(self.server) as other:
            other.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=120))
            other.next_snapshot(lambda p: p.tick > first.tick + 60)
            paused = self.client.call(pause=c.Pause(world=world)).world
            other.next_snapshot(lambda p: p.tick == paused.tick)
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])
        self.viewer.send(session_pb2.ClientMessage(acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
            subscription_id=subscription, island=0, sequence=first.sequence)))
        newest, _ = self.next()
        self.assertEqual(newest.tick, paused.tick)
        self.assertFalse(any(t.base_sequence for t in newest.tiles))
        self.assertGreater(newest.dropped_count, 0)

    def test_a_budget_reduces_detail_then_rate_and_is_kept(self):
        world = self.wide_world()
        subscription = self.subscribe(world, c.View(), rate_hz=60)
        self.client.call(run=c.Run(world=world))
        self.assertEqual({t.detail for t in self.next()[0].tiles}, {stream_pb2.DETAIL_FULL})
        began = time.monotonic()
        wanted_bytes_per_s = sum(8 + self.next()[0].ByteSize() for _ in range(60)) / (time.monotonic() - began)
        # A few times too much for the first budget, and far too much for the second, on any machine.
        for bytes_per_s, dropped_count in (wanted_bytes_per_s // 4, 0), (wanted_bytes_per_s // 100, 100):
            bytes_per_s = max(1000, int(bytes_per_s))
            began, got, details, snapshot = time.monotonic(), 0, set(), None
            self.change_view(subscription, bytes_per_s_max=bytes_per_s)
            while (got < 5 * bytes_per_s or stream_pb2.DETAIL_DENSITY not in details or
                   snapshot.dropped_count < dropped_count):
                snapshot, _ = self.next()
                got += 8 + snapshot.ByteSize()
                details |= {tile.detail for tile in snapshot.tiles}
            # In addition to what was saved and in transit.
            self.assertLess(got, bytes_per_s * (time.monotonic() - began + 2) + 60_000)
        self.set_view(subscription)
        self.next(lambda p: {t.detail for t in p.tiles} == {stream_pb2.DETAIL_FULL})

    def test_invalid_views_are_refused(self):
        world = self.new_world()
        nan, good = float("nan"), {"width_px": 1.0, "height_px": 1.0}
        wrong = [("region.left_px", {"region": c.Region(**good, left_px=nan)}),
                 ("region.top_px", {"region": c.Region(**good, top_px=float("inf"))}),
                 ("region.width_px", {"region": c.Region(width_px=0, height_px=1)}),
                 ("region.height_px", {"region": c.Region(width_px=1, height_px=nan)}),
                 ("detail", {"detail": 9}), ("bytes_per_s_max", {"bytes_per_s_max": 999}),
                 ("bytes_per_s_max", {"bytes_per_s_max": 10 ** 12 + 1})]
        subscription = self.subscribe(world, c.View())
        for field, view in wrong:
            for path, request in (("subscribe_snapshots.view.", {"subscribe_snapshots": c.SubscribeSnapshots(
                    world=world, rate_hz=1, codec=2, view=c.View(**view))}),
                    ("set_view.view.", {"set_view": c.SetView(subscription_id=subscription, view=c.View(**view))})):
                status = self.viewer.call(INVALID, **request).status
                self.assertEqual([v.field for v in status.violations], [path + field])
                self.assertTrue(status.violations[0].allowed and status.violations[0].got)
        for codec in (stream_pb2.CODEC_UNSPECIFIED, stream_pb2.CODEC_PLAIN):
            status = self.viewer.call(INVALID, subscribe_snapshots=c.SubscribeSnapshots(
                world=world, rate_hz=1, codec=codec, view=c.View())).status
            self.assertEqual([v.field for v in status.violations], ["subscribe_snapshots.codec"])
        status = self.viewer.call(INVALID, set_view=c.SetView(subscription_id=subscription)).status
        self.assertEqual([v.field for v in status.violations], ["set_view.view"])
        status = self.viewer.call(NOT_FOUND, set_view=c.SetView(subscription_id=99, view=c.View())).status
        self.assertEqual([v.field for v in status.violations], ["set_view.subscription_id"])
        whole = self.subscribe(world)
        self.viewer.call(PRECONDITION, set_view=c.SetView(subscription_id=whole, view=c.View()))


class Queries(WithServer):
    def test_history_in_parts(self):
        world = self.new_world(fitness="gene_sum", island_count=7)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world, generations=300))
        self.client.wait_world(lambda x: x.state == w.RUN_STATE_WAITING, world)
        got, first, answers = [], None, 0
        while True:
            history = self.client.call(get_history=c.GetHistory(world=world, first_generation=first)).history
            self.assertLessEqual(len(history.generations), self.client.welcome.limits.history_generations_max)
            got += [(s.generation, s.island) for s in history.generations]
            answers += 1
            if not history.HasField("next_generation"):
                break
            first = history.next_generation
        self.assertEqual(got, list(itertools.product(range(1, 301), range(7))))
        self.assertGreater(answers, 1)
        part = self.client.call(get_history=c.GetHistory(world=world, first_generation=5, last_generation=7, island=6))
        self.assertEqual([(s.generation, s.island) for s in part.history.generations], [(5, 6), (6, 6), (7, 6)])
        self.assertEqual(len(self.client.call(
            get_history=c.GetHistory(world=world, first_generation=1 << 60)).history.generations), 0)
        self.client.call(INVALID, get_history=c.GetHistory(world=world, first_generation=5, last_generation=4))
        self.client.call(NOT_FOUND, get_history=c.GetHistory(world=world, island=7))

    def test_statistics_before_and_after_a_generation(self):
        world = self.new_world(generation_s=1)
        before = self.client.call(get_statistics=c.GetStatistics(world=world)).statistics
        self.assertEqual((len(before.live), len(before.last)), (1, 0))
        self.assertEqual((before.live[0].organism_count, before.live[0].alive_count), (50, 50))
        self.client.run_to(61, world)
        after = self.client.call(get_statistics=c.GetStatistics(world=world)).statistics
        self.assertEqual((after.world.generation, after.last[0].generation, after.last[0].end_tick), (2, 1, 60))
        self.assertGreaterEqual(after.last[0].fitness_best, after.last[0].fitness_mean)

    def test_organisms_of_a_second_generation_have_parents(self):
        world = self.new_world(generation_s=1)
        first = self.client.call(get_organism=c.GetOrganism(world=world, organism=49)).organism
        self.assertEqual((first.id, first.generation, len(first.genes), len(first.parents)), (49, 1, 6, 0))
        self.client.run_to(61, world)
        child = self.client.call(get_organism=c.GetOrganism(world=world, organism=49)).organism
        self.assertEqual(child.generation, 2)
        self.assertIn(len(child.parents), (1, 2))
        status = self.client.call(NOT_FOUND, get_organism=c.GetOrganism(world=world, organism=50)).status
        self.assertEqual([(v.field, v.allowed) for v in status.violations], [("get_organism.organism", "0 to 49")])
        self.client.call(NOT_FOUND, get_organism=c.GetOrganism(world=world, island=1))

    def population(self, world, island=0, first=0, client=None):
        """A part of a population, with its columns as arrays."""
        answer = (client or self.client).call(
            get_population=c.GetPopulation(world=world, island=island, first_organism=first)).population
        columns = lambda data, kind, count: numpy.frombuffer(data, kind).reshape(count, -1)
        return types.SimpleNamespace(
            answer=answer, genes=columns(answer.genes, "<f4", 6), parents=columns(answer.parents, "<u4", 2),
            founders=numpy.frombuffer(answer.founders, "<u4"), choices=numpy.frombuffer(answer.choices, "u1"),
                                     forces=columns(answer.forces, "<f4", 2),
            targets=columns(answer.targets, "<f4", 2))

    def compare_with_organisms(self, world, island=0):
        """Asserts that every row of a population equals the answer to GetOrganism."""
        all_of_them = self.population(world, island)
        answer = all_of_them.answer
        self.assertEqual((answer.first, answer.count), (0, answer.organism_count))
        for column in (all_of_them.genes, all_of_them.forces, all_of_them.targets):
            self.assertEqual(column.shape[1], answer.count)
        for i in range(answer.count):
            one = self.client.call(get_organism=c.GetOrganism(world=world, island=island, organism=i)).organism
            self.assertEqual(one.generation, answer.generation)
            self.assertEqual(list(all_of_them.genes[:, i]), list(one.genes))
            parents = list(all_of_them.parents[:, i]) if answer.parents else []
            self.assertEqual(list(dict.fromkeys(parents)), list(one.parents))
            self.assertEqual(all_of_them.choices[i], one.choice)
            self.assertEqual(list(all_of_them.forces[:, i]), [one.force_x, one.force_y])
            self.assertEqual(list(all_of_them.targets[:, i]),
                             [numpy.float32(one.target_x_px), numpy.float32(one.target_y_px)])
            self.assertEqual(one.choice == w.CHOICE_UNSPECIFIED, not one.alive)
            if one.choice == w.CHOICE_WANDER:
                self.assertEqual((one.target_x_px, one.target_y_px), (one.x_px, one.y_px))
            elif one.choice != w.CHOICE_UNSPECIFIED:  # the target is within its range of perception
                seen = one.genes[4 if one.choice == w.CHOICE_SEEK else 5]
                self.assertLessEqual(math.hypot(one.target_x_px - one.x_px, one.target_y_px - one.y_px), seen + 0.01)
        return all_of_them

    def test_a_population_is_its_organisms(self):
        world = self.new_world(generation_s=6, island_count=2, poison_count=200)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        at_first = self.compare_with_organisms(world, 1)
        self.assertEqual((at_first.answer.generation, at_first.answer.generation_tick, at_first.answer.parents),
                         (1, 0, b""))
        self.client.run_to(300, world)
        later = self.compare_with_organisms(world, 1)
        self.assertEqual((later.genes == at_first.genes).all(), True)
        self.assertEqual(list(later.founders), list(range(50, 100)))
        self.assertEqual(set(later.choices), {w.CHOICE_UNSPECIFIED, w.CHOICE_WANDER, w.CHOICE_SEEK, w.CHOICE_FLEE},
                         "some have died, and the living do everything that there is")
        self.client.run_to(360, world)
        over = self.population(world, 1)  # organisms of a finished generation do nothing
        self.assertEqual(set(over.choices), {w.CHOICE_UNSPECIFIED})
        self.assertFalse(over.forces.any() or over.targets.any())
        self.client.run_to(361, world)
        bred = self.compare_with_organisms(world, 1)
        self.assertEqual((bred.answer.generation, bred.answer.generation_tick, bred.parents.shape), (2, 1, (2, 50)))
        self.assertLess(bred.parents.max(), 50)
        self.assertEqual(list(bred.founders), list(50 + bred.parents[0]))
        for island, first, field, allowed in ((2, 0, "island", "0 to 1"), (0, 50, "first_organism", "0 to 49")):
            status = self.client.call(NOT_FOUND, get_population=c.GetPopulation(
                world=world, island=island, first_organism=first)).status
            self.assertEqual([(v.field, v.allowed) for v in status.violations], [("get_population." + field, allowed)])

    def test_a_population_without_bodies_has_nothing_to_do(self):
        world = self.new_world(fitness="gene_sum")
        answer = self.population(world)
        self.assertEqual(answer.genes.shape, (6, 50))
        self.assertEqual(set(answer.choices), {w.CHOICE_UNSPECIFIED})
        self.assertEqual(self.client.call(get_motion=c.GetMotion(world=world)).motion.body_count, 0)

    def test_organisms_do_what_was_predicted(self):
        world = self.new_world(respawn=False)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        for tick in (0, 60, 300):
            self.client.run_to(tick, world)
            organisms = lambda: [self.client.call(get_organism=c.GetOrganism(world=world, organism=i)).organism
                                 for i in range(50)]
            before, answer = organisms(), self.population(world)
            self.client.run_to(tick + 1, world)
            pushed = [(i, o) for i, o in enumerate(organisms()) if o.alive and before[i].alive]
            self.assertGreater(len(pushed), 30)
            as_predicted = sum(
                math.isclose(o.velocity_x_px_s, 0.999 * (before[i].velocity_x_px_s + answer.forces[0,
                                                                                                   i] / o.mass_kg / 60),
                             rel_tol=1e-4, abs_tol=1e-4) and
                math.isclose(o.velocity_y_px_s, 0.999 * (before[i].velocity_y_px_s + answer.forces[1,
                                                                                                   i] / o.mass_kg / 60),
                             rel_tol=1e-4, abs_tol=1e-4) for i, o in pushed)
            self.assertGreaterEqual(as_predicted, 0.8 * len(pushed), "all but those that have bounced")

    def test_a_large_population_comes_in_parts(self):
        rows = self.client.welcome.limits.population_rows_max
        world = self.new_world(population_size=2 * rows + 7, fitness="gene_sum")
        parts, first = [], 0
        while not parts or first < parts[-1].answer.organism_count:
            parts.append(self.population(world, first=first))
            self.assertEqual(parts[-1].answer.first, first)
            first += parts[-1].answer.count
        self.assertEqual([part.answer.count for part in parts], [rows, rows, 7])
        genes = numpy.concatenate([part.genes for part in parts], axis=1)
        for i in (0, rows - 1, rows, 2 * rows + 6):
            one = self.client.call(get_organism=c.GetOrganism(world=world, organism=i)).organism
            self.assertEqual(list(genes[:, i]), list(one.genes))
        middle = self.population(world, first=rows - 3)
        self.assertTrue((middle.genes == genes[:, rows - 3:2 * rows - 3]).all())

    def test_motion_is_that_of_the_organisms(self):
        world = self.new_world(respawn=False)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        motion = lambda: self.client.call(get_motion=c.GetMotion(world=world)).motion
        at_rest = motion()
        self.assertEqual((at_rest.tick, at_rest.body_count, at_rest.kinetic_energy, at_rest.fastest_px_s),
                         (0, 50, 0, 0))
        self.client.run_to(200, world)
        answer = motion()
        alive = [o for o in (self.client.call(get_organism=c.GetOrganism(world=world, organism=i)).organism
                             for i in range(50)) if o.alive]
        speed = lambda o: math.hypot(o.velocity_x_px_s, o.velocity_y_px_s)
        self.assertEqual((answer.tick, answer.body_count), (200, len(alive)))
        self.assertAlmostEqual(answer.tick_s, 1 / 60)
        self.assertAlmostEqual(answer.kinetic_energy, sum(o.mass_kg * speed(o) ** 2 / 2 for o in alive), delta=0.1)
        self.assertAlmostEqual(answer.momentum_x, sum(o.mass_kg * o.velocity_x_px_s for o in alive), delta=0.01)
        self.assertAlmostEqual(answer.momentum_y, sum(o.mass_kg * o.velocity_y_px_s for o in alive), delta=0.01)
        self.assertAlmostEqual(answer.fastest_px_s, max(map(speed, alive)), places=3)
        self.assertAlmostEqual(answer.fastest_step_share, max(speed(o) / 60 / o.radius_px for o in alive), places=3)
        depths = [max(0, a.radius_px + b.radius_px - math.hypot(a.x_px - b.x_px, a.y_px - b.y_px))
                  for a, b in itertools.combinations(alive, 2)]
        self.assertAlmostEqual(answer.deepest_overlap_px, max(depths), places=3)
        self.assertGreaterEqual(answer.cell_px, 2 * max(o.radius_px for o in alive))
        self.client.call(NOT_FOUND, get_motion=c.GetMotion(world=world, island=1))

    def test_ticks_too_long_for_their_speeds_are_counted(self):
        world = self.new_world(tick_s=0.05, max_speed_px_s=3000, force_per_unit=100, respawn=False)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.run_to(60, world)
        answer = self.client.call(get_motion=c.GetMotion(world=world)).motion
        self.assertGreater(answer.too_fast_count, 0)
        self.assertGreater(answer.fastest_step_share, 1)

    def test_the_dead_can_be_asked_about(self):
        world = self.new_world(food_count=0, poison_count=0, generation_s=600)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world, generations=1))
        self.client.wait_world(lambda x: x.state == w.RUN_STATE_WAITING, world)
        dead = self.client.call(get_organism=c.GetOrganism(world=world)).organism
        self.assertEqual((dead.alive, dead.health, dead.cause_of_death), (False, 0, w.CAUSE_OF_DEATH_STARVED))
        self.assertGreater(dead.lived_s, 10)


class StartAndEnd(unittest.TestCase):
    def start_refused(self, *options, status=1):
        with tempfile.TemporaryDirectory() as state:
            ended = waiting.run([evod_path, *options], capture_output=True, text=True,
                                 env={**os.environ, "XDG_STATE_HOME": state})
        self.assertEqual(ended.returncode, status, ended.stderr)
        return ended.stderr

    def file(self, text):
        path = os.path.join(self.enter(tempfile.TemporaryDirectory()), "two_islands.json")
        with open(path, "w") as file:
            file.write(text)
        return path

    def enter(self, context):
        result = context.__enter__()
        self.addCleanup(context.__exit__, None, None, None)
        return result

    def serve(self, *options, **popen):
        server = Server(*options, **popen)
        self.addCleanup(server.end)
        return server

    def test_a_taken_port_is_said_to_be_taken(self):
        server = self.serve()
        message = self.start_refused("--port", str(server.port))
        self.assertIn("port is in use", message)
        self.assertIn("--port", message)

    def test_a_bad_address_is_said_to_be_one(self):
        self.assertIn("--bind", self.start_refused("--port", "0", "--bind", "localhorst"))

    def test_a_bad_experiment_names_line_and_field(self):
        message = self.start_refused("--port", "0", "--experiment",
                                     self.file('{\n  "food_count": 3,\n  "mutation_chance": 1.5\n}'))
        self.assertIn("mutation_chance (line 3)", message)
        self.assertIn("line 2", self.start_refused("--port", "0", "--experiment", self.file('{\n  "food_count": ,\n}')))

    def test_an_experiment_that_cannot_be_read_is_said_so(self):
        self.assertIn("No such file", self.start_refused("--port", "0", "--experiment", "/nowhere/at_all.json"))
        self.assertIn("folder", self.start_refused("--port", "0", "--experiment", "/"))

    def test_bad_options_are_refused(self):
        for options in (["--speed", "fast"], ["--speed", "nan"], ["--speed", "0"], ["--threads", "0"],
                        ["--port", "70000"],
                        ["--seed", "x"], ["--colour"]):
            self.assertIn(options[0], self.start_refused(*options, status=2))

    def test_an_experiment_defines_the_first_world(self):
        path = self.file('{"seed": 77, "island_count": 2, "description": "two"}')
        server = self.serve("--experiment", path, "--speed", "max", "--start")
        self.assertEqual((server.world, server.seed), ("two_islands", 77))
        with Client(server) as client:
            world = client.world()
            self.assertEqual((world.name, world.seed, world.island_count, world.speed.max, world.state),
                             ("two_islands", 77, 2, True, w.RUN_STATE_RUNNING))
            client.wait_world(lambda x: x.tick > 10)
        self.assertEqual(self.serve("--experiment", path, "--seed", "78").seed, 78)

    def test_thread_counts_give_the_same_hashes(self):
        path = self.file('{"population_size": 3000, "scale_with_population": true, "reference_population": 50,'
                         ' "island_count": 2}')
        hashes = set()
        for threads in ("1", "2", "3"):
            server = self.serve("--experiment", path, "--seed", "6", "--threads", threads, "--speed", "max")
            with Client(server) as client:
                hashes.add(client.run_to(60).state_hash)
        self.assertEqual(len(hashes), 1)

    def test_either_signal_says_goodbye_and_ends_well(self):
        for how in (signal.SIGTERM, signal.SIGINT):
            def end(lap):
                server = Server("--start", "--speed", "max")
                with Client(server) as client, Client(server) as deaf, Client(server, hello=False):
                    client.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
                    deaf.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=120))
                    client.next_snapshot(lambda p: p.tick > 0)
                    server.process.send_signal(how)
                    client.next_event("server_going_away")
                    client.assert_closed()
                    lap()
                    began = time.monotonic()
                    server.end(how)
                    self.assertLess(time.monotonic() - began, 10)
            waiting.quicker_than(10, end)

    def test_it_outlives_the_reader_of_its_log(self):
        process = subprocess.Popen([evod_path, "--port", "0", "--keep-nothing"], stderr=subprocess.PIPE, text=True)
        self.addCleanup(waiting.ended, process)
        self.addCleanup(process.terminate)
        address = None
        while address is None:
            address = re.search(r":(\d+), world", process.stderr.readline())
        process.stderr.close()
        server = lambda: None  # the parts of a Server that a Client needs
        server.port = int(address[1])
        for _ in range(3):  # each is logged
            with Client(server) as client:
                client.call(list_worlds=c.ListWorlds())
        self.assertIsNone(process.poll())

    def test_signals_in_a_row_do_no_harm(self):
        server = Server("--start", "--speed", "max")
        for _ in range(5):
            with contextlib.suppress(ProcessLookupError):
                server.process.send_signal(signal.SIGTERM)
        # The second signal ends the server at once, unless the first has already ended it.
        self.assertIn(waiting.ended(server.process), (0, -signal.SIGTERM))

    @unittest.skipIf(b"__ubsan_handle_dynamic_type" in open(evod_path, "rb").read(),
                     "UndefinedBehaviorSanitizer needs file descriptors to look at an object, and takes it for wrong")
    def test_too_few_file_descriptors_do_not_stop_it_for_good(self):
        server = self.serve(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (40, 40)))

        def run_out_of_them(lap):
            with contextlib.ExitStack() as stack:
                first = stack.enter_context(Client(server))
                for _ in range(60):
                    stack.enter_context(Client(server, hello=False))
                until(lambda: "cannot accept a connection" in server.output(), "it runs out of them")
                used_s, began = waiting.processor_time_s(server.process.pid), time.monotonic()
                for _ in range(20):
                    first.call(list_worlds=c.ListWorlds())
                until(lambda: time.monotonic() - began > 0.5, "some time to spin in")
                self.assertLess(waiting.processor_time_s(server.process.pid) - used_s, 0.4)
            lap()
            began = time.monotonic()
            until(lambda: self.admitted(server), "it takes connections again")
            self.assertLess(time.monotonic() - began, 1)
        waiting.quicker_than(1, run_out_of_them)

    def admitted(self, server):
        with Client(server, hello=False) as client:
            client.hello()
            readable, _, _ = select.select([client.socket], [], [], 1)
            return bool(readable) and client.control().HasField("welcome")


class Documentation(unittest.TestCase):
    """The statements of docs/PROTOCOL.md are true. tests/docs runs its programs."""

    def test_its_example_bytes_are_right(self):
        text = open(protocol_path, encoding="utf-8").read()
        blocks = [bytes.fromhex("".join(line.split("#")[0] for line in block.splitlines()))
                  for block in re.findall(r"```\n(45 56 .*?)```", text, re.S)]
        self.assertEqual(len(blocks), 2)
        self.assertEqual(blocks[0][:8], b"EV\x01\x01\x08\0\0\0")
        hello = session_pb2.ClientMessage.FromString(blocks[0][8:])
        self.assertEqual((hello.hello.protocol_version, hello.hello.client_name), (1, "me"))
        self.assertEqual(blocks[1][:8], b"EV\x01\x02\xe2\0\0\0")
        self.assertEqual(len(blocks[1]), 8 + 0xe2)
        snapshot = stream_pb2.SnapshotFrame.FromString(blocks[1][8:])
        self.assertEqual((snapshot.world, snapshot.tick, snapshot.dropped_count), ("default", 120, 3))
        seen = columns(snapshot)
        self.assertEqual({k: list(v) for k, v in seen["organisms"].items()},
                         {"id": [0, 2], "x": [10.5, 50.25], "y": [20, 30.0625], "radius": [10, 8.5],
                          "health": [100, 42.5]})
        self.assertEqual((seen["food"]["x"][0], seen["poison"]["y"][0], seen["obstacles"]["half_width"][0]),
                         (5, 55, 15))

    def test_its_decoder_is_the_one_tested_here(self):
        text = open(protocol_path, encoding="utf-8").read()
        decoder = re.search(r"### Deltas.*?```python\n(.*?)```", text, re.S)[1]
        self.assertEqual(decoder, open(sys.modules[Decoder.__module__].__file__, encoding="utf-8").read())

    def test_it_mentions_every_request_and_event(self):
        text = open(protocol_path, encoding="utf-8").read()
        for field in c.Request.DESCRIPTOR.oneofs_by_name["kind"].fields:
            self.assertIn(f"`{field.message_type.name}`", text)
        for field in stream_pb2.Event.DESCRIPTOR.oneofs_by_name["kind"].fields:
            self.assertIn(f"`{field.name}`", text)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
