"""Core: a client's side of the protocol, without a socket, a clock or a thread.

It is told what happens to the line (opened, received, lost) and what is wanted (request, subscribe), and says what is to be
sent (outgoing) and what has come (Pending, Subscription). When a line is lost and another one opened, it says hello again,
asks for what was subscribed before, and sends every request that has no answer again, with the same client_key and
request_id: so a command happens once.

Threads      none; whoever shares a Core between threads lets one in at a time.
Bounded      requests beyond the server's limit wait here for their turn; of events each subscription keeps the newest
             EVENTS_KEPT, and the loss is told in an EventsDropped; pictures are acknowledged when they are taken, so no
             more than PICTURES_AHEAD of an island are ever on their way.
"""
from __future__ import annotations

import collections
import dataclasses
import secrets
import weakref
from typing import Any, Iterator

import google.protobuf.message

from evod import framing, picture_decoder
from evod.errors import DamagedData, Error, NoConnection, refusal
from evod.snapshots import Snapshot
from evod.v1 import commands_pb2, session_pb2, stream_pb2
from evod.version import __version__

PROTOCOL_VERSION = 1
EVENTS_KEPT = 10_000
PICTURES_AHEAD = 8
_KEYFRAME_REQUESTS_MAX = 3  # for one damaged picture after another

#: For the answer to these, generations may have to be simulated again: it may take so many times as long as others.
_REPLAYING = frozenset(("open_replay", "seek", "get_breeding", "export_run", "continue_export"))
_REPLAYING_TIMES = 20

#: Of these, a session that has ended leaves nothing that could be asked for again.
_OF_THE_SESSION = frozenset(("unsubscribe", "request_keyframe", "set_view", "continue_export"))


class Pending:
    """A request that was asked; in the end it has a response, or an error: nothing was heard, and nothing will be."""

    def __init__(self, request: commands_pb2.Request, frame: bytes) -> None:
        self.request, self.frame = request, frame
        self.kind: str = request.WhichOneof("kind") or ""
        self.sent = False  # in this session
        self.response: commands_pb2.Response | None = None
        self.error: Error | None = None

    @property
    def done(self) -> bool:
        return self.response is not None or self.error is not None

    def patience_s(self, timeout_s: float) -> float:
        """How long to wait for the answer, where others may take timeout_s."""
        return timeout_s * _REPLAYING_TIMES if self.kind in _REPLAYING else timeout_s


class Subscription:
    """What is subscribed to, for as long as somebody holds it, across sessions."""

    def __init__(self, request: commands_pb2.Request) -> None:
        self.request = request
        self.world: str = getattr(request, request.WhichOneof("kind") or "").world
        self.server_id: int | None = None  # in this session, once accepted
        self.pending: Pending | None = None
        self.refused: Error | None = None  # the server's last word
        self.sessions = 0  # in which it was accepted
        self.rate_hz = 0.0  # pictures: that holds
        self.ended = False
        self.arrived: collections.deque[Any] = collections.deque()  # events or Snapshot, the oldest first
        self._lost = 0  # events that were not kept

    def take_event(self) -> stream_pb2.Event | None:
        if self._lost:
            lost, self._lost = self._lost, 0
            return stream_pb2.Event(events_dropped=stream_pb2.EventsDropped(dropped_count=lost))
        return self.arrived.popleft() if self.arrived else None

    def keep_event(self, event: stream_pb2.Event) -> None:
        self.arrived.append(event)
        if len(self.arrived) > EVENTS_KEPT:
            self.arrived.popleft()
            self._lost += 1

    @property
    def has_any(self) -> bool:
        return bool(self.arrived or self._lost)


@dataclasses.dataclass
class _Sight:
    """What is seen of one island for one subscription of this session."""

    decoder: picture_decoder.FrameDecoder = dataclasses.field(default_factory=picture_decoder.FrameDecoder)
    keyframe_needed: bool = False
    keyframe_requests: int = 0  # since a picture could be decoded


