"""What the replays of one viewer cost a live world, and what live worlds cost a seek.

    replay_cost.py EVOD MESSAGES [--repeats R] [--replays N] [--json]

In each repetition: the ticks per second of a live world of 500 organisms at full speed, and of one of 50,000 organisms
at real time, without and with replays at full speed that one user has opened; and the time of a seek across a
generation, while the live world is paused and while it runs at full speed.
"""
import argparse
import json
import statistics
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--repeats", type=int, default=3)
parser.add_argument("--replays", type=int, default=32)
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Client, Server, assignments, benchmark_world  # noqa: E402
from evod.v1 import commands_pb2 as c, world_pb2 as w  # noqa: E402


def make(client, organisms):
    client.call(create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(benchmark_world(organisms))))
    set_speed(client, "w", None)
    client.call(run=c.Run(world="w"))


def set_speed(client, world, factor):
    speed = w.Speed(max=True) if factor is None else w.Speed(real_time_factor=factor)
    client.call(set_speed=c.SetSpeed(world=world, speed=speed))


def tick(client):
    return next(x for x in client.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == "w").tick


def ticks_per_s(client, seconds):
    began, first = time.perf_counter(), tick(client)
    time.sleep(seconds)
    return (tick(client) - first) / (time.perf_counter() - began)


def open_replays(port, count):
    clients = []
    for number in range(count):
        if number % 4 == 0:
            clients.append(Client(port))
        replay = clients[-1].call(open_replay=c.OpenReplay(world="w", at=c.RunMoment(generation=1))).world.name
        set_speed(clients[-1], replay, None)
        clients[-1].call(run=c.Run(world=replay))
    return clients


def live(organisms, factor, seconds):
    """Ticks per second of the live world alone, and next to the replays."""
    with tempfile.TemporaryDirectory() as folder, Server(options.evod, "--data", folder, "--durability",
                                                         "relaxed") as server:
        make(server.control, organisms)
        time.sleep(2)
        set_speed(server.control, "w", factor)
        time.sleep(1)
        alone = ticks_per_s(server.control, seconds)
        clients = open_replays(server.port, options.replays)
        time.sleep(2)
        next_to_replays = ticks_per_s(server.control, seconds)
        for client in clients:
            client.socket.close()
        return alone, next_to_replays


def seeks(organisms):
    """Milliseconds of a seek from the first to the last tick of a generation: live world paused, and at full speed."""
    with tempfile.TemporaryDirectory() as folder, Server(options.evod, "--data", folder, "--durability",
                                                         "relaxed") as server:
        make(server.control, organisms)
        while tick(server.control) < 3000:
            time.sleep(0.05)
        times = {}
        for state in ("paused", "at full speed"):
            if state == "paused":
                server.control.call(pause=c.Pause(world="w"))
            else:
                server.control.call(resume=c.Resume(world="w"))
            viewer = Client(server.port)
            replay = viewer.call(open_replay=c.OpenReplay(world="w", at=c.RunMoment(generation=1))).world.name
            taken = []
            for to in (2300, 0) * 3:
                began = time.perf_counter()
                viewer.call(seek=c.Seek(world=replay, to=c.RunMoment(generation=1, tick=to)))
                if to:
                    taken.append(1000 * (time.perf_counter() - began))
            times[state] = statistics.median(taken)
            viewer.socket.close()
        return times


def main():
    figures = []
    for _ in range(options.repeats):
        small, large, seek_small, seek_large = live(500, None, 3), live(50_000, 1.0, 4), seeks(500), seeks(20_000)
        figures.append({"live_500_ticks_per_s": small[0], "live_500_next_to_replays": small[1],
                        "part": small[1] / small[0],
                        "live_50000_real_time_ticks_per_s": large[0], "live_50000_next_to_replays": large[1],
                        "seek_500_ms": seek_small["paused"],
                        "seek_500_next_to_full_speed_ms": seek_small["at full speed"],
                        "seek_20000_ms": seek_large["paused"],
                        "seek_20000_next_to_full_speed_ms": seek_large["at full speed"]})
    medians = {name: statistics.median(one[name] for one in figures) for name in figures[0]}
    if options.json:
        print(json.dumps(medians))
    else:
        for name, value in medians.items():
            print(f"{name}: {value:.3f}")


main()
