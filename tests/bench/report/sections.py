"""What is measured: every section gives a piece of the results, as plain lists and dictionaries."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from . import programs

folder = pathlib.Path(__file__).resolve().parent
python = "/usr/bin/python3"  # the one that Debian's python3-* packages belong to
rates = ("organism_ticks_per_s", "organism_ticks_per_processor_s")
warm_up_ticks, measured_ticks = 60, 60


class Bench:
    """Where programs are, and how thorough to be."""

    def __init__(self, root, build, repeats, quick):
        self.root, self.bin, self.build, self.repeats, self.quick = root, build / "bin", build, repeats, quick

    def program(self, name):
        return self.bin / name


def workload_command(bench, program, organisms, scenes, *, threads=1, islands=1, spatial_order=False,
                     instructions=None, steering=None):
    return [bench.program("workload_bench"), "--program", program, "--organisms", organisms, "--scenes", scenes,
            "--threads", threads, "--islands", islands, "--warm-up-ticks", warm_up_ticks, "--ticks", measured_ticks,
            "--least-s", 0.1 if bench.quick else 0.5, *(["--spatial-order"] if spatial_order else []),
            *(["--instructions", instructions] if instructions else []),
            *(["--steering", steering] if steering else [])]


def engines_of(bench):
    listed = subprocess.run([bench.program("workload_bench"), "--list"], capture_output=True, text=True, check=True)
    return [name for name in listed.stdout.split() if name != "evod"]


def workload(bench):
    """evod on one thread and two, and the engines, at each population; everything of a population by turns."""
    engines = engines_of(bench)
    engine_most = {"all_pairs": 200 if bench.quick else 2_000}
    populations = [20, 200, 2_000, 20_000] if bench.quick else [20, 200, 2_000, 20_000, 200_000, 1_000_000]
    rows = []
    for organisms in populations:
        scenes = max(1, min(50, 4_000 // organisms))
        commands = [workload_command(bench, "evod", organisms, scenes, threads=n) for n in (1, 2)]
        for engine in engines:
            if organisms > engine_most.get(engine, 2_000 if bench.quick else 20_000):
                continue
            commands.append(workload_command(bench, engine, organisms, scenes))
            if organisms >= 20_000 and engine != "all_pairs":
                commands.append(workload_command(bench, engine, organisms, scenes, spatial_order=True))
        rows += [programs.merged(runs, rates) for runs in programs.by_turns(commands, bench.repeats)]
        print(f"   {organisms} organisms", flush=True)
    return rows


def islands(bench):
    commands = [workload_command(bench, "evod", organisms, 1, threads=threads, islands=64)
                for organisms in ([500] if bench.quick else [500, 5_000]) for threads in (1, 2)]
    return [programs.merged(runs, rates) for runs in programs.by_turns(commands, bench.repeats)]


def instruction_sets(bench):
    """evod with each set of vector instructions that the processor has, by turns; the baseline first."""
    listed = subprocess.run([bench.program("instruction_count"), "--list"], capture_output=True, text=True, check=True)
    commands = [workload_command(bench, "evod", 20_000, 1, instructions=name)
                for name in sorted(listed.stdout.split(), key="baseline".__ne__)]
    return [programs.merged(runs, rates) for runs in programs.by_turns(commands, bench.repeats)]


def networks(bench):
    """evod with rules and with networks, by turns; the rules first."""
    commands = [workload_command(bench, "evod", organisms, scenes, steering=steering)
                for organisms, scenes in ([(20_000, 1)] if bench.quick else [(1_000, 4), (20_000, 1), (200_000, 1)])
                for steering in ("rules", "newtonian", "kinematic")]
    return [programs.merged(runs, rates) for runs in programs.by_turns(commands, bench.repeats)]


def agreement(bench):
    """The same whole generations in every program, and what happened in them."""
    scenes = 1 if bench.quick else 8
    programs_here = ["evod"] + [e for e in engines_of(bench) if e != "all_pairs" or not bench.quick]
    rows = [programs.run_json(bench.program("workload_bench"), "--program", program, "--organisms", 500, "--scenes",
                              scenes, "--warm-up-ticks", 0, "--ticks", 2_400, "--look-every", 60)
            for program in programs_here]
    for row in rows[1:]:
        for key in ("food_per_organism_s", "speed_mean_px_s"):
            if abs(row[key] / rows[0][key] - 1) > 0.05:
                print(f"scripts/benchmark: {row['program']} does other work than evod: {key} {row[key]:.4g}, not "
                      f"{rows[0][key]:.4g}", file=sys.stderr)
    return rows


def genetic(bench):
    """The repeats have different seeds, and the programs have the same ones."""
    commands = {"evod": [bench.program("evod_rastrigin")], "galib": [bench.program("galib_rastrigin")],
                "deap": [python, bench.root / "tests/bench/genetic/deap_rastrigin.py"]}
    if not bench.program("galib_rastrigin").exists():
        del commands["galib"]
    if subprocess.run([python, "-c", "import deap"], capture_output=True).returncode != 0:
        del commands["deap"]
    rows = []
    for population in ([1_000] if bench.quick else [1_000, 10_000]):
        generations = 20 if bench.quick else 100
        runs = {name: [] for name in commands}
        for seed in range(1, bench.repeats + 1):
            for name, command in commands.items():
                runs[name].append(programs.run_json(*command, "--population", population, "--generations", generations,
                                                    "--seed", seed))
        rows += [programs.merged(each, ("ms_per_generation", "fitness_best")) for each in runs.values()]
    return rows


def google_benchmark(bench, name, *arguments):
    """The median, least and greatest of each benchmark of a program, by name; None if there is no such program."""
    if not bench.program(name).exists():
        return None
    run = subprocess.run([bench.program(name), "--benchmark_format=json", *arguments,
                          f"--benchmark_repetitions={bench.repeats}"], capture_output=True, text=True, check=True)
    found = {}
    for entry in json.loads(run.stdout)["benchmarks"]:
        if entry["run_type"] == "iteration":
            found.setdefault(entry["run_name"], []).append(entry)
    return found


def breeding(bench):
    """ms of one breeding, per choice of the genetic algorithm's stages."""
    wanted = "next_generation/(.*chromosomes:100000/threads:1/|population_model=hybrid/chromosomes:1000000/)"
    found = google_benchmark(bench, "next_generation_bench", f"--benchmark_filter={wanted}",
                             f"--benchmark_min_time={0.02 if bench.quick else 0.1}")
    rows = []
    for name, entries in found.items():
        _, choice, chromosomes, threads = name.split("/")[:4]
        rows.append({"choice": choice, "chromosomes": int(chromosomes.split(":")[1]),
                     "threads": int(threads.split(":")[1]),
                     "ms": programs.spread([entry["real_time"] for entry in entries])})
    return rows


