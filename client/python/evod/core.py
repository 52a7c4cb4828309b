"""The client side of the protocol, as a state machine without sockets, clocks and threads.

The code that owns the socket calls opened(), received() and lost(), and sends the bytes that outgoing() returns.
Callers pass requests and subscriptions to a Core, and find the answers, events and snapshots in Pending and
Subscription. After a reconnect the core sends its Hello, subscribes again, and repeats every unanswered request with
the same client_key and request_id. The repetition is idempotent, because the server has a reply cache: it applies each
command once. Requests that contain an id of their session fail with it: those about subscriptions, exports and replays.

Members      More than 30: requests, subscriptions and streams of snapshots begin and end together with a session, so
             each of its methods changes several of them.

Threads      none of its own. Only one thread at a time may call a Core.
Bounds       Requests beyond the server's limit are queued here. A subscription keeps the newest EVENTS_KEPT events and
             reports dropped ones by an EventsDropped. A snapshot is acknowledged when the caller takes it; therefore at
             most UNACKNOWLEDGED_MAX snapshots of an island are in flight.
"""
from __future__ import annotations

import collections
import dataclasses
import secrets
import weakref
from typing import Any, Iterator

import google.protobuf.message

from evod import framing, snapshot_decoder
from evod.errors import DamagedData, Error, InvalidArgument, NoConnection, Unauthenticated, damaged_world, refusal
from evod.snapshots import Snapshot
from evod.v1 import commands_pb2, session_pb2, stream_pb2
from evod.version import __version__

PROTOCOL_VERSION = 1
EVENTS_KEPT = 10_000
UNACKNOWLEDGED_MAX = 8  # unacknowledged snapshots of each island
_KEYFRAME_REQUESTS_MAX = 3  # consecutive keyframe requests without a decoded snapshot in between

#: Requests for which the server may have to simulate generations again; their timeout is longer.
_REPLAY_REQUESTS = frozenset(("open_replay", "seek", "get_breeding", "export_run", "continue_export"))
_REPLAY_TIMEOUT_FACTOR = 20

#: Requests that contain an id which is valid only in its session. They fail when the session ends, and are not
#: repeated.
_SESSION_REQUESTS = frozenset(("unsubscribe", "request_keyframe", "set_view", "continue_export"))

#: A Goodbye with one of these codes ends the client: another session would end for the same reason.
_FINAL_CODES = (
    commands_pb2.CODE_UNAUTHENTICATED,
    commands_pb2.CODE_PERMISSION_DENIED,
    commands_pb2.CODE_INVALID_ARGUMENT,
)


def _replay_in(request: commands_pb2.Request) -> str:
    """Returns the name of the replay that a request names as its world: "default@3"; "" if it names none.

    A replay ends with its session. Another session may use the name for another replay.
    """
    kind = request.WhichOneof("kind")
    world: str = getattr(getattr(request, kind), "world", "") if kind else ""
    return world if "@" in world else ""


def _replay_has_ended(replay: str) -> Error:
    """Returns the error for a replay of an earlier session, as the server states it if it does not know the replay."""
    return refusal(commands_pb2.Status(code=commands_pb2.CODE_NOT_FOUND, reason=commands_pb2.REASON_WORLD_NOT_FOUND,
                                       message=f"the replay {replay} has ended with its session"))


def _no_connection(error: Error) -> NoConnection:
    kind = Unauthenticated if error.code == commands_pb2.CODE_UNAUTHENTICATED else NoConnection
    return kind(error.message, error.violations, error.code)


class Pending:
    """A request and its result: `response` after the server has answered, or `error` if no answer can arrive any
    more."""

    def __init__(self, request: commands_pb2.Request, frame: bytes) -> None:
        self.request, self.frame = request, frame
        self.kind: str = request.WhichOneof("kind") or ""
        self.ends_with_session = self.kind in _SESSION_REQUESTS or _replay_in(request) != ""
        self.sent = False  # whether it was sent in this session
        self.response: commands_pb2.Response | None = None
        self.error: Error | None = None

    @property
    def done(self) -> bool:
        """Whether there is a response or an error."""
        return self.response is not None or self.error is not None

    def timeout_s(self, usual_s: float) -> float:
        """Returns the timeout of this request. usual_s is the timeout if the server need not replay a run."""
        return usual_s * _REPLAY_TIMEOUT_FACTOR if self.kind in _REPLAY_REQUESTS else usual_s


