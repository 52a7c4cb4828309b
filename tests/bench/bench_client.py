"""A client of a real evod, for the programs beside: asks one thing after another. And how they print their figures."""
import json
import os
import secrets
import socket
import struct
import time

from evod.v1 import commands_pb2 as c, session_pb2, world_pb2 as w


class Client:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.key, self.id = secrets.token_hex(8), 0
        self.send(session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1, client_name="benchmark")))
        self.frame()

    def send(self, message):
        body = message.SerializeToString()
        self.socket.sendall(b"EV\x01\x01" + struct.pack("<I", len(body)) + body)

    def read(self, count):
        data = bytearray(count)
        view, got = memoryview(data), 0
        while got < count:
            more = self.socket.recv_into(view[got:])
            if more == 0:
                raise EOFError
            got += more
        return data

    def frame(self):
        header = self.read(8)
        return header[3], self.read(struct.unpack("<I", header[4:])[0])

    def call(self, **request):
        self.id += 1
        self.send(session_pb2.ClientMessage(request=c.Request(request_id=self.id, client_key=self.key, **request)))
        while True:
            channel, body = self.frame()
            if channel == 1:
                response = session_pb2.ServerMessage.FromString(bytes(body)).response
                assert response.status.code == 0, response.status
                return response

    def run_to(self, tick):
        self.call(run_until_tick=c.RunUntilTick(world="w", tick=tick))
        while next(x for x in self.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == "w").tick < tick:
            time.sleep(0.005)


def thread_s(pid, name):
    """Seconds of processor time of a server's thread; 0 if it has none of that name."""
    for task in os.listdir(f"/proc/{pid}/task"):
        if open(f"/proc/{pid}/task/{task}/comm").read().strip() == name:
            return int(open(f"/proc/{pid}/task/{task}/schedstat").read().split()[0]) / 1e9
    return 0


def assignments(parameters):
    return [w.ParameterAssignment(name=n, value=w.ParameterValue(**{"count" if isinstance(v, int) else "real": v}))
            for n, v in parameters.items()]


def benchmark_world(organisms):
    """The parameters of the benchmark world's density, with 3 food and 2 poison to each organism."""
    area_px2 = organisms * 46_080
    return {"population_size": organisms, "food_count": organisms * 3, "poison_count": organisms * 2,
            "island_width_px": (area_px2 * 16 / 9) ** 0.5, "island_height_px": (area_px2 * 9 / 16) ** 0.5}


def print_figures(figures, as_json):
    """A line for each, or all as one object of JSON."""
    if as_json:
        print(json.dumps(figures))
        return
    for name, value in figures.items():
        parts = value.items() if isinstance(value, dict) else [("", value)]
        print(f"{name}: " + ", ".join(f"{part} {number:.2f}".strip() for part, number in parts))
