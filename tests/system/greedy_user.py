"""A user who takes all that one pool of the server gives, and keeps it: quota_test.py runs this as a separate process.

    greedy_user.py MESSAGES PORT HTTP_PORT TOKEN WORLD ISLANDS POOL

WORLD names a world with a stored run, ISLANDS one of many islands. Prints "ready" when the attack has got what it could
get at first, and continues, also after refusals and closed connections, until its standard input ends. Then it prints
its counts as JSON: "taken" and "refused" requests, "closed" connections (by the server) and "sent_bytes".

Most attacks use SESSIONS sessions with the token. "sessions", "strangers" and "http" open as many connections as they
get.
"""
import itertools
import json
import os
import secrets
import select
import socket
import struct
import sys
import time

messages_path, port, http_port, token, world, islands, pool = sys.argv[1:8]
sys.path.insert(0, messages_path)
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2 as w  # noqa: E402

SESSIONS, IN_FLIGHT, CONNECTIONS = 16, 30, 600
READY_S = 20.0  # the attack counts as running after this time at the latest
counts = {"taken": 0, "refused": 0, "closed": 0, "sent_bytes": 0}
began = time.monotonic()


def framed(message):
    body = message.SerializeToString()
    return b"EV\x01\x01" + struct.pack("<I", len(body)) + body


class Ended(Exception):
    """The standard input has ended, and so does the attack."""


class Connection:
    """A connection that sends without blocking and, if `reads`, handles what arrives."""

    def __init__(self, to_port, sent=b"", reads=True):
        self.socket = socket.socket()
        if not reads:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self.socket.connect(("127.0.0.1", int(to_port)))
        self.socket.setblocking(False)
        self.output, self.input, self.reads, self.open = bytearray(sent), bytearray(), reads, True
        self.flush()

    def flush(self):
        try:
            while self.output:
                sent = self.socket.send(self.output)
                counts["sent_bytes"] += sent
                del self.output[:sent]
        except BlockingIOError:
            pass
        except OSError:
            self.open = False

    def receive(self):
        """Reads once; False: the connection is closed."""
        try:
            data = self.socket.recv(1 << 18)
        except BlockingIOError:
            return True
        except OSError:
            data = b""
        self.input += data
        return bool(data)

    def close(self):
        self.socket.close()


class Session(Connection):
    """A session that keeps `in_flight` requests unanswered. next_request(session, response) returns the next request,
    or None; response is that of the previous one, or None at first."""

    def __init__(self, next_request, in_flight=1, reads=True):
        self.next_request, self.in_flight = next_request, in_flight
        self.id, self.unanswered, self.welcome, self.replays, self.state = 0, 0, False, [], {}
        self.key = secrets.token_hex(8)
        super().__init__(port, framed(session_pb2.ClientMessage(
            hello=session_pb2.Hello(protocol_version=1, client_name="greedy", token=token))), reads)
        if not reads:
            self.fill(None)

    def ask(self, request):
        self.id += 1
        self.unanswered += 1
        request.setdefault("client_key", self.key)
        self.output += framed(session_pb2.ClientMessage(request=c.Request(request_id=self.id, **request)))

    def fill(self, response):
        while self.unanswered < self.in_flight and len(self.output) < 1 << 16:
            request = self.next_request(self, response)
            if request is None:
                break
            self.ask(request)
            response = None
        self.flush()

    def handle(self):
        """Handles the messages in the input; False: the session has ended."""
        while len(self.input) >= 8:
            length = struct.unpack("<I", self.input[4:8])[0]
            if len(self.input) < 8 + length:
                break
            channel, body = self.input[3], bytes(self.input[8:8 + length])
            del self.input[:8 + length]
            if channel != 1:
                continue
            message = session_pb2.ServerMessage.FromString(body)
            if message.HasField("goodbye"):
                return False
            if message.HasField("welcome"):
                self.welcome = True
                self.fill(None)
            elif message.HasField("response"):
                self.unanswered -= 1
                counts["refused" if message.response.status.code else "taken"] += 1
                self.fill(message.response)
        return True


def hold(make, number, ready):
    """Keeps so many connections open, and opens a new one for each that ends. ready(connections): the attack is
    running."""
    poller, connections, said = select.epoll(), {}, False

    def add():
        try:
            connection = make()
        except OSError:
            return
        connections[connection.socket.fileno()] = connection
        poller.register(connection.socket.fileno(), select.EPOLLRDHUP | (select.EPOLLIN if connection.reads else 0))

    poller.register(0, select.EPOLLIN | select.EPOLLHUP)
    retry_at = 0.0
    while True:
        if len(connections) < number and time.monotonic() >= retry_at:
            for _ in range(min(20, number - len(connections))):
                add()
            retry_at = time.monotonic() + 0.02
        for descriptor, event in poller.poll(0.02):
            if descriptor == 0:
                if not os.read(0, 100):
                    raise Ended
                continue
            connection = connections[descriptor]
            gone = bool(event & (select.EPOLLHUP | select.EPOLLERR)) or (not connection.reads
                                                                         and event & select.EPOLLRDHUP)
            if not gone and event & (select.EPOLLIN | select.EPOLLRDHUP) and connection.reads:
                gone = not connection.receive() or (isinstance(connection, Session) and not connection.handle())
            if gone or not connection.open:
                poller.unregister(descriptor)
                connections.pop(descriptor).close()
                counts["closed"] += 1
        for connection in connections.values():
            if isinstance(connection, Session) and connection.welcome and connection.unanswered < connection.in_flight:
                connection.fill(None)
            elif connection.output:
                connection.flush()
        if not said and (ready(connections.values()) or time.monotonic() - began > READY_S):
            said = True
            print("ready", flush=True)