class Subscription:
    """A subscription that continues after a reconnect. It ends with unsubscribe(), or when it is garbage collected."""

    def __init__(self, request: commands_pb2.Request) -> None:
        self.request = request
        self.world: str = getattr(request, request.WhichOneof("kind") or "").world
        self.server_id: int | None = None  # id of the subscription in this session; None: not accepted yet
        self.pending: Pending | None = None
        self.refused: Error | None = None  # the error if the server has refused the subscription
        self.sessions = 0  # number of sessions in which the server accepted it
        self.rate_hz = 0.0  # snapshots per second that the server granted
        self.ended = False
        self.arrived: collections.deque[Any] = collections.deque()  # Event or Snapshot objects, the oldest first
        self._lost = 0  # number of events that this object dropped since the last EventsDropped

    def take_event(self) -> stream_pb2.Event | None:
        """Removes and returns the oldest event, or first an EventsDropped if events were dropped; None if there is
        none."""
        if self._lost:
            lost, self._lost = self._lost, 0
            return stream_pb2.Event(events_dropped=stream_pb2.EventsDropped(dropped_count=lost))
        return self.arrived.popleft() if self.arrived else None

    def add_event(self, event: stream_pb2.Event) -> None:
        """Appends an event. If there are more than EVENTS_KEPT, drops the oldest."""
        self.arrived.append(event)
        if len(self.arrived) > EVENTS_KEPT:
            self.arrived.popleft()
            self._lost += 1

    @property
    def has_event(self) -> bool:
        """Whether take_event() returns an event."""
        return bool(self.arrived or self._lost)


@dataclasses.dataclass
class _StreamState:
    """The snapshot stream for one subscription and one island, in this session."""

    decoder: snapshot_decoder.SnapshotDecoder = dataclasses.field(default_factory=snapshot_decoder.SnapshotDecoder)
    keyframe_needed: bool = False
    keyframe_requests: int = 0  # number of keyframe requests since the last decoded snapshot


