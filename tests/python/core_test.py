"""The Core: frames, the queue of requests, reconnecting, subscriptions; and damaged input."""
import random
import struct
import unittest

import evod
from evod import framing, plans
from evod.core import Core
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2

from core_support import CoreTestCase


class CoreTest(CoreTestCase):
    def test_wrong_frame_headers_end_the_connection(self):
        for header, message in ((b"EX\1\1\0\0\0\0", "begins with"), (b"EV\2\1\0\0\0\0", "version is 2"),
                                (b"EV\1\3\0\0\0\0", "channel is 3"),
                                (b"EV\1\1\1\0\0\4", "bytes long"), (b"EV\1\1\1\0\0\0\xff", "cannot be read")):
            with self.assertRaisesRegex(evod.DamagedData, message):
                self.core().received(header)

    def test_random_bytes_raise_no_other_exception(self):
        chance = random.Random(11)
        for _ in range(3000):
            core = self.core()
            body = chance.randbytes(chance.randrange(40))
            try:
                core.received(b"EV\1" + bytes([chance.choice((1, 2))]) + struct.pack("<I", len(body)) + body)
            except evod.Error:
                pass

    def test_frames_are_assembled_from_any_pieces(self):
        message = session_pb2.ServerMessage(event=stream_pb2.Event(world="a",
                                                                   server_going_away=stream_pb2.ServerGoingAway()))
        data = framing.encode(message.SerializeToString()) * 3
        for size in (1, 3, 7, 1000):
            reader, bodies = framing.FrameReader(), []
            for at in range(0, len(data), size):
                reader.feed(data[at:at + size])
                bodies += [body for _, body in reader.frames()]
            self.assertEqual(bodies, [message.SerializeToString()] * 3)

    def test_requests_are_queued_and_repeated_in_order(self):
        core = self.core()
        requests = [core.request(c.Request(pause=c.Pause(world=str(i)))) for i in range(5)]
        self.assertEqual([message.request.request_id for message in self.sent(core)], [1, 2])
        self.answer(core, 1)
        self.assertTrue(requests[0].done)
        self.assertEqual([message.request.request_id for message in self.sent(core)], [3])
        core.lost(evod.NoConnection("gone"))
        core.opened()
        self.assertEqual([message.WhichOneof("kind") for message in self.sent(core)], ["hello"])
        welcome = session_pb2.Welcome(protocol_version=1, limits=c.Limits(requests_in_flight_max=9))
        core.received(framing.encode(session_pb2.ServerMessage(welcome=welcome).SerializeToString()))
        repeated = self.sent(core)
        self.assertEqual([message.request.request_id for message in repeated], [2, 3, 4, 5])
        self.assertEqual({message.request.client_key for message in repeated}, {core.client_key})

    def test_a_member_joins_once_and_comes_back_with_the_token(self):
        core = Core(join=session_pb2.Join(code="KTRMXB", name="Ada"), client_name="test", server="lab:1")
        welcome = session_pb2.Welcome(protocol_version=1, membership=session_pb2.Membership(token="of Ada"))
        hellos = []
        for _ in range(3):
            core.opened()
            hellos += [message.hello for message in self.sent(core)]
            core.received(framing.encode(session_pb2.ServerMessage(welcome=welcome).SerializeToString()))
            welcome.membership.token = ""
            core.lost(evod.NoConnection("gone"))
        self.assertEqual([(hello.join.code, hello.join.name, hello.token) for hello in hellos],
                         [("KTRMXB", "Ada", ""), ("", "", "of Ada"), ("", "", "of Ada")])

    def test_a_replay_that_opens_too_late_is_closed(self):
        core = self.core()
        pending = core.request(c.Request(open_replay=c.OpenReplay(world="w")))
        self.assertEqual(len(self.sent(core)), 1)
        core.forget(pending)
        self.answer(core, 1, world=world_pb2.WorldInfo(name="w@1"))
        self.assertEqual([message.request.close_replay.world for message in self.sent(core)], ["w@1"])

    def test_a_refused_view_is_not_requested_again(self):
        core = self.core()
        subscription = core.subscribe(c.Request(subscribe_snapshots=c.SubscribeSnapshots(world="w")))
        stream = plans.SnapshotStream(core, subscription)
        plan = stream.set_view(c.View(detail=stream_pb2.DETAIL_DOTS))
        step = next(plan)
        self.assertFalse(step.condition(), "the server has not accepted the subscription yet")
        self.answer(core, 1, subscription=c.Subscription(subscription_id=4))
        self.assertTrue(step.condition())
        request = plan.send(None)
        self.assertEqual(request.set_view.subscription_id, 4)
        with self.assertRaises(evod.Error):
            plan.throw(evod.Error("no view there"))
        self.assertFalse(subscription.request.subscribe_snapshots.HasField("view"))

    def test_session_requests_fail_with_their_session(self):
        core = self.core()
        pending = core.request(c.Request(unsubscribe=c.Unsubscribe(subscription_id=1)))
        core.lost(evod.NoConnection("gone"))
        self.assertIsInstance(pending.error, evod.NoConnection)

    def test_a_request_that_is_too_long_is_not_sent(self):
        core = self.core()
        with self.assertRaisesRegex(evod.Error, "bytes long, allowed at most 500"):
            core.request(c.Request(pause=c.Pause(world="x" * 500)))
        self.assertEqual(core.outgoing(), b"")

    def test_the_newest_events_are_kept_and_losses_counted(self):
        core = self.core()
        subscription = core.subscribe(c.Request(subscribe_events=c.SubscribeEvents(world="a")))
        self.answer(core, 1, subscription=c.Subscription(subscription_id=4))
        event = framing.encode(session_pb2.ServerMessage(event=stream_pb2.Event(
            world="a", world_deleted=stream_pb2.WorldDeleted())).SerializeToString())
        core.received(event * 10_002)
        self.assertEqual(subscription.take_event().events_dropped.dropped_count, 2)
        self.assertEqual(len(subscription.arrived), 10_000)

    def test_a_collected_subscription_is_unsubscribed(self):
        core = self.core()
        core.subscribe(c.Request(subscribe_events=c.SubscribeEvents(world="a")))
        self.answer(core, 1, subscription=c.Subscription(subscription_id=4))
        (unsubscribed,) = [message.request for message in self.sent(core) if message.request.HasField("unsubscribe")]
        self.assertEqual(unsubscribed.unsubscribe.subscription_id, 4)


if __name__ == "__main__":
    unittest.main()
