"""Hostile and failing clients in a separate process, so that their cost does not slow the honest clients.

    attacker.py MESSAGES PORT ATTACK NUMBER [SECONDS]

Prints "ready" once the attack runs. Answers the line "counts" on its standard input with its counts so
far, as JSON. Prints them again at its end, which comes with any other line, the end of the input, or after SECONDS.
It never has more than NUMBER connections, and opens at most 1,000 per second.

    idle N       N sessions that send a Hello and nothing more
    slow N       N connections that send a frame byte by byte; closed ones reconnect
    strangers N  N connections that send nothing; closed ones reconnect
    deaf N       N sessions that subscribe to snapshots and never read them
    pauses N     a viewer of the world w that reads for a second, pauses for N seconds, reads on; if it is closed, it
                 reconnects and counts its bytes from zero
    connects N   N connections per second, each closed at once
    malformed N  N frames per second with invalid bodies, on one session that reads its answers
    churn N      N sessions that subscribe and query for about half a second and disconnect, some without closing; new
                 ones follow
    views N      N viewers of different regions of the world w that read and discard snapshots
    watch N      N viewers of the whole world w that read and discard snapshots
"""
import json
import os
import random
import select
import socket
import struct
import sys
import time

messages_path, port, attack, number = sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
seconds = float(sys.argv[5]) if len(sys.argv) > 5 else 600.0
sys.path.insert(0, messages_path)
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2  # noqa: E402

begun = time.monotonic()
counts = {"connected": 0, "closed": 0, "bytes": 0, "frames": 0}
closed_after_s = []
enough = False
buffer = bytearray(1 << 20)


def framed(message):
    body = message.SerializeToString()
    return b"EV\x01\x01" + struct.pack("<I", len(body)) + body


hello = framed(session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1, client_name="attacker")))


def asking(**request):
    return framed(session_pb2.ClientMessage(request=c.Request(request_id=1, **request)))


def subscribing(view=None):
    return asking(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=20, codec=stream_pb2.CODEC_DELTA,
                                                           compression=stream_pb2.COMPRESSION_NONE, view=view))


class Connection(socket.socket):
    since = 0.0  # time.monotonic()
    position = 0  # of the next byte to send, if bytes are sent one by one
    leaves = 0.0  # time.monotonic()


def connect(i, *sent, receive_bytes=None):
    """Connects from one of many addresses, as if from many machines."""
    connection = Connection()
    if receive_bytes:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_bytes)
    connection.bind((f"127.0.{1 + i // 100 % 200}.{1 + i % 100}", 0))
    connection.connect(("127.0.0.1", port))
    connection.sendall(b"".join(sent))
    connection.setblocking(False)
    connection.since = time.monotonic()
    counts["connected"] += 1
    return connection


def print_counts():
    print(json.dumps({**counts, "seconds": time.monotonic() - begun,
                      "closed_after_s": [min(closed_after_s), max(closed_after_s)] if closed_after_s else []}),
          flush=True)


def over():
    """Whether the attack must end. Also answers "counts"."""
    global enough
    if select.select([0], [], [], 0)[0]:
        if os.read(0, 100) == b"counts\n":
            print_counts()
        else:
            enough = True
    return enough or time.monotonic() - begun > seconds


def take(connection):
    """Reads the available input; False: the connection is closed."""
    try:
        while got := connection.recv_into(buffer):
            counts["bytes"] += got
            if got < len(buffer):
                return True
        return False
    except BlockingIOError:
        return True
    except OSError:
        return False


def ready():
    print("ready", flush=True)


def close(connections, poller, descriptor):
    connection = connections.pop(descriptor)
    poller.unregister(descriptor)
    counts["closed"] += 1
    closed_after_s.append(time.monotonic() - connection.since)
    connection.close()


def hold(make, reads=True, again=False, each_round=None, pause_s=0.2):
    """Keeps so many connections open; reconnects closed ones if `again`."""
    poller, connections, made = select.epoll(), {}, 0

    def add():
        nonlocal made
        connection = make(made)
        made += 1
        connections[connection.fileno()] = connection
        poller.register(connection.fileno(), select.EPOLLRDHUP | select.EPOLLHUP | (select.EPOLLIN if reads else 0))

    def look(wait_s):
        for descriptor, event in poller.poll(wait_s):
            gone = event & (select.EPOLLRDHUP | select.EPOLLHUP | select.EPOLLERR)
            if not gone and take(connections[descriptor]):
                continue
            close(connections, poller, descriptor)
            if again:
                add()

    for _ in range(number):
        add()
    ready()
    while not over():
        look(pause_s)
        if each_round:
            for descriptor in [d for d, connection in connections.items() if not each_round(connection)]:
                close(connections, poller, descriptor)
                if again:
                    add()
    counts["open"] = len(connections)