class Core:
    """The state of one client. Error messages contain `server`."""

    def __init__(self, *, token: str = "", join: session_pb2.Join | None = None, client_name: str,
                 server: object) -> None:
        self._hello = session_pb2.ClientMessage(
            hello=session_pb2.Hello(
                protocol_version=PROTOCOL_VERSION, client_name=client_name, client_version=__version__, token=token,
                join=join
            )
        )
        self._server = server
        self.client_key = secrets.token_hex(16)
        self.welcome: session_pb2.Welcome | None = None  # received in the current or the last session
        self.connected = False  # whether the server has sent its Welcome on the current connection
        self.failed: Error | None = None  # why reconnecting is pointless; None: the client may reconnect
        self.loss: Error | None = None  # why there is no session at present
        self.retry_late = False  # the server is full: reconnect only after the longest wait
        self.damaged_snapshot_count = 0  # snapshots dropped because they could not be decoded
        self._outgoing = bytearray()
        self._reader = framing.FrameReader()
        self._last_request_id = 0
        self._pending: dict[int, Pending] = {}  # requests by request_id, in the order of the calls
        self._first: set[int] = set()  # ids of the requests to send before all other requests
        # ids of unanswered requests of this session, even if no caller waits for them
        self._in_flight: set[int] = set()
        self._abandoned_replays: set[int] = set()  # ids of unanswered OpenReplay requests whose callers no longer wait
        self._own_replays: set[str] = set()  # names of the replays that this session has opened
        self._ended_replays: set[str] = set()  # names of the replays that earlier sessions have opened
        self._subscriptions: list[weakref.ref[Subscription]] = []
        self._of_server_id: dict[int, weakref.ref[Subscription]] = {}
        self._streams: dict[tuple[int, int], _StreamState] = {}  # keys: server_id and island

    # ---- the connection -------------------------------------------------------------------------------------------

    def opened(self) -> None:
        """Queues the Hello. Call it after connecting."""
        self._outgoing.clear()
        self._reader = framing.FrameReader()
        self.retry_late = False
        self._send(self._hello)

    def received(self, data: bytes | bytearray | memoryview) -> None:
        """Processes bytes from the server. If it raises NoConnection or DamagedData, close the connection and call
        lost()."""
        self._reader.feed(data)
        try:
            for channel, body in self._reader.frames():
                if channel == framing.CONTROL:
                    self._take_control(session_pb2.ServerMessage.FromString(body))
                elif self.connected:
                    self._take_snapshot(stream_pb2.SnapshotFrame.FromString(body))
                else:
                    raise DamagedData("the first frame is a snapshot, not a Welcome")
        except (google.protobuf.message.DecodeError, DamagedData) as error:
            what = error.message if isinstance(error, DamagedData) else "a message cannot be read"
            if self.connected:
                raise DamagedData(f"{self._server} sent damaged data: {what}") from None
            self.failed = DamagedData(f"{self._server} is not an evod server: {what}")
            raise self.failed from None

    def lost(self, error: Error) -> None:
        """Call it when the connection was lost or could not be opened. Reconnect afterwards, unless `failed` is set."""
        self.connected, self.loss = False, error
        self._outgoing.clear()
        self._in_flight.clear()
        self._abandoned_replays.clear()
        self._of_server_id.clear()
        self._streams.clear()
        self._ended_replays |= self._own_replays
        self._own_replays.clear()
        had_session = self.welcome is not None
        for subscription in self._live_subscriptions():
            subscription.server_id = subscription.pending = None
            if subscription.request.HasField("subscribe_snapshots"):
                subscription.arrived.clear()  # the sequence numbers of the snapshots are not valid in another session
        for request_id, pending in list(self._pending.items()):
            subscribing = pending.kind.startswith("subscribe_")
            if self.failed is not None or subscribing or had_session and pending.ends_with_session:
                del self._pending[request_id]
                self._first.discard(request_id)
                pending.error = _no_connection(error)
            pending.sent = False

    def close(self) -> None:
        """All pending requests fail. The client cannot be used again."""
        self.failed = NoConnection("the connection was closed here")
        self.lost(self.failed)

    def outgoing(self) -> bytes:
        """Removes and returns the bytes to send now."""
        data = bytes(self._outgoing)
        self._outgoing.clear()
        return data

    # ---- requests -------------------------------------------------------------------------------------------------

    def request(self, request: commands_pb2.Request, *, first: bool = False) -> Pending:
        """Queues a request, which is sent when there is a session. Sets its request_id and client_key.

        Raises NoConnection if the client is closed or has failed, or if the request contains an id of a session and
        there is none; NotFound if it names a replay of an earlier session; InvalidArgument if it is longer than the
        server allows.
        """
        if self.failed is not None:
            raise _no_connection(self.failed)
        if (replay := _replay_in(request)) in self._ended_replays:
            raise _replay_has_ended(replay)
        if self.loss is not None and self.welcome is not None and (replay
                                                                   or request.WhichOneof("kind") in _SESSION_REQUESTS):
            raise _no_connection(self.loss)
        request_id = self._last_request_id + 1
        request.request_id, request.client_key = request_id, self.client_key
        body = session_pb2.ClientMessage(request=request).SerializeToString()
        stated = self.welcome.limits.control_frame_bytes_max if self.welcome else 0
        limit = stated or 1 << 20  # until the server has stated its limit
        if len(body) > limit:
            raise InvalidArgument(f"the request is {len(body)} bytes long, allowed at most {limit}")
        self._last_request_id = request_id
        pending = self._pending[request_id] = Pending(request, framing.encode(body))
        if first:
            self._first.add(request_id)
        self._send_waiting()
        return pending

    def forget(self, pending: Pending) -> None:
        """Call it when the caller no longer waits. The core closes a replay that the request opens."""
        self._pending.pop(pending.request.request_id, None)
        self._first.discard(pending.request.request_id)
        if pending.kind == "open_replay" and pending.sent and not pending.done:
            self._abandoned_replays.add(pending.request.request_id)

    # ---- subscriptions --------------------------------------------------------------------------------------------

    def subscribe(self, request: commands_pb2.Request) -> Subscription:
        """Subscribes when there is a session, and again in each new session, until the subscription ends."""
        if self.failed is not None:
            raise _no_connection(self.failed)
        subscription = Subscription(request)
        self._subscriptions.append(weakref.ref(subscription))
        if self.connected:
            self._resubscribe(subscription)
        return subscription

    def unsubscribe(self, subscription: Subscription) -> None:
        """Ends the subscription."""
        subscription.ended = True
        self._subscriptions = [reference for reference in self._subscriptions
                               if reference() not in (None, subscription)]
        if subscription.server_id is not None:
            self._unsubscribe_from(subscription.server_id)

    def acknowledge(self, subscription: Subscription, snapshot: Snapshot) -> None:
        """Acknowledges a snapshot, so that the server can send another one."""
        if subscription.server_id is not None and snapshot.sequence:
            self._send(
                session_pb2.ClientMessage(
                    acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
                        subscription_id=subscription.server_id, island=snapshot.island, sequence=snapshot.sequence
                    )
                )
            )

    # ---- private --------------------------------------------------------------------------------------------------

    def _send(self, message: session_pb2.ClientMessage) -> None:
        self._outgoing += framing.encode(message.SerializeToString())

    def _send_waiting(self) -> None:
        """Sends queued requests, up to half of the server's limit on unanswered requests."""
        if not self.connected or self.welcome is None:
            return
        # The server counts a request until it has sent the complete answer. The answer may arrive here before the
        # server stops counting the request.
        limit = max(1, (self.welcome.limits.requests_in_flight_max or 32) // 2)
        for urgent in (True, False) if self._first else (False,):
            for request_id, pending in self._pending.items():
                if len(self._in_flight) >= limit:
                    return
                if not pending.sent and (request_id in self._first) == urgent:
                    pending.sent = True
                    self._in_flight.add(request_id)
                    self._outgoing += pending.frame

    def _take_control(self, message: session_pb2.ServerMessage) -> None:
        kind = message.WhichOneof("kind")
        if not self.connected:
            self._take_welcome(message, kind)
        elif kind == "response":
            self._take_response(message.response)
        elif kind == "event":
            self._take_event(message.event)
        elif kind == "goodbye":
            error = refusal(message.goodbye.status)
            self.retry_late = error.code == commands_pb2.CODE_RESOURCE_EXHAUSTED
            if error.code in _FINAL_CODES:
                self.failed = _no_connection(error)
            raise _no_connection(error)

    def _take_welcome(self, message: session_pb2.ServerMessage, kind: str | None) -> None:
        if kind == "goodbye":
            error = refusal(message.goodbye.status)
            refused = _no_connection(error)
            refused.message = f"the server at {self._server} refused this client: {error.message}"
            self.retry_late = error.code == commands_pb2.CODE_RESOURCE_EXHAUSTED
            if error.code not in (commands_pb2.CODE_RESOURCE_EXHAUSTED, commands_pb2.CODE_UNAVAILABLE):
                self.failed = refused
            raise refused
        if kind != "welcome":
            raise DamagedData("the first message is not a Welcome")
        if message.welcome.protocol_version != PROTOCOL_VERSION:
            self.failed = NoConnection(
                f"the server at {self._server} uses protocol version {message.welcome.protocol_version}, but this "
                "package uses "
                f"{PROTOCOL_VERSION}: install the package of the server's version"
            )
            raise self.failed
        self.welcome, self.loss = message.welcome, None
        if token := message.welcome.membership.token:  # later sessions are of the same member
            self._hello.hello.ClearField("join")
            self._hello.hello.token = token
        # All subscriptions are sent first, so that subscribers receive the events that the other requests cause.
        for subscription in self._live_subscriptions():
            self._resubscribe(subscription)
        self.connected = True
        self._send_waiting()

    def _take_response(self, response: commands_pb2.Response) -> None:
        self._in_flight.discard(response.request_id)
        self._first.discard(response.request_id)
        if response.request_id in self._abandoned_replays:
            self._abandoned_replays.discard(response.request_id)
            if response.HasField("world"):
                self.request(commands_pb2.Request(close_replay=commands_pb2.CloseReplay(world=response.world.name)))
        pending = self._pending.get(response.request_id)
        if pending is not None and pending.sent:
            del self._pending[response.request_id]
            pending.response = response
            if pending.kind == "open_replay" and response.HasField("world"):
                self._own_replays.add(response.world.name)
                self._ended_replays.discard(response.world.name)
            if pending.kind.startswith("subscribe_"):
                self._take_subscription(pending, response)
        self._send_waiting()

    # subscriptions

    def _live_subscriptions(self) -> Iterator[Subscription]:
        self._subscriptions = [reference for reference in self._subscriptions if reference() is not None]
        return (subscription for reference in self._subscriptions if (subscription := reference()) is not None)

    def _resubscribe(self, subscription: Subscription) -> None:
        replay = _replay_in(subscription.request)
        if replay in self._ended_replays or replay and subscription.sessions:
            subscription.refused = _replay_has_ended(replay)
            return
        request = commands_pb2.Request()
        request.CopyFrom(subscription.request)
        subscription.pending = self.request(request, first=True)

    def _take_subscription(self, pending: Pending, response: commands_pb2.Response) -> None:
        server_id = response.subscription.subscription_id
        subscription = next((live for live in self._live_subscriptions() if live.pending is pending), None)
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
                # The number of events missed between the sessions is not known, so the count is 0.
                subscription.add_event(stream_pb2.Event(events_dropped=stream_pb2.EventsDropped()))

    def _unsubscribe_from(self, server_id: int) -> None:
        self._of_server_id.pop(server_id, None)
        self._streams = {key: stream for key, stream in self._streams.items() if key[0] != server_id}
        if self.connected:
            self.request(commands_pb2.Request(unsubscribe=commands_pb2.Unsubscribe(subscription_id=server_id)))

    def _take_event(self, event: stream_pb2.Event) -> None:
        damaged = event.HasField("world_damaged")
        for server_id, reference in list(self._of_server_id.items()):
            subscription = reference()
            if subscription is None:
                self._unsubscribe_from(server_id)
            elif subscription.request.HasField("subscribe_events"):
                all_worlds = not subscription.request.subscribe_events.HasField("world")
                if all_worlds or event.world in ("", subscription.world):
                    subscription.add_event(event)
            elif damaged and event.world == subscription.world:
                subscription.refused = damaged_world(event)  # it receives no further snapshots

    def _take_snapshot(self, message: stream_pb2.SnapshotFrame) -> None:
        server_id = message.subscription_id
        reference = self._of_server_id.get(server_id)
        if reference is None:
            return  # the subscription ended while the snapshot was in flight
        subscription = reference()
        if subscription is None:
            self._unsubscribe_from(server_id)
            return
        stream = self._streams.setdefault((server_id, message.island), _StreamState())
        is_delta = message.codec == stream_pb2.CODEC_DELTA and (
            message.base_sequence or any(tile.base_sequence for tile in message.tiles)
        )
        snapshot = None
        if not (is_delta and stream.keyframe_needed):
            try:
                snapshot = stream.decoder.decode(message)
            except DamagedData:
                self.damaged_snapshot_count += 1
                stream.keyframe_needed = True
                # If keyframes are damaged too, requesting more of them does not help.
                if message.codec == stream_pb2.CODEC_DELTA and stream.keyframe_requests < _KEYFRAME_REQUESTS_MAX:
                    stream.keyframe_requests += 1
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
        stream.keyframe_needed, stream.keyframe_requests = False, 0
        subscription.arrived.append(snapshot)
