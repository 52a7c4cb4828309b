"""What keeping a run costs the simulation, how long a command waits for the disk, and how soon a killed evod is back.

    storage_cost.py EVOD MESSAGES [--organisms N] [--runs N] [--json]

The same ticks of the same run are simulated again and again at full speed on one thread, by turns by a server that
keeps its runs and one that keeps nothing. The cost is the rise of the simulation thread's processor time and the
processor time of the threads that write and pack, both over the simulation thread's time where nothing is kept. A
server is killed late in a generation, so that most of one is to be simulated again.
"""
import argparse
import signal
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="where the Python classes of the messages are: build/release/tests/system")
parser.add_argument("--organisms", type=int, default=10_000)
parser.add_argument("--runs", type=int, default=9, help="pairs of runs")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Server, assignments, benchmark_world, print_figures, spread, spread_ms  # noqa: E402
from evod.v1 import commands_pb2 as c, world_pb2 as w  # noqa: E402

first_tick, ticks = 60, max(4_900, 60_000_000 // options.organisms)  # two ends of a generation at least


def writes(thread):
    return thread in ("storage", "packing")


def measure_run(*arguments):
    """Seconds of the simulation thread and of those that write for the ticks; seconds of some commands."""
    with Server(options.evod, "--threads", "1", *arguments) as server:
        control = server.control
        control.call(create_world=c.CreateWorld(name="w", seed=1,
                                                parameters=assignments(benchmark_world(options.organisms))))
        control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        control.run_to(first_tick)
        before = server.thread_s("simulation"), server.thread_s(writes)
        control.run_to(first_tick + ticks)
        after = server.thread_s("simulation"), server.thread_s(writes)
        commands = []
        for _ in range(100):
            began = time.perf_counter()
            control.call(pause=c.Pause(world="w"))
            commands.append(time.perf_counter() - began)
    return after[0] - before[0], after[1] - before[1], commands


def measure_ready_after_kill():
    """Seconds from exec to a client's welcome, several times."""
    times = []
    with tempfile.TemporaryDirectory() as data:
        server = Server(options.evod, "--data", data)
        parameters = benchmark_world(options.organisms) | {"generation_s": 40.0}
        server.control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(parameters)))
        server.control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        server.control.run_to(2390)  # of 2400
        server.control.call(pause=c.Pause(world="w"))  # is on the disk, with its tick
        for _ in range(options.runs):
            server.end(signal.SIGKILL)
            server = Server(options.evod, "--data", data)
            times.append(server.start_s)
        worlds = server.control.call(list_worlds=c.ListWorlds()).worlds.worlds
        assert next(x.tick for x in worlds if x.name == "w") == 2390
        server.end()
    return times


def measure():
    rises, shares, costs, commands = [], [], [], []
    for _ in range(options.runs):
        alone, _, _ = measure_run("--keep-nothing")
        with tempfile.TemporaryDirectory() as data:
            kept, storage, waited = measure_run("--data", data)
        rises.append(100 * (kept / alone - 1))
        shares.append(100 * storage / alone)
        costs.append(rises[-1] + shares[-1])
        commands += waited
    return {"organisms": options.organisms, "ticks": ticks, "pairs": options.runs,
            "simulation_rise_percent": spread(rises), "storage_share_percent": spread(shares),
            "cost_percent": spread(costs), "command_ms": spread_ms(commands),
            "ready_after_kill_s": spread(measure_ready_after_kill())}


print_figures(measure(), options.json)
