"""An independent client against a real server: everything that docs/PROTOCOL.md promises, abuse included.

Plain Python 3, protobuf and numpy, with message classes made by protoc, and the decoder of docs/PROTOCOL.md; nothing
else of this repository. The tests are in protocol_*_test.py. Each class is one subject, and one test of ctest:

    protocol_…_test.py EVOD MESSAGES PROTOCOL.md [CLASS …]

No test waits for a fixed time. How long each waits for a condition is in waiting.py.
"""
import ctypes
import os
import re
import secrets
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import unittest

evod_path, messages_path, protocol_path = sys.argv[1:4]
sys.path.insert(0, messages_path)

import numpy  # noqa: E402
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2 as w  # noqa: E402
from delta_decoder import KINDS  # noqa: E402
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
                  # no subscription asks for these
                  for field in of_kind.DESCRIPTOR.fields if field.name not in ("heading", "species")}
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
