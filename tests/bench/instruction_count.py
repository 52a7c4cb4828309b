#!/usr/bin/python3
"""Counts the instructions of fixed pieces of work under callgrind, and compares them with instruction_count.json.

Counts do not depend on who else uses the machine, so a change of a few per cent is real. More than 5 % above the
reference fails; more than 5 % below asks for the reference to be renewed. They depend on the compiler and on the
set of vector instructions that the kernels use, so every set is counted that valgrind executes; the reference names
compiler and set, and another compiler has no reference.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

folder = pathlib.Path(__file__).resolve().parent
reference_path = folder / "instruction_count.json"
works = {"ticks": "organism and tick, benchmark world of 2,000",
         "generation": "organism and tick, default world with its turnover",
         "breeding": "chromosome, 20,000 of them"}
tolerance = 0.05


def count(program, work, instruction_set):
    """What the program says about itself, with the instructions it took inside counted_work()."""
    run = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", "--collect-atstart=no",
                          "--toggle-collect=counted_work", program, work, "--instructions", instruction_set],
                         capture_output=True, text=True)
    collected = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not collected:
        sys.exit(f"instruction_count {work} under valgrind failed:\n{run.stderr}")
    return json.loads(run.stdout) | {"instructions": int(collected[1])}


def count_all(program):
    """The baseline first, the widest set last."""
    listed = subprocess.run(["valgrind", "--quiet", "--tool=none", program, "--list"], capture_output=True, text=True,
                            check=True).stdout.split()
    instruction_sets = sorted(listed, key="baseline".__ne__)
    return [count(program, work, instruction_set) for instruction_set in instruction_sets for work in works]


def place(entry):
    return entry["compiler"], entry["instruction_set"], entry["work"]


def compare(entry, reference):
    """A line for people, and whether the work has become too dear."""
    per_unit = entry["instructions"] / entry["units"]
    line = f"{entry['instruction_set']:>9} {per_unit:9.1f} instructions per {works[entry['work']]}"
    if reference is None:
        return f"{line}: no reference for {entry['compiler']}", False
    change = per_unit / (reference["instructions"] / reference["units"]) - 1
    line += f": {100 * change:+.2f} %"
    if change > tolerance:
        return line + f", which is more than {100 * tolerance:.0f} % more than the reference", True
    if change < -tolerance:
        return line + ", which is better: renew the reference with --update", False
    return line, False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="bin/instruction_count of the preset `release`")
    parser.add_argument("--update", action="store_true", help="make what is counted now the reference")
    parser.add_argument("--json", action="store_true", help="only count, and print it as JSON")
    options = parser.parse_args()
    counted = count_all(options.program)
    if options.json:
        print(json.dumps(counted))
        return
    known = {place(entry): entry for entry in json.loads(reference_path.read_text())} if reference_path.exists() else {}
    if options.update:
        known |= {place(entry): entry for entry in counted}
        lines = [json.dumps(known[key]) for key in sorted(known)]
        reference_path.write_text("[\n  " + ",\n  ".join(lines) + "\n]\n")
    failed = False
    for entry in counted:
        line, too_dear = compare(entry, known.get(place(entry)))
        print(line)
        failed |= too_dear
    sys.exit(failed)


main()
