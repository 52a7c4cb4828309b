"""What a class costs a server, and what one member or an admin can take from the others.

    class_cost.py EVOD MESSAGES [--members N] [--seconds S] [--json]

Each member joins with the code of the class and watches the own world at 30 snapshots a second; the teacher watches all
worlds at 5. The clients are a process of their own, which only reads. Figures of each stretch: processor cores of the
server, ticks per second of the slowest member (real time is 60), and the time of queries of the teacher.

    quiet    all worlds at real time
    hog      one member has every parameter at the most of the class, and full speed
    admin    a world of 1,000,000 organisms of an admin at full speed
"""
import argparse
import json
import os
import pathlib
import selectors
import statistics
import subprocess
import sys
import tempfile
import threading
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--members", type=int, default=40)
parser.add_argument("--seconds", type=float, default=10, help="of each stretch")
parser.add_argument("--organisms", type=int, default=1_000_000, help="of the admin's world")
parser.add_argument("--viewers", nargs=2, help=argparse.SUPPRESS)
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Client, Server, assignments, print_figures, spread_ms  # noqa: E402
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2 as w  # noqa: E402


def watch(client, world, rate_hz, detail=stream_pb2.DETAIL_FULL):
    client.call(subscribe_snapshots=c.SubscribeSnapshots(
        world=world, rate_hz=rate_hz, codec=stream_pb2.CODEC_DELTA, view=c.View(detail=detail)))


def view():
    """The process of the viewers: argument 1 the port, argument 2 the tokens and worlds as JSON."""
    port, users = int(options.viewers[0]), json.loads(options.viewers[1])
    ready = selectors.DefaultSelector()
    for token, worlds, rate_hz, detail in users:
        client = Client(port, token=token)
        for world in worlds:
            watch(client, world, rate_hz, detail)
        client.socket.setblocking(False)
        ready.register(client.socket, selectors.EVENT_READ)
    print("watching", flush=True)
    while True:
        for key, _ in ready.select():
            if not key.fileobj.recv(1 << 20):
                return


def members_of(server, code):
    """Joins within a second, and returns the members and the seconds until each has seen its world."""
    times, members = [], []

    def join():
        began = time.perf_counter()
        client = Client(server.port, join=session_pb2.Join(code=code))
        watch(client, client.welcome.membership.world, 30)
        while client.frame()[0] != 2:
            pass
        times.append(time.perf_counter() - began)
        members.append(client)

    threads = [threading.Thread(target=join) for _ in range(options.members)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return members, times


def ticks(client, class_name):
    answer = client.call(list_worlds=c.ListWorlds())
    return {world.name: world.tick for world in answer.worlds.worlds if getattr(world, "class") == class_name}


def stretch(server, teacher, but=()):
    """The figures of some seconds. but: worlds that do not count."""
    before, cpu, began, queries = ticks(teacher, "bio"), server.thread_s(lambda _: True), time.perf_counter(), []
    while time.perf_counter() - began < options.seconds:
        asked = time.perf_counter()
        teacher.call(get_parameters=c.GetParameters(world=next(iter(before))))
        queries.append(time.perf_counter() - asked)
        time.sleep(0.05)
    after, wall = ticks(teacher, "bio"), time.perf_counter() - began
    rates = [(after[world] - tick) / wall for world, tick in before.items() if world not in but]
    return {"cores": (server.thread_s(lambda _: True) - cpu) / wall,
            "ticks_per_s": {"slowest": min(rates), "median": statistics.median(rates)},
            "query_ms": spread_ms(queries)}


def main():
    with tempfile.TemporaryDirectory() as folder:
        tokens = {}
        for name, role in (("teacher", "teacher"), ("root", "admin")):
            tokens[name] = subprocess.run([options.evod, "token", "add", name, "--role", role, "--data", folder],
                                          capture_output=True, text=True, check=True).stdout.strip()
        with Server(options.evod, "--data", folder, "--sessions-max", "256") as server:
            teacher, admin = Client(server.port, token=tokens["teacher"]), Client(server.port, token=tokens["root"])
            code = teacher.call(create_class=c.CreateClass(name="bio")).class_info.code
            members, times = members_of(server, code)
            figures = {"joined_ms": spread_ms(times)}
            everyone = c.ForEachWorld(run=c.Run())
            setattr(everyone, "class", "bio")
            teacher.call(for_each_world=everyone)
            own = {one.welcome.membership.token: one.welcome.membership.world for one in members}
            users = [[token, [world], 30, stream_pb2.DETAIL_FULL] for token, world in own.items()]
            users.append([tokens["teacher"], list(own.values()), 5, stream_pb2.DETAIL_DOTS])
            for one in members[1:]:
                one.socket.close()
            viewers = subprocess.Popen([sys.executable, __file__, options.evod, options.messages, "--viewers",
                                        str(server.port), json.dumps(users)], stdout=subprocess.PIPE, text=True)
            try:
                assert viewers.stdout.readline() == "watching\n"
                figures["quiet"] = stretch(server, teacher)
                figures["freeze_ms"] = frozen(server, teacher)
                hog, own = members[0], members[0].welcome.membership.world
                hog.socket.close()
                hog = Client(server.port, token=members[0].welcome.membership.token)
                states = hog.call(get_parameters=c.GetParameters(world=own)).parameters.parameters
                greedy = "population_size", "food_count", "poison_count", "island_count"
                largest = {state.name: int(state.max) for state in states if state.name in greedy}
                hog.call(set_parameters=c.SetParameters(world=own, parameters=assignments(
                    {**largest, "scale_with_population": True})))
                hog.call(reset_world=c.ResetWorld(world=own))
                hog.call(set_speed=c.SetSpeed(world=own, speed=w.Speed(max=True)))
                hog.call(run=c.Run(world=own))
                figures["hog"] = stretch(server, teacher, but=(own,))
                hog.call(pause=c.Pause(world=own))
                created = admin.call(create_world=c.CreateWorld(name="huge", parameters=assignments(
                    {"population_size": options.organisms, "scale_with_population": True})))
                print(*created.warnings, sep="\n", file=sys.stderr)
                admin.call(set_speed=c.SetSpeed(world="huge", speed=w.Speed(max=True)))
                admin.call(run=c.Run(world="huge"))
                figures["admin"] = stretch(server, teacher, but=(own,))
            finally:
                viewers.kill()
                viewers.wait()
    print_figures(figures, options.json)


def frozen(server, teacher):
    """Milliseconds from the request to freeze until the worlds have stopped, which is when it is answered."""
    update = {"class": "bio", "frozen": True}
    began = time.perf_counter()
    teacher.call(update_class=c.UpdateClass(**update))
    took = time.perf_counter() - began
    stopped = ticks(teacher, "bio")
    time.sleep(0.2)
    assert ticks(teacher, "bio") == stopped, "a world goes on"
    teacher.call(update_class=c.UpdateClass(**{**update, "frozen": False}))
    return 1e3 * took


if options.viewers:
    view()
else:
    main()
