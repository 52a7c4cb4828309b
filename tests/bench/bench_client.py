"""A real evod and a client of it, for the other programs of this folder, with one request at a time; and how they print
figures."""
import json
import os
import re
import secrets
import signal
import socket
import statistics
import struct
import subprocess
import threading
import time

from evod.v1 import commands_pb2 as c, session_pb2, world_pb2 as w


class Client:
    def __init__(self, port, **hello):
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.key, self.id = secrets.token_hex(8), 0
        self.send(session_pb2.ClientMessage(hello=session_pb2.Hello(
            protocol_version=1, client_name="benchmark", **hello)))
        self.welcome = session_pb2.ServerMessage.FromString(bytes(self.frame()[1])).welcome

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

    def run_to(self, tick, pause_s=0.005):
        """Asks every pause_s whether it is there, which costs the server some 0.1 ms each time."""
        self.call(run_until_tick=c.RunUntilTick(world="w", tick=tick))
        while next(x for x in self.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == "w").tick < tick:
            time.sleep(pause_s)


class Server:
    """A server of its own at a free port, whose log is read away. start_s: from its exec to the welcome of
    `control`."""

    def __init__(self, evod, *arguments):
        began = time.perf_counter()
        self.process = subprocess.Popen([evod, "--port", "0", *arguments], stderr=subprocess.PIPE, text=True)
        line = next((line for line in self.process.stderr if "listening on " in line), None)
        assert line, "evod ended at once"
        self.port = int(line.split("listening on ")[1].split(",")[0].rsplit(":")[1])
        self.reader = threading.Thread(target=self.process.stderr.read, daemon=True)
        self.reader.start()
        self.control = Client(self.port)
        self.start_s = time.perf_counter() - began

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def end(self, how=signal.SIGTERM):
        self.control.socket.close()
        self.process.send_signal(how)
        self.reader.join()
        self.process.communicate()

    def threads(self):
        """The number and the name of each of its threads."""
        for task in os.listdir(f"/proc/{self.process.pid}/task"):
            yield int(task), open(f"/proc/{self.process.pid}/task/{task}/comm").read().strip()

    def thread_s(self, wanted):
        """Processor seconds of the threads whose name is wanted: a name, or what says so of one."""
        wanted = wanted if callable(wanted) else wanted.__eq__
        return sum(int(open(f"/proc/{self.process.pid}/task/{task}/schedstat").read().split()[0])
                   for task, name in self.threads() if wanted(name)) / 1e9

    def status_bytes(self, name):
        """Memory, as VmRSS, or VmHWM for the most there was."""
        status = open(f"/proc/{self.process.pid}/status").read()
        return int(re.search(rf"{name}:\s+(\d+) kB", status)[1]) << 10


def assignments(parameters):
    kinds = {bool: "flag", int: "count", float: "real", str: "choice"}
    return [w.ParameterAssignment(name=n, value=w.ParameterValue(**{kinds[type(v)]: v})) for n, v in parameters.items()]


def benchmark_world(organisms):
    """The parameters of the benchmark world's density, with 3 food and 2 poison to each organism."""
    area_px2 = organisms * 46_080
    return {"population_size": organisms, "food_count": organisms * 3, "poison_count": organisms * 2,
            "island_width_px": (area_px2 * 16 / 9) ** 0.5, "island_height_px": (area_px2 * 9 / 16) ** 0.5}


def spread(values):
    return {"median": statistics.median(values), "min": min(values), "max": max(values)}


def spread_ms(seconds):
    return spread([1e3 * s for s in seconds])


def lines_of(name, value):
    if not isinstance(value, dict):
        return [f"{name}: {value:.2f}"]
    numbers = [f"{part} {number:.2f}" for part, number in value.items() if not isinstance(number, dict)]
    return ([f"{name}: " + ", ".join(numbers)] if numbers else []) + [
        line for part, inner in value.items() if isinstance(inner, dict) for line in lines_of(f"{name}, {part}", inner)]


def print_figures(figures, as_json):
    """A line for each, or all as one object of JSON."""
    print(json.dumps(figures) if as_json else "\n".join(line for item in figures.items() for line in lines_of(*item)))
