"""Running the programs that measure: one process a run, several commands by turns, medians with least and greatest."""
import json
import statistics
import subprocess
import sys


def spread(values):
    """Median, least and greatest, to four digits."""
    digits = [float(f"{v:.4g}") for v in (statistics.median(values), min(values), max(values))]
    return dict(zip(("median", "min", "max"), digits))


def run_json(*command):
    """The JSON that a program prints, on the last line that looks like it; some libraries greet us before."""
    run = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    lines = [line for line in run.stdout.splitlines() if line.startswith(("{", "["))]
    if run.returncode != 0 or not lines:
        sys.exit(f"{' '.join(map(str, command))} failed:\n{run.stdout}{run.stderr}")
    return json.loads(lines[-1])


def by_turns(commands, repeats):
    """Runs every command once, then every command again, and so on: what disturbs the machine disturbs all alike.

    commands  list of lists of words; each prints JSON.
    returns   per command the list of what it printed.
    """
    printed = [[] for _ in commands]
    for _ in range(repeats):
        for runs, command in zip(printed, commands):
            runs.append(run_json(*command))
    return printed


def merged(runs, spread_keys):
    """One dictionary of several runs: the first one's values, but for `spread_keys`, which get their spread."""
    return runs[0] | {key: spread([run[key] for run in runs]) for key in spread_keys if key in runs[0]}
