"""Measures whether the memory of evoview grows while it shows a world for some minutes, on the display DISPLAY.

    under_xvfb.sh viewer_memory.py EVOD EVOVIEW MESSAGES [--organisms N] [--speed N] [--minutes N] [--keys "F5 T"]
    [--json]
"""
import argparse
import re
import subprocess
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("evoview", help="the program")
parser.add_argument("messages", help="folder of the Python message classes: build/release/tests/system")
parser.add_argument("--organisms", type=int, default=10_000)
parser.add_argument("--speed", type=float, default=10, help="times real time")
parser.add_argument("--minutes", type=float, default=10)
parser.add_argument("--keys", default="", help="keys to press in evoview at the start, as in its scripts")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Server, assignments, benchmark_world, print_figures  # noqa: E402
from evod.v1 import commands_pb2 as c, world_pb2 as w  # noqa: E402

settle_s, sample_s = 20, 10
seconds = 60 * options.minutes


def memory_mb(process):
    return int(re.search(r"VmRSS:\s+(\d+) kB", open(f"/proc/{process.pid}/status").read())[1]) / 1e3


def processor_s(process):
    fields = open(f"/proc/{process.pid}/stat").read().rsplit(") ")[1].split()
    return (int(fields[11]) + int(fields[12])) / 100


def sample_viewer(server):
    """Memory in MB, every sample_s from settle_s on, and processor seconds of the viewer per second."""
    script = tempfile.NamedTemporaryFile("w", suffix=".script")
    script.write("wait snapshot\n" + "".join(f"key {key}\n" for key in options.keys.split()))
    script.flush()
    viewer = subprocess.Popen([options.evoview, "--server", f"localhost:{server.port}", "--world", "w",
                               "--script", script.name])
    try:
        time.sleep(settle_s)
        began, used, samples = time.monotonic(), processor_s(viewer), []
        while True:
            assert viewer.poll() is None, "evoview ended"
            samples.append(memory_mb(viewer))
            print(f"{time.monotonic() - began:.0f} s: {samples[-1]:.1f} MB", file=sys.stderr, flush=True)
            if time.monotonic() - began >= seconds:
                return samples, (processor_s(viewer) - used) / (time.monotonic() - began)
            time.sleep(sample_s)
    finally:
        viewer.terminate()
        viewer.wait()


def rise_mb_per_min(samples):
    """The slope of the regression line through the samples."""
    middle, mean = (len(samples) - 1) / 2, sum(samples) / len(samples)
    above = sum((i - middle) * (sample - mean) for i, sample in enumerate(samples))
    return above / sum((i - middle) ** 2 for i in range(len(samples))) * 60 / sample_s


def measure():
    with Server(options.evod, "--keep-nothing") as server:
        control = server.control
        control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=assignments(
            benchmark_world(options.organisms))))
        control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(real_time_factor=options.speed)))
        control.call(run=c.Run(world="w"))
        samples, load = sample_viewer(server)
        world = next(x for x in control.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == "w")
        return {"organisms": options.organisms, "speed": options.speed, "minutes": options.minutes,
                "ticks": world.tick, "generation": world.generation, "samples": len(samples),
                "first_mb": samples[0], "last_mb": samples[-1], "most_mb": max(samples),
                "rise_mb_per_min": rise_mb_per_min(samples), "viewer_processor_share": load}


print_figures(measure(), options.json)
