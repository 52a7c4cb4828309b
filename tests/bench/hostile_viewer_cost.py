"""Measures what one client with the role viewer can cost a world at real time and the commands of another client.

    hostile_viewer_cost.py EVOD MESSAGES [--organisms N] [--seconds S] [--only NAME] [--json]

A world of N organisms and a world of 4,096 small islands run at real time. In each run the viewer, a separate process,
does one thing without pause: it keeps 30 requests of a kind unanswered, sends the longest frames, holds 32
subscriptions, or subscribes and unsubscribes. Meanwhile another client sends a command every 10 ms. The program
prints the world's ticks per second and the duration of the commands, with and without the viewer.
"""
import argparse
import json
import os
import select
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="folder of the Python message classes: build/release/tests/system")
parser.add_argument("--organisms", type=int, default=50_000)
parser.add_argument("--seconds", type=float, default=5, help="of each run")
parser.add_argument("--only", help="the run of this name")
parser.add_argument("--attack", nargs=3, metavar=("NAME", "PORT", "TOKEN"), help=argparse.SUPPRESS)
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Client, Server, assignments, benchmark_world, print_figures  # noqa: E402
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2 as w  # noqa: E402

unanswered = 30
queries = {
    "list_worlds": {"list_worlds": c.ListWorlds()},
    "statistics": {"get_statistics": c.GetStatistics(world="w")},
    "statistics_of_islands": {"get_statistics": c.GetStatistics(world="islands")},
    "history": {"get_history": c.GetHistory(world="w")},
    "population": {"get_population": c.GetPopulation(world="w")},
    "motion": {"get_motion": c.GetMotion(world="w")},
    "organism": {"get_organism": c.GetOrganism(world="w", organism=1)},
    "parameters": {"get_parameters": c.GetParameters(world="w")},
    "breeding": {"get_breeding": c.GetBreeding(world="w", generation=2)},
    "describe": {"describe": c.Describe()},
    "metrics": {"get_metrics": c.GetMetrics()},
    "export": {"export_run": c.ExportRun(world="w", table=c.RUN_TABLE_EVENTS)},
    "refused_command": {"pause": c.Pause(world="w")},
}


