"""evoctl ends when its server, its world or its answer is gone. The test is the server. EVOCTL names the program,
MESSAGES the folder with the generated messages."""
import os
import socket
import struct
import subprocess
import sys
import unittest

import waiting

sys.path.insert(0, os.environ["MESSAGES"])
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2 as w  # noqa: E402

EVOCTL = os.environ["EVOCTL"]


class Session:
    """The server's end of a session, after the Welcome."""

    def __init__(self, listener):
        self.connection, _ = listener.accept()
        self.connection.settimeout(waiting.LONGEST_S)
        assert self.read().HasField("hello")
        self.send(welcome=session_pb2.Welcome(protocol_version=1))

    def bytes(self, count):
        data = b""
        while len(data) < count:
            part = self.connection.recv(count - len(data))
            assert part, "evoctl has closed the connection"
            data += part
        return data

    def read(self):
        (length,) = struct.unpack("<4xI", self.bytes(8))
        return session_pb2.ClientMessage.FromString(self.bytes(length))

    def request(self, kind):
        """Reads the next request, which has to be of this kind."""
        request = self.read().request
        assert request.WhichOneof("kind") == kind, request
        return request

    def send(self, **message):
        body = session_pb2.ServerMessage(**message).SerializeToString()
        self.connection.sendall(b"EV\1\1" + struct.pack("<I", len(body)) + body)

    def answer(self, request, **fields):
        self.send(response=c.Response(request_id=request.request_id, **fields))

    def close(self):
        self.connection.close()


class Case(unittest.TestCase):
    def setUp(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.listener.settimeout(waiting.LONGEST_S)
        self.addCleanup(self.listener.close)

    def start(self, *words, timeout_s=600):
        """Starts evoctl and returns its first session."""
        address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        self.evoctl = subprocess.Popen([EVOCTL, "--server", address, "--timeout", str(timeout_s), *words],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.clean_up)
        session = Session(self.listener)
        self.addCleanup(session.close)
        return session

    def clean_up(self):
        if self.evoctl.poll() is None:
            self.evoctl.kill()
        self.evoctl.communicate()

    def ended(self, status):
        """Waits for the end of evoctl and returns what it printed on standard error."""
        self.assertEqual(waiting.ended(self.evoctl), status)
        return self.evoctl.stderr.read()


class Exports(Case):
    def test_an_export_ends_with_its_session(self):
        session = self.start("export", "--what", "events")
        part = c.ExportPart(export_id=1, text=b"tick\n")
        session.answer(session.request("export_run"), export_part=part)
        session.request("continue_export")
        self.listener.close()
        session.close()
        self.assertIn("closed the connection", self.ended(3))

    def test_an_export_does_not_wait_for_a_server_that_is_gone(self):
        session = self.start("export", "--what", "events", timeout_s=1)
        session.request("export_run")
        self.listener.close()
        session.close()
        self.assertIn("127.0.0.1", self.ended(3))


class Worlds(Case):
    def subscribed(self, session):
        """Answers the requests of evoctl until it has subscribed to events."""
        while True:
            request = session.read().request
            kind = request.WhichOneof("kind")
            if kind == "subscribe_events":
                return request
            world = w.WorldInfo(name="lesson", state=w.RUN_STATE_RUNNING, generation=1)
            session.answer(request, **({"statistics": c.Statistics(world=world)} if kind == "get_statistics"
                                       else {"worlds": c.WorldList()}))

    def follow(self, *words):
        """Lets evoctl follow a world that is gone after a reconnection."""
        session = self.start("--world", "lesson", *words)
        session.answer(self.subscribed(session), subscription=c.Subscription(subscription_id=1))
        session.answer(session.request("list_worlds"), worlds=c.WorldList())
        session.close()
        again = Session(self.listener)
        self.addCleanup(again.close)
        gone = c.Status(code=c.CODE_NOT_FOUND, reason=c.REASON_WORLD_NOT_FOUND, message="there is no world 'lesson'")
        again.answer(self.subscribed(again), status=gone)
        self.assertIn("there is no world 'lesson'", self.ended(1))

    def test_watch_ends_if_the_world_is_gone(self):
        self.follow("watch", "--generations", "3")

    def test_events_end_if_the_world_is_gone(self):
        self.follow("events")

    def test_events_end_with_their_world(self):
        session = self.start("--world", "lesson", "events", "--count", "2")
        session.answer(self.subscribed(session), subscription=c.Subscription(subscription_id=1))
        session.answer(session.request("list_worlds"), worlds=c.WorldList())
        session.send(event=stream_pb2.Event(world="lesson", world_deleted=stream_pb2.WorldDeleted()))
        self.assertIn("only 1 of 2 events arrived", self.ended(1))


class Answers(Case):
    def test_an_expired_answer_is_not_a_refusal(self):
        session = self.start("pause")
        first = session.request("pause")
        session.close()
        again = Session(self.listener)
        self.addCleanup(again.close)
        repeated = again.request("pause")
        self.assertEqual(repeated, first)
        again.answer(repeated, status=c.Status(code=c.CODE_FAILED_PRECONDITION, reason=c.REASON_REQUEST_TOO_OLD,
                                               message="the request may have been applied"))
        self.assertIn("may have been applied", self.ended(3))


if __name__ == "__main__":
    unittest.main()