def phases(bench):
    """ns an organism and tick of each phase of a tick, from phase_bench if it was built.

    Its benchmarks are named PHASE/ORGANISMS and say how many organisms they did as items_per_second; the phase
    `whole tick` is an island's.
    """
    found = google_benchmark(bench, "phase_bench")
    return [{"phase": name.split("/")[0], "organisms": int(name.split("/")[1]),
             "ns": programs.spread([1e9 / entry["items_per_second"] for entry in entries])}
            for name, entries in (found or {}).items()]


def densities(bench):
    """ns an organism and tick, and µs a tick, of worlds that are unlike the benchmark world; by turns."""
    found = google_benchmark(bench, "density_bench", "--benchmark_enable_random_interleaving=true") or {}
    return [{"world": name.split("/")[0],
             "ns": programs.spread([1e9 / entry["items_per_second"] for entry in entries]),
             "tick_us": programs.spread([entry["tick_us"] for entry in entries])}
            for name, entries in found.items()]


def machine_roofs(bench):
    return programs.run_json(bench.program("machine"))


def instructions(bench):
    return programs.run_json(python, bench.root / "tests/bench/instruction_count.py",
                             bench.program("instruction_count"), "--json")


def drawing(bench):
    """Milliseconds of the drawing thread per frame, by number of organisms, drawn in software under Xvfb: with OpenGL
    when the whole island is visible, and without it for a frame with a new snapshot, at the slower of two zooms; in the
    slower skin."""
    if not bench.program("viewer_frame_bench").exists():
        return []
    run = subprocess.run([bench.root / "tests/system/viewer/under_xvfb.sh", bench.program("viewer_frame_bench"),
                          "--benchmark_format=json",
                          "--benchmark_filter=zoom:1/new_snapshot:0/driver:1$|new_snapshot:1/driver:0$"],
                         capture_output=True, text=True)
    if run.returncode != 0 or not run.stdout.startswith("{"):
        print(f"scripts/benchmark: viewer_frame_bench did not run: {run.stdout[:200]}{run.stderr[-200:]}",
              file=sys.stderr)
        return []
    rows = {}
    for entry in json.loads(run.stdout)["benchmarks"]:
        organisms = int(re.search(r"organisms:(\d+)", entry["name"])[1])
        row = rows.setdefault(organisms, {"organisms": organisms})
        key = "ms" if "driver:1" in entry["name"] else "own_ms"
        row[key] = max(row.get(key, 0), entry["cpu_time"] / 1e3)
    return list(rows.values())


