"""Measures how soon evoview shows a world, and how many frames per second it draws, with a real evod.

    viewer_window_cost.py EVOD MESSAGES VIEWER_WINDOW_BENCH [--organisms N] [--runs N] [--json]

The world has the density of the benchmark world and runs at real time. evoview draws its whole window, 1280 × 720
pixels, with OpenGL in software under Xvfb.
"""
import argparse
import json
import pathlib
import subprocess
import sys

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="folder of the Python message classes: build/release/tests/system")
parser.add_argument("bench", help="viewer_window_bench")
parser.add_argument("--organisms", type=int, default=10_000)
parser.add_argument("--runs", type=int, default=5)
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
sys.path.insert(0, options.messages)

from bench_client import Server, assignments, benchmark_world, print_figures, spread  # noqa: E402
from evod.v1 import commands_pb2 as c  # noqa: E402

UNDER_XVFB = pathlib.Path(__file__).resolve().parents[1] / "system/viewer/under_xvfb.sh"


def measure():
    with Server(options.evod, "--keep-nothing") as server:
        server.control.call(create_world=c.CreateWorld(
            name="w", seed=1, parameters=assignments(benchmark_world(options.organisms))))
        server.control.call(run=c.Run(world="w"))
        server.control.run_to(60)
        server.control.call(run=c.Run(world="w"))
        runs = []
        for _ in range(options.runs):
            done = subprocess.run([UNDER_XVFB, options.bench, "--server", f"127.0.0.1:{server.port}", "--world", "w",
                                   "--size", "1280x720"], capture_output=True, text=True, check=True)
            runs.append(json.loads(done.stdout))
    return {"organisms": options.organisms, **{name: spread([run[name] for run in runs]) for name in runs[0]}}


print_figures(measure(), options.json)
