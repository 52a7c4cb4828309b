"""How busy a sweep keeps its cores: processor time of evod over wall time and jobs, of 64 runs of the default world.

    sweep_cost.py EVOD [--generations N] [--jobs N] [--rounds N] [--run-files] [--unequal] [--json]

What the share lacks is what a sweep does on one thread, or waits for: beginning, the disk, the last runs, the table.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("--generations", type=int, default=60, help="of each run")
parser.add_argument("--jobs", type=int, default=os.cpu_count())
parser.add_argument("--rounds", type=int, default=3)
parser.add_argument("--run-files", action="store_true", help="with a run file of each")
parser.add_argument("--unequal", action="store_true", help="populations of 10 to 150, so that runs differ in length")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()

SWEPT = {"population_size": [10, 50, 100, 150]} if options.unequal else {"mutation_chance": [0.05, 0.1, 0.2, 0.4]}
SWEEP = {"grid": {**SWEPT, "selection": ["roulette", "tournament"]}, "replicates": 8, "seed": 1,
         "generations": options.generations}


def measure(*command):
    """Wall and processor time of a process, in seconds."""
    began = time.perf_counter()
    process = subprocess.Popen([options.evod, *map(str, command)], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    wall = time.perf_counter() - began
    if status != 0:
        raise SystemExit(f"{command}: status {status}")
    return wall, used.ru_utime + used.ru_stime


rounds = []
with tempfile.TemporaryDirectory(dir=pathlib.Path.cwd()) as folder:  # on a real disk, which /tmp may not be
    file = pathlib.Path(folder) / "sweep.json"
    file.write_text(json.dumps(SWEEP))
    for number in range(options.rounds):
        out = pathlib.Path(folder) / f"out-{number}"
        files = ["--run-files"] if options.run_files else []
        wall, used = measure("sweep", file, "--out", out, "--jobs", options.jobs, *files)
        gathered, _ = measure("sweep", file, "--out", out, "--gather")
        rounds.append({"wall_s": wall, "processor_s": used, "busy_share": used / (wall * options.jobs),
                       "gather_s": gathered, "table_bytes": (out / "runs.csv").stat().st_size})

figures = {name: statistics.median(r[name] for r in rounds) for name in rounds[0]}
figures |= {"runs": 64, "jobs": options.jobs, "busy_share_least": min(r["busy_share"] for r in rounds),
            "busy_share_most": max(r["busy_share"] for r in rounds)}
if options.json:
    print(json.dumps(figures))
else:
    for name, value in figures.items():
        print(f"{name:18} {value:.4g}")