def of_server(bench, program):
    return programs.run_json(python, bench.root / "tests/bench" / program, bench.program("evod"),
                             bench.build / "tests/system", "--json", *(["--runs", 2] if bench.quick else []))


def server(bench):
    return {**of_server(bench, "viewer_cost.py"), "storage": of_server(bench, "storage_cost.py")}


def run_files(bench):
    quick = ["--checkpoints", 3] if bench.quick else []
    checkpoints = [programs.run_json(bench.program("checkpoint_bench"), "--organisms", organisms, *quick)
                   for organisms in (10_000, 100_000)]
    return {**of_server(bench, "run_file_cost.py"), "checkpoints": checkpoints}


def stream(bench):
    return of_server(bench, "stream_cost.py")


def package(bench):
    quick = ["--rounds", 3, "--seconds", 2, "--organisms", 2_000] if bench.quick else []
    figures = programs.run_json(python, bench.root / "tests/bench/python_cost.py", bench.program("evod"),
                                bench.build / "python", "--json", *quick)
    rounds = ["--rounds", 3] if bench.quick else []
    figures["evaluate"] = programs.run_json(python, bench.root / "tests/bench/evaluate_cost.py", bench.program("evod"),
                                            bench.build / "python", "--json", *rounds)
    return figures


def optimisers(bench):
    seeds = ["--seeds", 3] if bench.quick else []
    load = os.getloadavg()[0]
    rows = programs.run_json(python, bench.root / "tests/bench/optimisers.py", bench.program("evod"),
                             bench.build / "python", "--json", *seeds)
    return {"date": time.strftime("%F"), "load": load, "rows": rows}


def clients(bench):
    return of_server(bench, "network_cost.py")


def sweeps(bench):
    quick = ["--rounds", 1, "--generations", 20] if bench.quick else []
    return programs.run_json(python, bench.root / "tests/bench/sweep_cost.py", bench.program("evod"), "--json", *quick)


def evod_run(bench, *arguments):
    """One `evod run`: its speed and times, and the most memory it took."""
    with tempfile.TemporaryFile("w+") as text:
        began = time.perf_counter()
        process = subprocess.Popen([bench.program("evod"), "run", "--json", *map(str, arguments)],
                                   stdout=text, stderr=text)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - began
        process.returncode = os.waitstatus_to_exitcode(status)
        text.seek(0)
        said = text.read()
    if process.returncode != 0:
        sys.exit(f"evod run {arguments} failed:\n{said}")
    run = json.loads(said.splitlines()[-1])
    return {"m_organism_ticks_per_s": run["organism_ticks"] / run["tick_s"] / 1e6,
            "real_time_factor": run["simulated_s"] / run["tick_s"],
            "start_up_s": run["start_s"], "turnover_s": run["turnover_s"], "wall_s": wall,
            "memory_bytes": usage.ru_maxrss * 1024}


def whole_program(bench):
    default = [evod_run(bench, "--seed", 1, "--threads", 1, "--generations", 20 if bench.quick else 100)
               for _ in range(bench.repeats)]
    organisms = 100_000 if bench.quick else 1_000_000
    large = [bench.root / "experiments/bench.json", "--seed", 1, "--generations", 2, "--set",
             f"population_size={organisms}", "--set", "generation_s=1"]
    networks = evod_run(bench, *large, "--set", "controller=network", "--set", "brain_hidden=8")
    return {"default": programs.merged(default, tuple(default[0])),
            "large": evod_run(bench, *large) | {"organisms": organisms},
            "networks": networks | {"organisms": organisms},
            "disk_bytes": {name: bench.program(name).stat().st_size for name in ("evod", "evoctl", "evoview")
                           if bench.program(name).exists()}}


everything = {"machine": machine_roofs, "workload": workload, "islands": islands, "densities": densities,
              "agreement": agreement, "networks": networks, "instruction_sets": instruction_sets,
              "instructions": instructions,
              "phases": phases, "genetic": genetic, "breeding": breeding, "runs": whole_program,
              "server": server, "clients": clients, "run_files": run_files, "stream": stream, "sweeps": sweeps,
              "package": package, "optimisers": optimisers,
              "drawing": drawing}


def columns():
    return json.loads((folder / "columns.json").read_text())["passes"]
