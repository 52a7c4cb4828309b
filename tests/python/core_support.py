"""A Core for tests, with the server played by the test."""
import unittest

from evod import framing
from evod.core import Core
from evod.v1 import commands_pb2 as c, session_pb2


class CoreTestCase(unittest.TestCase):
    """A core without a socket."""

    def core(self):
        """A core whose server has sent its Welcome."""
        core = Core(token="", client_name="test", server="lab:1")
        core.opened()
        welcome = session_pb2.Welcome(protocol_version=1, limits=c.Limits(requests_in_flight_max=4,
                                                                          control_frame_bytes_max=500))
        core.received(framing.encode(session_pb2.ServerMessage(welcome=welcome).SerializeToString()))
        core.outgoing()
        return core

    def sent(self, core):
        """The messages that the core wants to send."""
        reader = framing.FrameReader()
        reader.feed(core.outgoing())
        return [session_pb2.ClientMessage.FromString(body) for _, body in reader.frames()]

    def answer(self, core, request_id, **response):
        """Hands the core a response."""
        message = session_pb2.ServerMessage(response=c.Response(request_id=request_id, **response))
        core.received(framing.encode(message.SerializeToString()))