def of_sessions(next_request, in_flight=1, taken=1, number=SESSIONS):
    hold(lambda: Session(next_request, in_flight), number, lambda _: counts["taken"] + counts["refused"] >= taken)


def of_replays(next_request, number=SESSIONS):
    """The attack is ready when each session has opened four replays, or when several were refused."""
    hold(lambda: Session(next_request), number,
         lambda all: sum(len(session.replays) for session in all) >= 4 * number or counts["refused"] >= number)


def replays_of(name, moment, then=(), again=()):
    """Each session opens replays until it is refused, asks each for `then`, and every 50 ms one of them for `again`."""
    def next_request(session, response):
        if response is not None and response.HasField("world") and response.world.HasField("replay"):
            if response.world.name not in session.replays:
                session.replays.append(response.world.name)
                session.state.setdefault("todo", []).extend(request(response.world.name) for request in then)
        if session.state.get("todo"):
            return session.state["todo"].pop(0)
        if time.monotonic() < session.state.get("again", 0.0):
            return None
        session.state["again"] = time.monotonic() + 0.05
        refused = response is not None and response.status.code
        if again and session.replays and (refused or len(session.replays) == 4):
            session.state["round"] = session.state.get("round", -1) + 1
            session.state["todo"] = [request(session.replays[session.state["round"] % len(session.replays)])
                                     for request in again]
            return session.state["todo"].pop(0)
        return {"open_replay": c.OpenReplay(world=name, at=moment)}
    return next_request


def sessions():
    hold(lambda: Session(lambda *_: None), CONNECTIONS,
         lambda all: sum(session.welcome for session in all) and counts["closed"] > 20)


def strangers():
    hold(lambda: Connection(port), CONNECTIONS, lambda all: counts["closed"] > 20)


def http():
    numbers = itertools.count()
    requests = (b"", b"GET / HTTP/1.1\r\nHost: 127.0.0.1",
                b"GET /page.js HTTP/1.1\r\nHost: 127.0.0.1:%s\r\n\r\n" % http_port.encode())
    hold(lambda: Connection(http_port, requests[next(numbers) % 3], reads=False), CONNECTIONS,
         lambda all: len(all) >= 60 or counts["closed"] > 20)


AT_MAX = (lambda name: {"set_speed": c.SetSpeed(world=name, speed=w.Speed(max=True))},
          lambda name: {"run": c.Run(world=name)})


def seeks():
    numbers = itertools.count()

    def next_request(session, _):
        # The last ticks of a long generation have to be simulated from its beginning.
        return {"open_replay": c.OpenReplay(world="long", at=c.RunMoment(generation=1, tick=FAR - next(numbers) % 100))}
    hold(lambda: Session(next_request, 4), SESSIONS,
         lambda all: sum(session.unanswered for session in all) >= 4 * SESSIONS
         or counts["taken"] + counts["refused"] > 0)


def simulated_exports():
    """Exports of generations that have to be simulated again."""
    def next_request(*_):
        return {"export_run": c.ExportRun(world="sparse", table=c.RUN_TABLE_ORGANISMS, format=c.TEXT_FORMAT_CSV)}
    hold(lambda: Session(next_request), SESSIONS,
         lambda all: sum(session.unanswered for session in all) >= SESSIONS or counts["taken"] + counts["refused"] > 0)


def queries():
    numbers, kinds = itertools.count(), (
        {"get_history": c.GetHistory(world=world)}, {"get_population": c.GetPopulation(world=world)},
        {"get_history": c.GetHistory(world=islands)}, {"get_population": c.GetPopulation(world=islands)})
    of_sessions(lambda *_: dict(kinds[next(numbers) % len(kinds)]), IN_FLIGHT, taken=SESSIONS * IN_FLIGHT)


def frames():
    """The longest messages that a viewer may send, with as many parts as possible."""
    parts = [w.ParameterAssignment()] * ((63 << 10) // 2)
    of_sessions(lambda *_: {"create_world": c.CreateWorld(name="x", parameters=parts)}, 4, taken=SESSIONS)


def memory():
    """Sessions that ask for many islands, and do not read."""
    def next_request(session, _):
        number = session.id
        if number < 4:
            return {"subscribe_snapshots": c.SubscribeSnapshots(
                world=islands, rate_hz=1 + number, codec=stream_pb2.CODEC_DELTA,
                                                                view=c.View(detail=stream_pb2.DETAIL_DENSITY))}
        if number % 50 == 0:
            return {"get_population": c.GetPopulation(world="big")}
        return {"request_keyframe": c.RequestKeyframe(subscription_id=1 + number % 4)}

    def make():
        session = Session(next_request, 1 << 30, reads=False)
        session.welcome = True
        return session
    hold(make, 3 * SESSIONS, lambda all: time.monotonic() - began > 5)


def events():
    """Replays of short generations at maximum speed, half as many as there may be, and subscriptions to their
    events."""
    subscribe = (lambda name: {"subscribe_events": c.SubscribeEvents(world=name)},
                 lambda _: {"subscribe_events": c.SubscribeEvents()})
    again = (lambda name: {"seek": c.Seek(world=name, to=c.RunMoment(generation=1))}, AT_MAX[1])
    of_replays(replays_of(world, c.RunMoment(generation=1), subscribe + AT_MAX, again), SESSIONS // 2)


FAR = int(os.environ.get("FAR_TICK", 100))
attacks = {attack.__name__: attack for attack in (
    sessions, strangers, http, seeks, simulated_exports, queries, frames, memory, events)}
if __name__ == "__main__":
    try:
        attacks[pool]()
    except Ended:
        print(json.dumps(counts), flush=True)
