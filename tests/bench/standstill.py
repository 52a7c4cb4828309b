"""How long other worlds and other clients wait while a large world is created, forked or reset.

    standstill.py EVOD MESSAGES [--organisms N] [--repeats R] [--json]

A small world runs at full speed. One client asks for the list of the worlds every 2 ms. A second client sends the
command about the large world. For each command: how long its reply took, the longest time without a reply to the first
client, and the longest time in which the small world did not advance. The same for a second without any command.
"""
import argparse
import os
import sys
import tempfile
import threading
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--organisms", type=int, default=1_000_000)
parser.add_argument("--items", action="store_true", help="with 3 food and 2 poison to each organism")
parser.add_argument("--repeats", type=int, default=3)
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Client, Server, assignments, benchmark_world, print_figures, spread_ms  # noqa: E402
from evod.v1 import commands_pb2 as c, world_pb2 as w  # noqa: E402


class Watcher:
    """Asks for the list of the worlds, and keeps the longest waits."""

    def __init__(self, port):
        self.client, self.ended = Client(port), False
        self.thread = threading.Thread(target=self.watch)
        self.reply_s = self.tick_s = 0.0
        self.thread.start()

    def tick(self):
        return next(x for x in self.client.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == "small").tick

    def watch(self):
        last, moved = self.tick(), time.perf_counter()
        while not self.ended:
            began = time.perf_counter()
            tick = self.tick()
            now = time.perf_counter()
            self.reply_s = max(self.reply_s, now - began)
            if tick != last:
                self.tick_s = max(self.tick_s, now - moved)
                last, moved = tick, now
            time.sleep(0.002)

    def end(self):
        self.ended = True
        self.thread.join()
        self.client.socket.close()
        return self.reply_s, self.tick_s


def measure(server, act):
    watcher = Watcher(server.port)
    time.sleep(0.1)
    began = time.perf_counter()
    act()
    took = time.perf_counter() - began
    time.sleep(0.2)
    return took, *watcher.end()


def repeat(parameters):
    with tempfile.TemporaryDirectory() as folder, Server(options.evod, "--data", folder) as server:
        call = server.control.call
        call(create_world=c.CreateWorld(name="small", seed=1, parameters=assignments({"population_size": 50})))
        call(set_speed=c.SetSpeed(world="small", speed=w.Speed(max=True)))
        call(run=c.Run(world="small"))
        times = {"nothing": measure(server, lambda: time.sleep(1))}
        times["create"] = measure(server, lambda: call(
            create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(parameters))))
        server.control.run_to(1)
        times["fork"] = measure(server, lambda: call(fork_world=c.ForkWorld(world="w", name="fork")))
        times["fork_at_generation"] = measure(server, lambda: call(
            fork_world=c.ForkWorld(world="w", name="opening", at_generation=1)))
        times["reset"] = measure(server, lambda: call(reset_world=c.ResetWorld(world="w")))
        return times


parameters = benchmark_world(options.organisms)
if not options.items:
    parameters |= {"food_count": 1000, "poison_count": 1000}
rounds = [repeat(parameters) for _ in range(options.repeats)]
figures = {"organisms": options.organisms, "load": os.getloadavg()[0]}
for command in rounds[0]:
    took, reply, tick = zip(*(one[command] for one in rounds))
    figures[command] = {"took_ms": spread_ms(took), "longest_wait_for_a_reply_ms": spread_ms(reply),
                        "small_world_stood_still_ms": spread_ms(tick)}
print_figures(figures, options.json)
