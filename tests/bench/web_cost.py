"""Measures what the page costs a browser, and what viewers in browsers cost the server, with a real evod.

    web_cost.py EVOD MESSAGES [--organisms N ...] [--seconds S] [--viewers N] [--json]

For each number of organisms a headless Chromium without a GPU (ANGLE's SwiftShader) shows a world of the benchmark
world's density at real time. Decoding and drawing are those of the last 200 snapshots and frames in the worker; `first`
is the time from the navigation until the first snapshot is drawn, of a new browser and of a reload; the heaps of page
and worker are read after a garbage collection, when the page has settled and after the seconds of measurement.

With --viewers N instead: N clients like browsers (WebSockets, masked frames, at most 2 unacknowledged snapshots, 30 a
second, deltas without compression) watch a world of 50 organisms each at real time. The figures are the processor time
of the server's threads, and how much slower than real time the worlds ran.
"""
import argparse
import contextlib
import http.client
import json
import pathlib
import re
import selectors
import socket
import struct
import sys
import threading
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="folder of the Python message classes: build/release/tests/system")
parser.add_argument("--organisms", type=int, nargs="+", default=[50, 10_000, 100_000])
parser.add_argument("--seconds", type=float, default=20, help="of each measurement")
parser.add_argument("--viewers", type=int, help="number of clients; no browser is needed")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
system_tests = pathlib.Path(__file__).resolve().parents[1] / "system"
sys.path[:0] = [options.messages, str(system_tests), str(system_tests / "web")]

from bench_client import Server, assignments, benchmark_world, print_figures  # noqa: E402
import websocket_client  # noqa: E402
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2  # noqa: E402


def serve():
    """A server with a page, whose port is page_port."""
    server = Server(options.evod, "--keep-nothing", "--http-port", "0")
    server.page_port = server.control.welcome.page_port
    return server


def create(server, name, organisms):
    parameters = {"population_size": organisms} if organisms == 50 else benchmark_world(organisms)
    server.control.call(create_world=c.CreateWorld(name=name, seed=1, parameters=assignments(parameters)))
    server.control.call(run=c.Run(world=name))


# ---- the browser
# -------------------------------------------------------------------------------------------------------


class Heaps:
    """The heaps of the page and of its worker after a garbage collection, through Chromium's debugging port."""

    def __init__(self, browser):
        address = browser.driver.capabilities["goog:chromeOptions"]["debuggerAddress"]
        connection = http.client.HTTPConnection(address)
        connection.request("GET", "/json/version")
        path = json.loads(connection.getresponse().read())["webSocketDebuggerUrl"].split(address, 1)[1]
        host, port = address.rsplit(":", 1)
        debugger = socket.create_connection((host, int(port)))
        debugger.sendall(websocket_client.handshake(port, Origin=None).replace(b"/session", path.encode()))
        self.socket, self.id = websocket_client.WebSocket(debugger), 0
        targets = self.call("Target.getTargets")["targetInfos"]
        self.sessions = {}
        for target in targets:
            if target["type"] in ("page", "worker") and "127.0.0.1" in target["url"]:
                attached = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)
                self.sessions[target["type"]] = attached["sessionId"]

    def call(self, method, session=None, **parameters):
        self.id += 1
        request = {"id": self.id, "method": method, "params": parameters, **({"sessionId": session} if session else {})}
        self.socket.send_raw(websocket_client.frame(json.dumps(request).encode(), websocket_client.TEXT))
        while True:
            self.socket.received += self.socket.connection.recv(1 << 20)
            while self.socket.decode():
                answer = json.loads(self.socket.controls.pop()[1])
                if answer.get("id") == self.id:
                    return answer["result"]

    def used_bytes(self):
        for session in self.sessions.values():
            self.call("HeapProfiler.collectGarbage", session)
        return {kind: self.call("Runtime.getHeapUsage", session)["usedSize"] for kind, session in self.sessions.items()}


def first_snapshot_ms(browser):
    """From the navigation to the first report of a drawn snapshot."""
    browser.wait_for_snapshot()
    return browser.value("""performance.getEntriesByName("evod-first-snapshot")[0]?.startTime ?? performance.now()""")


def measure_page(organisms):
    from browser import Browser
    with serve() as server:
        create(server, "w", organisms)
        server.control.call(delete_world=c.DeleteWorld(world="default"))
        browser = Browser()
        try:
            # The page itself notes when the snapshot arrives, so that the polling of this program is not measured.
            browser.cdp("Page.addScriptToEvaluateOnNewDocument", source="""
                const look = () => globalThis.evod?.app?.world().snapshot ? performance.mark("evod-first-snapshot")
                                                                          : setTimeout(look, 1);
                if (location.protocol === "http:") { look(); }""")
            browser.open(f"http://127.0.0.1:{server.page_port}/", wait=False)
            cold_ms = first_snapshot_ms(browser)
            browser.driver.refresh()
            warm_ms = first_snapshot_ms(browser)
            heaps = Heaps(browser)
            time.sleep(options.seconds / 2)  # the shaders are compiled, the first keyframe is decoded
            before, used_before, began = browser.figures(), heaps.used_bytes(), time.monotonic()
            frames = []
            while time.monotonic() - began < options.seconds:
                time.sleep(1)
                frames.append(browser.figures()["frames_per_s"])
            after, passed_s, used = browser.figures(), time.monotonic() - began, heaps.used_bytes()
            return {"first_ms": {"cold": cold_ms, "warm": warm_ms},
                    "decode_ms": {"p50": after["decode_p50_ms"], "p95": after["decode_p95_ms"]},
                    "draw_ms": {"p50": after["draw_p50_ms"], "p95": after["draw_p95_ms"]},
                    "snapshots_per_s": (after["snapshots"] - before["snapshots"]) / passed_s,
                    "dropped_per_s": (after["dropped"] - before["dropped"]) / passed_s,
                    "frames_per_s": sum(frames) / len(frames), "damaged": after["damaged_snapshots"],
                    "heap_mb": {kind: used[kind] / 1e6 for kind in used},
                    "heap_growth_mb": {kind: (used[kind] - used_before[kind]) / 1e6 for kind in used}}
        finally:
            browser.close()


