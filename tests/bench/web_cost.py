"""Measures what the page costs a browser, with a real evod: time to the first snapshot, frame rate, memory.

    web_cost.py EVOD MESSAGES [--organisms N ...] [--seconds S] [--json]

For each number of organisms a headless Chromium without a GPU (ANGLE's SwiftShader) shows a world of the benchmark
world's density at real time. Decoding and drawing are those of the last 200 snapshots and frames in the worker; `first`
is the time from the navigation until the first snapshot is drawn, of a new browser and of a reload; the heaps of page
and worker are read after a garbage collection, when the page has settled and after the seconds of measurement.
"""
import argparse
import http.client
import json
import pathlib
import socket
import sys
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="folder of the Python message classes: build/release/tests/system")
parser.add_argument("--organisms", type=int, nargs="+", default=[50, 10_000, 100_000])
parser.add_argument("--seconds", type=float, default=20, help="of each measurement")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
system_tests = pathlib.Path(__file__).resolve().parents[1] / "system"
sys.path[:0] = [options.messages, str(system_tests), str(system_tests / "web")]

from bench_client import Server, assignments, benchmark_world, print_figures  # noqa: E402
import websocket_client  # noqa: E402
from evod.v1 import commands_pb2 as c  # noqa: E402


def serve():
    """A server with a page, whose port is page_port."""
    server = Server(options.evod, "--keep-nothing", "--http-port", "0")
    server.page_port = server.control.welcome.page_port
    return server


def create(server, name, organisms):
    parameters = {"population_size": organisms} if organisms == 50 else benchmark_world(organisms)
    server.control.call(create_world=c.CreateWorld(name=name, seed=1, parameters=assignments(parameters)))
    server.control.call(run=c.Run(world=name))


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


print_figures({f"{organisms} organisms": measure_page(organisms) for organisms in options.organisms}, options.json)