def slow():
    slow_frame = asking(list_worlds=c.ListWorlds())

    def a_byte_more(connection):
        if time.monotonic() - connection.since < connection.position:
            return True
        try:
            connection.send((slow_frame * 100)[connection.position:connection.position + 1])
        except OSError:
            return False
        connection.position += 1
        return True

    # Half of them send a Hello first.
    hold(lambda i: connect(i, *([hello] if i % 2 else [])), again=True, each_round=a_byte_more)


def connects():
    ready()
    while not over():
        for i in range(max(1, number // 50)):
            connect(counts["connected"]).close()
        time.sleep(max(0.0, begun + counts["connected"] / number - time.monotonic()))


def malformed():
    connection = connect(0, hello)
    batch = (b"EV\x01\x01" + struct.pack("<I", 8) + b"\xff\xfe\xfd\xfc\xfb\xfa\xf9\xf8") * 100
    rest = b""
    ready()
    poller = select.poll()
    poller.register(connection, select.POLLIN | select.POLLOUT)
    while not over():
        for _, event in poller.poll(100):
            if event & select.POLLIN and not take(connection):
                counts["closed"] += 1
                return
            if event & select.POLLOUT:
                due = (time.monotonic() - begun) * number - counts["frames"]
                if not rest and due < 100:
                    time.sleep(0.001)
                    continue
                rest = rest or batch
                try:
                    rest = rest[connection.send(rest):]
                except BlockingIOError:
                    continue
                except OSError:
                    counts["closed"] += 1
                    return
                counts["frames"] += 0 if rest else 100


def churn():
    chance = random.Random(1)
    wishes = [subscribing(), *(subscribing(view(i)) for i in range(3)),
              asking(subscribe_events=c.SubscribeEvents()), asking(get_history=c.GetHistory(world="w")),
              asking(get_organism=c.GetOrganism(world="w")), asking(list_worlds=c.ListWorlds()),
              asking(describe=c.Describe()), asking(get_metrics=c.GetMetrics()),
              asking(open_replay=c.OpenReplay(world="w")),
              asking(unsubscribe=c.Unsubscribe(subscription_id=1)), b"EV\x01\x01\x03\0\0\0\xff\xff\xff"]

    def come(i):
        connection = connect(i, hello, *chance.choices(wishes, k=chance.randrange(8)))
        connection.leaves = connection.since + chance.expovariate(2)
        return connection

    def stays(connection):
        if time.monotonic() < connection.leaves:
            return True
        manner = chance.randrange(3)
        try:
            if manner == 1:  # in the middle of a frame
                connection.send(asking(list_worlds=c.ListWorlds())[:9])
            if manner == 2:  # without closing, and with unread answers
                connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        except OSError:
            pass  # the server closed first
        return False
    hold(come, again=True, each_round=stays, pause_s=0.05)


def pauses():
    viewer = connect(0, hello, subscribing(), receive_bytes=4096)
    ready()
    while not over():
        reads_until = time.monotonic() + 1
        while time.monotonic() < reads_until and not over():
            if select.select([viewer], [], [], 0.05)[0] and not take(viewer):
                counts["closed"] += 1
                viewer.close()
                counts["bytes"] = 0
                viewer = connect(0, hello, subscribing(), receive_bytes=4096)
        counts["paused"] = counts.get("paused", 0) + 1
        reads_again = time.monotonic() + number
        while not over() and time.monotonic() < reads_again:
            select.select([0], [], [], max(0.0, reads_again - time.monotonic()))


def view(i):
    return c.View(region=c.Region(left_px=300.0 * (i % 20), top_px=300.0 * (i // 20 % 20), width_px=1280,
                                  height_px=720))


attacks = {"idle": lambda: hold(lambda i: connect(i, hello)),
           "slow": slow,
           "strangers": lambda: hold(lambda i: connect(i), again=True),
           "pauses": pauses,
           "deaf": lambda: hold(lambda i: connect(i, hello, subscribing(), receive_bytes=4096), reads=False),
           "connects": connects,
           "malformed": malformed,
           "churn": churn,
           "views": lambda: hold(lambda i: connect(i, hello, subscribing(view(i)))),
           "watch": lambda: hold(lambda i: connect(i, hello, subscribing()))}
attacks[attack]()
print_counts()