# ---- many viewers
# ------------------------------------------------------------------------------------------------------


class Viewer:
    """A client like the worker of the page: it acknowledges each snapshot."""

    def __init__(self, port, world):
        self.socket, self.received, self.snapshots = websocket_client.WebSocket.connected(port), bytearray(), 0
        self.send(session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1, client_name="benchmark")))
        self.send(session_pb2.ClientMessage(request=c.Request(
            request_id=1, client_key="benchmark", subscribe_snapshots=c.SubscribeSnapshots(
                world=world, rate_hz=30, codec=stream_pb2.CODEC_DELTA, unacknowledged_max=2, headings=True))))

    def fileno(self):
        return self.socket.fileno()

    def send(self, message):
        body = message.SerializeToString()
        self.socket.sendall(b"EV\x01\x01" + struct.pack("<I", len(body)) + body)

    def step(self):
        """Takes what has arrived."""
        data = self.socket.recv(1 << 20)
        if not data:
            raise EOFError
        self.received += data
        while len(self.received) >= 8:
            length = struct.unpack("<I", self.received[4:8])[0]
            if len(self.received) < 8 + length:
                break
            channel, body = self.received[3], bytes(self.received[8:8 + length])
            del self.received[:8 + length]
            if channel == 2:
                frame = stream_pb2.SnapshotFrame.FromString(body)
                self.snapshots += 1
                self.send(session_pb2.ClientMessage(acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
                    subscription_id=frame.subscription_id, island=frame.island, sequence=frame.sequence)))


class Readers(threading.Thread):
    """Reads what all viewers receive, until stop()."""

    def __init__(self, viewers):
        super().__init__(daemon=True)
        self.viewers, self.stopped, self.selector = viewers, False, selectors.DefaultSelector()
        for viewer in viewers:
            self.selector.register(viewer, selectors.EVENT_READ, viewer)
        self.start()

    def run(self):
        with contextlib.suppress(OSError, EOFError):
            while not self.stopped:
                for key, _ in self.selector.select(0.2):
                    key.data.step()
                    while key.data.socket.content or key.data.socket.decode():
                        key.data.step()

    def stop(self):
        self.stopped = True
        self.join()


def ticks(server):
    return {world.name: world.tick for world in server.control.call(list_worlds=c.ListWorlds()).worlds.worlds}


def threads_s(server):
    """Processor time of each kind of thread, as /metrics reports it."""
    connection = http.client.HTTPConnection("127.0.0.1", server.page_port)
    connection.request("GET", "/metrics")
    text = connection.getresponse().read().decode()
    found = re.findall(r'^evod_thread_cpu_seconds_total\{thread="(\w+)"\} (\S+)', text, re.M)
    return {name: float(seconds) for name, seconds in found}


def measure_viewers(count):
    figures = {}
    with serve() as server:
        for i in range(count):
            create(server, f"w{i}", 50)
        for name, watched in (("without viewers", 0), (f"{count} viewers", count)):
            viewers = [Viewer(server.page_port, f"w{i}") for i in range(watched)]
            readers = Readers(viewers)
            time.sleep(2)
            seen = sum(viewer.snapshots for viewer in viewers)
            used, first, began = threads_s(server), ticks(server), time.monotonic()
            time.sleep(options.seconds)
            last, used_after, passed_s = ticks(server), threads_s(server), time.monotonic() - began
            shares = [(last[f"w{i}"] - first[f"w{i}"]) / (60 * passed_s) for i in range(count)]
            slowed = sum(world.slowed for world in server.control.call(list_worlds=c.ListWorlds()).worlds.worlds)
            snapshots = sum(viewer.snapshots for viewer in viewers) - seen
            readers.stop()
            figures[name] = {"real_time_share": {"least": min(shares), "mean": sum(shares) / count},
                             "slowed_worlds": slowed,
                             "snapshots_per_s": snapshots / passed_s / max(watched, 1),
                             "cpu_share": {thread: (used_after[thread] - used[thread]) / passed_s for thread in used}}
            for viewer in viewers:
                viewer.socket.close()
    return figures


print_figures(measure_viewers(options.viewers) if options.viewers
              else {f"{organisms} organisms": measure_page(organisms) for organisms in options.organisms}, options.json)