class Core:
    """See above."""

    def __init__(self, *, token: str, client_name: str, server: object) -> None:
        self._hello = session_pb2.ClientMessage(
            hello=session_pb2.Hello(
                protocol_version=PROTOCOL_VERSION, client_name=client_name, client_version=__version__, token=token
            )
        )
        self._server = server  # where it is, for people
        self.client_key = secrets.token_hex(16)
        self.welcome: session_pb2.Welcome | None = None  # of the last server
        self.connected = False  # welcomed, on the line there is now
        self.failed: Error | None = None  # why there will be no other session
        self.loss: Error | None = None  # why there is no line, after one was lost
        self.damaged_snapshot_count = 0  # thrown away because they could not be decoded
        self._outgoing = bytearray()
        self._reader = framing.FrameReader()
        self._last_request_id = 0
        self._pending: dict[int, Pending] = {}  # by request_id, in the order in which they were asked
        self._first: set[int] = set()  # of those: go before the others
        self._in_flight: set[int] = set()  # sent in this session and not answered, nobody may wait any more
        self._late_pasts: set[int] = set()  # requests for one in this session that nobody waits for any more
        self._subscriptions: list[weakref.ref[Subscription]] = []
        self._of_server_id: dict[int, weakref.ref[Subscription]] = {}
        self._sights: dict[tuple[int, int], _Sight] = {}  # by server_id and island

    # ---- the line -------------------------------------------------------------------------------------------------

    def opened(self) -> None:
        """There is a new line."""
        self._outgoing.clear()
        self._reader = framing.FrameReader()
        self._send(self._hello)

    def received(self, data: bytes | bytearray | memoryview) -> None:
        """What came. NoConnection, DamagedData: the line is of no use any more; tell lost() of it."""
        self._reader.feed(data)
        try:
            for channel, body in self._reader.frames():
                if channel == framing.CONTROL:
                    self._take_control(session_pb2.ServerMessage.FromString(body))
                elif self.connected:
                    self._take_picture(stream_pb2.SnapshotFrame.FromString(body))
                else:
                    raise DamagedData("it began with a picture")
        except (google.protobuf.message.DecodeError, DamagedData) as error:
            what = error.message if isinstance(error, DamagedData) else "a message cannot be read"
            if self.connected:
                raise DamagedData(f"{self._server} sent damaged data: {what}") from None
            self.failed = DamagedData(f"{self._server} is not an evod server: {what}")
            raise self.failed from None

    def lost(self, error: Error) -> None:
        """The line has ended; or one that was to be opened was not. If `failed` is not set now, open another."""
        self.connected, self.loss = False, error
        self._outgoing.clear()
        self._in_flight.clear()
        self._late_pasts.clear()
        self._of_server_id.clear()
        self._sights.clear()
        for subscription in self._live_subscriptions():
            subscription.server_id = subscription.pending = None
            if subscription.request.HasField("subscribe_snapshots"):
                subscription.arrived.clear()  # to acknowledge them in another session would mean others
        for request_id, pending in list(self._pending.items()):
            subscribing = pending.kind.startswith("subscribe_")
            if self.failed is not None or subscribing or pending.sent and pending.kind in _OF_THE_SESSION:
                del self._pending[request_id]
                self._first.discard(request_id)
                pending.error = NoConnection(error.message, error.code, error.violations)
            pending.sent = False

    def close(self) -> None:
        """Nothing is wanted any more."""
        self.failed = NoConnection("the connection was closed here")
        self.lost(self.failed)

    def outgoing(self) -> bytes:
        """What is to be sent now; taken."""
        data = bytes(self._outgoing)
        self._outgoing.clear()
        return data

    # ---- requests -------------------------------------------------------------------------------------------------

    def request(self, request: commands_pb2.Request, *, first: bool = False) -> Pending:
        """Asks, now or once there is a session. request_id and client_key are set here. Error: it cannot be sent."""
        if self.failed is not None:
            raise NoConnection(self.failed.message, self.failed.code, self.failed.violations)
        request_id = self._last_request_id + 1
        request.request_id, request.client_key = request_id, self.client_key
        body = session_pb2.ClientMessage(request=request).SerializeToString()
        limits = self.welcome.limits if self.welcome else None
        most = limits.control_frame_bytes_max if limits else 1 << 20
        if len(body) > most:
            raise Error(f"the request is {len(body)} bytes long; the server takes {most}")
        self._last_request_id = request_id
        pending = self._pending[request_id] = Pending(request, framing.encode(body))
        if first:
            self._first.add(request_id)
        self._send_waiting()
        return pending

    def forget(self, pending: Pending) -> None:
        """Nobody waits for it any more. A past that it opens all the same is closed when its name is known."""
        self._pending.pop(pending.request.request_id, None)
        self._first.discard(pending.request.request_id)
        if pending.kind == "open_replay" and pending.sent and not pending.done:
            self._late_pasts.add(pending.request.request_id)

    # ---- subscriptions --------------------------------------------------------------------------------------------

    def subscribe(self, request: commands_pb2.Request) -> Subscription:
        """Asks now or once there is a session, and again in each new one, until unsubscribe() or nobody holds it."""
        if self.failed is not None:
            raise NoConnection(self.failed.message, self.failed.code, self.failed.violations)
        subscription = Subscription(request)
        self._subscriptions.append(weakref.ref(subscription))
        if self.connected:
            self._ask_for(subscription)
        return subscription

    def unsubscribe(self, subscription: Subscription) -> None:
        subscription.ended = True
        self._subscriptions = [known for known in self._subscriptions if known() not in (None, subscription)]
        if subscription.server_id is not None:
            self._unsubscribe_from(subscription.server_id)

    def acknowledge(self, subscription: Subscription, snapshot: Snapshot) -> None:
        """The picture has been dealt with: another one may come."""
        if subscription.server_id is not None and snapshot.sequence:
            self._send(
                session_pb2.ClientMessage(
                    acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
                        subscription_id=subscription.server_id, island=snapshot.island, sequence=snapshot.sequence
                    )
                )
            )

    # ---- within ---------------------------------------------------------------------------------------------------

    def _send(self, message: session_pb2.ClientMessage) -> None:
        self._outgoing += framing.encode(message.SerializeToString())

    def _send_waiting(self) -> None:
        """Sends what has not been sent, as far as the server's limit on unanswered requests goes."""
        if not self.connected or self.welcome is None:
            return
        # An answer counts for the server until it knows that it has been sent: we may have it, and ask again, before that.
        most = max(1, (self.welcome.limits.requests_in_flight_max or 32) // 2)
        for of_first in (True, False) if self._first else (False,):
            for request_id, pending in self._pending.items():
                if len(self._in_flight) >= most:
                    return
                if not pending.sent and (request_id in self._first) == of_first:
                    pending.sent = True
                    self._in_flight.add(request_id)
                    self._outgoing += pending.frame

    def _take_control(self, message: session_pb2.ServerMessage) -> None:
        kind = message.WhichOneof("kind")
        if not self.connected:
            self._take_first(message, kind)
        elif kind == "response":
            self._take_response(message.response)
        elif kind == "event":
            self._take_event(message.event)
        elif kind == "goodbye":
            error = refusal(message.goodbye.status)
            if error.code == commands_pb2.CODE_UNAUTHENTICATED:
                self.failed = NoConnection(error.message, error.code, error.violations)
            raise NoConnection(error.message, error.code, error.violations)

    def _take_first(self, message: session_pb2.ServerMessage, kind: str | None) -> None:
        if kind == "goodbye":
            error = refusal(message.goodbye.status)
            refused = NoConnection(
                f"the server at {self._server} refused us: {error.message}", error.code, error.violations
            )
            if error.code not in (commands_pb2.CODE_RESOURCE_EXHAUSTED, commands_pb2.CODE_UNAVAILABLE):
                self.failed = refused
            raise refused
        if kind != "welcome":
            raise DamagedData("it did not begin with a welcome")
        if message.welcome.protocol_version != PROTOCOL_VERSION:
            self.failed = NoConnection(
                f"the server at {self._server} speaks protocol version {message.welcome.protocol_version}, this package "
                f"version {PROTOCOL_VERSION}: use a package of the server's version"
            )
            raise self.failed
        self.welcome, self.connected, self.loss = message.welcome, True, None
        # What was subscribed before comes first, so that nobody misses what the requests bring about.
        for subscription in self._live_subscriptions():
            self._ask_for(subscription)
        self._send_waiting()

    def _take_response(self, response: commands_pb2.Response) -> None:
        self._in_flight.discard(response.request_id)
        self._first.discard(response.request_id)
        if response.request_id in self._late_pasts:
            self._late_pasts.discard(response.request_id)
            if response.HasField("world"):
                self.request(commands_pb2.Request(close_replay=commands_pb2.CloseReplay(world=response.world.name)))
        pending = self._pending.get(response.request_id)
        if pending is not None and pending.sent:
            del self._pending[response.request_id]
            pending.response = response
            if pending.kind.startswith("subscribe_"):
                self._take_subscription(pending, response)
        self._send_waiting()

    # subscriptions

    def _live_subscriptions(self) -> Iterator[Subscription]:
        self._subscriptions = [known for known in self._subscriptions if known() is not None]
        return (subscription for known in self._subscriptions if (subscription := known()) is not None)

    def _ask_for(self, subscription: Subscription) -> None:
        request = commands_pb2.Request()
        request.CopyFrom(subscription.request)
        subscription.pending = self.request(request, first=True)

    def _take_subscription(self, pending: Pending, response: commands_pb2.Response) -> None:
        server_id = response.subscription.subscription_id
        subscription = next((known for known in self._live_subscriptions() if known.pending is pending), None)
        if response.status.code != commands_pb2.CODE_UNSPECIFIED:
            if subscription is not None:
                subscription.pending, subscription.refused = None, refusal(response.status)
        elif subscription is None:
            self._unsubscribe_from(server_id)
        else:
            subscription.pending, subscription.refused = None, None
            subscription.server_id = server_id
            subscription.rate_hz = response.subscription.rate_hz
            subscription.sessions += 1
            self._of_server_id[server_id] = weakref.ref(subscription)
            if subscription.sessions > 1 and pending.kind == "subscribe_events":
                # Nobody can tell how many there were meanwhile.
                subscription.keep_event(stream_pb2.Event(events_dropped=stream_pb2.EventsDropped()))

    def _unsubscribe_from(self, server_id: int) -> None:
        self._of_server_id.pop(server_id, None)
        self._sights = {key: sight for key, sight in self._sights.items() if key[0] != server_id}
        if self.connected:
            self.request(commands_pb2.Request(unsubscribe=commands_pb2.Unsubscribe(subscription_id=server_id)))

    def _take_event(self, event: stream_pb2.Event) -> None:
        for server_id, known in list(self._of_server_id.items()):
            subscription = known()
            if subscription is None:
                self._unsubscribe_from(server_id)
            elif subscription.request.HasField("subscribe_events"):
                of_all = not subscription.request.subscribe_events.HasField("world")
                if of_all or event.world in ("", subscription.world):
                    subscription.keep_event(event)

    def _take_picture(self, message: stream_pb2.SnapshotFrame) -> None:
        server_id = message.subscription_id
        known = self._of_server_id.get(server_id)
        if known is None:
            return  # unsubscribed while it was on its way
        subscription = known()
        if subscription is None:
            self._unsubscribe_from(server_id)
            return
        sight = self._sights.setdefault((server_id, message.island), _Sight())
        told_from_others = message.codec == stream_pb2.CODEC_DELTA and (
            message.base_sequence or any(tile.base_sequence for tile in message.tiles)
        )
        snapshot = None
        if not (told_from_others and sight.keyframe_needed):
            try:
                snapshot = sight.decoder.decode(message)
            except DamagedData:
                self.damaged_snapshot_count += 1
                sight.keyframe_needed = True
                # A server whose keyframes are damaged too is not asked again and again.
                if message.codec == stream_pb2.CODEC_DELTA and sight.keyframe_requests < _KEYFRAME_REQUESTS_MAX:
                    sight.keyframe_requests += 1
                    self.request(
                        commands_pb2.Request(request_keyframe=commands_pb2.RequestKeyframe(subscription_id=server_id)),
                        first=True,
                    )
        if snapshot is None:
            self._send(
                session_pb2.ClientMessage(
                    acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
                        subscription_id=server_id, island=message.island, sequence=message.sequence
                    )
                )
            )
            return
        sight.keyframe_needed, sight.keyframe_requests = False, 0
        subscription.arrived.append(snapshot)