class Attacker:
    """A session that sends without pause, blocks only on a full socket, and discards what it receives."""

    def __init__(self, port, token):
        self.port, self.token = port, token
        self.id = 0
        self.connect()

    def connect(self):
        self.socket = socket.create_connection(("127.0.0.1", self.port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.send(session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1, token=self.token)))
        self.answered = 0
        self.input = bytearray()
        self.subscriptions = []

    def send(self, message):
        body = message.SerializeToString()
        self.socket.sendall(b"EV\x01\x01" + struct.pack("<I", len(body)) + body)

    def ask(self, **request):
        self.id += 1
        self.send(session_pb2.ClientMessage(request=c.Request(request_id=self.id, client_key="attack", **request)))

    def read(self):
        """Reads once; counts answers, and stores the ids of subscriptions."""
        data = self.socket.recv(1 << 20)
        if not data:
            raise EOFError
        self.input += data
        while len(self.input) >= 8:
            length = struct.unpack("<I", self.input[4:8])[0]
            if len(self.input) < 8 + length:
                return
            if self.input[3] == 1 and length < 1000:
                message = session_pb2.ServerMessage.FromString(bytes(self.input[8:8 + length]))
                self.answered += message.HasField("response")
                if message.response.HasField("subscription"):
                    self.subscriptions.append(message.response.subscription.subscription_id)
            else:
                self.answered += self.input[3] == 1
            del self.input[:8 + length]

    def flood(self, request):
        sent = 0
        while True:
            while sent - self.answered < unanswered:
                self.ask(**request)
                sent += 1
            self.read()

    def subscribe(self, count, world, **more):
        for _ in range(count):
            self.ask(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=120, **more))

    def subscriptions_only(self, world, **more):
        self.subscribe(32, world, **more)
        while True:
            self.read()

    def subscribe_and_leave(self, world):
        while True:
            before = self.answered
            self.subscribe(15, world, codec=stream_pb2.CODEC_DELTA)
            while self.answered < before + 15:
                self.read()
            before = self.answered
            for number in self.subscriptions:
                self.ask(unsubscribe=c.Unsubscribe(subscription_id=number))
            while self.answered < before + len(self.subscriptions):
                self.read()
            self.subscriptions.clear()

    def long_frames(self, body_bytes):
        body = session_pb2.ClientMessage(request=c.Request(
            request_id=1, create_world=c.CreateWorld(parameters=[w.ParameterAssignment()] * (body_bytes // 2 - 20)))
        ).SerializeToString()[:body_bytes]
        frame = b"EV\x01\x01" + struct.pack("<I", len(body)) + body
        while True:
            try:
                while True:
                    self.socket.sendall(frame)
                    while select.select([self.socket], [], [], 0)[0]:
                        self.read()
            except (OSError, EOFError):
                self.connect()

    def replays(self):
        while True:
            before = self.answered
            for _ in range(4):
                self.ask(open_replay=c.OpenReplay(world="w"))
            while self.answered < before + 4:
                self.read()
            self.socket.close()
            self.connect()


attacks = {name: (lambda attacker, request=request: attacker.flood(request)) for name, request in queries.items()} | {
    "subscriptions": lambda attacker: attacker.subscriptions_only("w", codec=stream_pb2.CODEC_DELTA),
    "subscriptions_plain": lambda attacker: attacker.subscriptions_only("w", codec=stream_pb2.CODEC_PLAIN),
    "subscriptions_islands": lambda attacker: attacker.subscriptions_only("islands", codec=stream_pb2.CODEC_DELTA),
    "subscribe_and_leave": lambda attacker: attacker.subscribe_and_leave("w"),
    "subscribe_and_leave_islands": lambda attacker: attacker.subscribe_and_leave("islands"),
    "long_frames": lambda attacker: attacker.long_frames(64 << 10),
    "longer_frames": lambda attacker: attacker.long_frames(1 << 20),
    "replays": lambda attacker: attacker.replays(),
}


def measure_run(server, commander):
    """Ticks per second, and the duration of commands in milliseconds."""
    def tick():
        return next(x for x in server.control.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == "w").tick
    times = []
    first_tick, began = tick(), time.perf_counter()
    while time.perf_counter() - began < options.seconds:
        asked = time.perf_counter()
        commander.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(real_time_factor=1)))
        times.append(time.perf_counter() - asked)
        time.sleep(0.01)
    last_tick, took = tick(), time.perf_counter() - began
    ordered = sorted(1e3 * s for s in times)
    return {"ticks_per_s": (last_tick - first_tick) / took, "command_p50_ms": ordered[len(ordered) // 2],
            "command_p99_ms": ordered[len(ordered) * 99 // 100], "command_max_ms": ordered[-1]}


def measure():
    figures = {}
    with tempfile.TemporaryDirectory() as folder:
        token = subprocess.run([options.evod, "token", "add", "eve", "--role", "viewer", "--data", folder], check=True,
                               capture_output=True, text=True).stdout.split()[-1]
        with Server(options.evod, "--data", folder, "--http-port", "0") as server:
            control, commander = server.control, Client(server.port)
            control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(
                benchmark_world(options.organisms) | {"generation_s": 3600.0})))
            control.call(create_world=c.CreateWorld(name="islands", seed=1, parameters=assignments(
                {"island_count": 4096, "population_size": 4, "food_count": 4, "poison_count": 4})))
            control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(real_time_factor=1)))
            control.call(run=c.Run(world="w"))
            control.call(run=c.Run(world="islands"))
            time.sleep(2)
            figures["no_attacker"] = measure_run(server, commander)
            for name in attacks:
                if options.only in (None, name):
                    with subprocess.Popen(["nice", "-n", "10", sys.executable, *sys.argv, "--attack", name,
                                           str(server.port), token],
                                          stderr=subprocess.PIPE) as attacker:
                        time.sleep(1)
                        figures[name] = measure_run(server, commander)
                        attacker.kill()
                        fault = attacker.stderr.read().decode()
                    if fault:
                        figures[name]["attacker ended"] = fault[-300:]
                    time.sleep(0.5)
                    if not options.json:
                        print(name, figures[name], flush=True)
    return figures


if options.attack:
    name, port, token = options.attack
    attacks[name](Attacker(int(port), token))
figures = measure()
print_figures(figures, options.json)
