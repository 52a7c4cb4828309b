"""What it costs to share a world among the processes of mpirun, and what that predicts for clusters (docs/SCALING.md).

    exchange_cost.py FOLDER [--organisms N] [--rounds N] [--model]

FOLDER contains evod, evod_mpi.so and exchange_cost: build/release/bin. Without --model, measures on this machine: the
time of exchanges between two processes, and a world of eight islands with one process and one thread, two processes,
and two threads. It repeats each measurement and takes the shortest, because other programs may use the machine. Then it
prints weak and strong scaling to 1,000 processes, calculated from the constants below. --model prints only these
tables.
"""
import argparse
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "system"))
from open_mpi import OPEN_MPI  # noqa: E402

# The model: the time of a generation is the longest time that a process computes, and what all of them exchange.
ORGANISM_TICKS_PER_S = 36e6  # of a thread; measured: 8 islands of 10,000 organisms
ISLAND_SPREAD = 0.05  # standard deviation of the time of an island, as a share of its mean; assumed
TICKS, SLICE_TICKS = 2400, 240  # of a generation; of a slice of `evod run` without a run file
SERVER_SLICE_S = 0.015  # of a slice of a server at full speed
STATISTICS_BYTES, MIGRANT_BYTES = 700, 44  # of an island; of a migrant
STORED_BYTES = 60  # of an organism and generation in a run file
DISK_BYTES_PER_S = 200e6  # of a network file system; assumed
# Seconds of a small message, bytes per second. The first is measured, the others are from literature.
NETWORKS = {"shared memory": (0.9e-6, 4e9), "InfiniBand": (2e-6, 12e9), "10 GbE": (25e-6, 1.1e9)}


def generation(processes, islands, organisms, threads, network, run_file=False, server=False):
    """The parts of the time of a generation, in seconds."""
    message_s, bytes_per_s = NETWORKS[network]
    most = math.ceil(islands / processes)  # islands of a process
    mean_s = most * organisms * TICKS / (ORGANISM_TICKS_PER_S * threads)
    rounds = math.ceil(math.log2(processes)) if processes > 1 else 0
    slice_ticks = 60 if run_file else SLICE_TICKS
    slices = math.ceil(min(TICKS, max(mean_s / SERVER_SLICE_S, TICKS / 60)) if server else TICKS / slice_ticks)
    # One after another: an order and an exchange of states per slice; statistics, migrants, beginning of the
    # generation.
    messages = rounds * (3 * slices + 8)
    exchanged = islands * (STATISTICS_BYTES + 32 * slices) + most * MIGRANT_BYTES
    # The expected largest of R sums of `most` normally distributed times.
    wait_s = mean_s * ISLAND_SPREAD / math.sqrt(most) * math.sqrt(2 * math.log(processes)) if processes > 1 else 0
    stored = islands * organisms * STORED_BYTES if run_file else 0
    received_s = stored / bytes_per_s * (processes - 1) / processes
    # Rank 0 receives between two generations; the disk writes while the next one is simulated.
    computed_s = mean_s + wait_s + messages * message_s + (exchanged / bytes_per_s if processes > 1 else 0)
    return {"compute": mean_s, "wait": wait_s, "exchange": computed_s - mean_s - wait_s, "receive": received_s,
            "all": max(computed_s + received_s, stored / DISK_BYTES_PER_S)}


def print_table(title, rows, network):
    print(f"\n{title}, {network}: seconds of a generation of `evod run`\n"
          "                                             run file              efficiency\n"
          "processes   compute   waiting  exchange   to rank 0   with it  without  server without it")
    first = None
    for row in rows:
        stored, plain, served = (generation(*row, network, **kind)
                                 for kind in ({"run_file": True}, {}, {"server": True}))
        processes, islands, organisms, _ = row
        work = islands * organisms / processes
        first = first or work / plain["all"]
        shares = [work / parts["all"] / first for parts in (stored, plain, served)]
        print(f"{processes:9} {plain['compute']:9.3f} {plain['wait']:9.3f} {plain['exchange']:9.4f} "
              f"{stored['receive']:11.2f} "
              f"{shares[0]:9.0%} {shares[1]:8.0%} {shares[2]:9.0%}          {'#' * round(30 * shares[1])}")


