"""The end of a client, in each way and during each long request: its session, replays and exports give their places
back.

EVOD=… EVOCTL=… MESSAGES=… client_end_test.py
"""
import contextlib
import socket
import struct
import sys
import pathlib
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import past_test as past  # noqa: E402
import plain_client as plain  # noqa: E402
import waiting  # noqa: E402
import websocket_client  # noqa: E402
from past_test import c, w  # noqa: E402

FAR = 50_000  # a seek to this tick takes seconds


def fin(connection):
    connection.shutdown(socket.SHUT_WR)


def close(connection):
    connection.close()


def reset(connection):
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()


POOLS = ("sessions_max", "newcomers_max", "replays_max", "exports_max", "breedings_max")
ENDS = {"FIN": fin, "close": close, "RST": reset}
REQUESTS = {
    "seek": {"open_replay": c.OpenReplay(world="w", at=c.RunMoment(tick=FAR))},
    "export": {"export_run": c.ExportRun(world="w", table=c.RUN_TABLE_ORGANISMS)},
    "breeding": {"get_breeding": c.GetBreeding(world="w")},
    "query": {"get_population": c.GetPopulation(world="w")},
}


class ClientEnd(past.Case):
    def setUp(self):
        super().setUp()
        self.served = self.server("--data", self.folder, "--http-port", "0")
        self.admin = self.client(self.served)
        self.admin.call(create_world=c.CreateWorld(name="w", seed=3, parameters=plain.assignments(
            population_size=200, generation_s=1000.0)))
        self.admin.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        self.admin.run_to(FAR, "w")

    def held(self):
        """What all clients but the admin hold, by pool."""
        families = self.admin.call(get_metrics=c.GetMetrics()).metrics.families
        held = {sample.labels[0].value: sample.value for family in families if family.name == "evod_pool_held"
                for sample in family.samples}
        return {pool: held[pool] - (pool == "sessions_max") for pool in POOLS}

    def ends_during(self, client, request, end):
        client.request_id += 1
        client.send(plain.session_pb2.ClientMessage(request={"request_id": client.request_id, **REQUESTS[request]}))
        plain.until(lambda: self.held()["sessions_max"] == 1, "the session counts")
        if request == "seek":
            plain.until(lambda: self.held()["replays_max"] == 1, "the seek has a place")
        end()
        plain.until(lambda: not any(self.held().values()), f"all places are free again: {self.held()}")

    def test_each_end_of_a_tcp_client(self):
        for name, end in ENDS.items():
            for request in REQUESTS:
                with self.subTest(end=name, request=request):
                    client = past.Client(self.served)
                    self.addCleanup(client.socket.close)
                    self.ends_during(client, request, lambda end=end, client=client: end(client.socket))

    def test_each_end_of_a_websocket(self):
        port = int(plain.until(lambda: past.re.search(r"http://127\.0\.0\.1:(\d+)", self.served.output()), "HTTP")[1])
        for name, end in {**ENDS, "Close frame": None}.items():
            for request in REQUESTS:
                with self.subTest(end=name, request=request):
                    over = websocket_client.WebSocket.connected(port)
                    client = past.Client(self.served, over=over)
                    self.addCleanup(over.close)
                    self.ends_during(client, request, lambda: over.send_raw(websocket_client.frame(
                        struct.pack(">H", 1000), websocket_client.CLOSE)) if end is None else end(over.connection))

    def test_a_half_closed_session_ends_unanswered(self):
        """More seeks than can end soon, each of another session, whose connections stay half open."""
        clients = [past.Client(self.served) for _ in range(20)]
        with contextlib.ExitStack() as stack:
            for client in clients:
                stack.callback(client.socket.close)
                client.send(plain.session_pb2.ClientMessage(request={"request_id": 1, **REQUESTS["seek"]}))
                fin(client.socket)
            plain.until(lambda: not any(self.held().values()), "all places are free again")
            self.assertTrue(self.admin.call(open_replay=c.OpenReplay(world="w")).HasField("world"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