def print_model():
    for network in "InfiniBand", "10 GbE":
        print_table("Weak scaling, 8 islands of 10,000 organisms and 2 threads a process",
                    [(r, 8 * r, 10_000, 2) for r in (1, 2, 8, 64, 256, 1000)], network)
        print_table("Strong scaling, 1,000 islands of 10,000 organisms, 1 thread a process",
                    [(r, 1000, 10_000, 1) for r in (1, 2, 8, 64, 256, 500, 1000)], network)
    print_table("Strong scaling of small islands, 1,000 of 50 organisms, 1 thread a process",
                [(r, 1000, 50, 1) for r in (1, 2, 8, 64, 256, 500, 1000)], "10 GbE")


def started(words, processes=1):
    """What a program prints that mpirun starts; one process is started without it."""
    words = (["mpirun", "-n", str(processes)] if processes > 1 else []) + [str(word) for word in words]
    return subprocess.run(words, env={**os.environ, **OPEN_MPI}, stdout=subprocess.PIPE, text=True, check=True).stdout


def measure_exchanges(folder, rounds):
    best = {}
    for _ in range(rounds):
        for line in started([folder / "exchange_cost"], 2).splitlines():
            operation, size, shortest, median = line.split()
            key = operation, int(size)
            best[key] = min(best.get(key, (math.inf, math.inf)), (float(median), float(shortest)))
    print("exchanges between two processes    median µs   shortest µs   MB/s received")
    for (operation, size), (median, shortest) in best.items():
        print(f"{operation:9} {size:10} B each {median:19.2f} {shortest:13.2f} {size / median:15.0f}")


def measure_scaling(folder, organisms, rounds):
    experiment = {"island_count": 8, "migration": "ring", "migration_epoch": 1, "population_size": organisms,
                  "scale_with_population": True, "reference_population": 50, "generation_s": 20, "generation_limit": 1}
    kinds = {"1 process, 1 thread": (1, 1), "2 processes, 1 thread": (2, 1), "1 process, 2 threads": (1, 2)}
    best = {}
    with tempfile.TemporaryDirectory() as temporary:
        file = pathlib.Path(temporary) / "islands.json"
        file.write_text(json.dumps(experiment))
        for _ in range(rounds):
            for kind, (processes, threads) in kinds.items():
                before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
                output = started([folder / "evod", "run", file, "--json", "--seed", 1, "--threads", threads], processes)
                used_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
                run = json.loads(output.splitlines()[-1])
                whole_s = run["tick_s"] + run["turnover_s"]
                speed = run["organism_ticks"] / run["tick_s"] / 1e6
                found = whole_s, run["turnover_s"], 100 * run["exchange_s"] / whole_s, speed, used_s
                best[kind] = min(best.get(kind, found), found)
    print(f"\n8 islands of {organisms} organisms, ring, one generation of {TICKS // 2} ticks")
    for kind, (seconds, turnover_s, exchange, speed, used_s) in best.items():
        print(f"{kind:22} {seconds:7.2f} s, {best['1 process, 1 thread'][0] / seconds:.2f} times as fast; turnover "
              f"{turnover_s:.3f} s, exchange {exchange:.1f} %, {speed:.1f} M organism-ticks/s, "
              f"{used_s:.2f} s of processor time")


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("folder", type=pathlib.Path, help="of the programs")
parser.add_argument("--organisms", type=int, default=10_000, help="of an island")
parser.add_argument("--rounds", type=int, default=3)
parser.add_argument("--model", action="store_true", help="print only the tables of the model")
options = parser.parse_args()
if not options.model:
    measure_exchanges(options.folder.resolve(), options.rounds)
    measure_scaling(options.folder.resolve(), options.organisms, options.rounds)
print_model()
