"""Measures how long the requests of one user take while another one takes all that a pool of the server gives.

    quota_cost.py EVOD MESSAGES [--rounds N] [--only POOL] [--json]

Runs the attacks of tests/system/quota_test.py. For each, the program prints the longest duration of each request of the
other user in N rounds, in milliseconds. The first row is without an attack. A refused request ends the attack's row.
"""
import argparse
import json
import os
import pathlib
import re
import sys

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("evod", help="the program")
parser.add_argument("messages", help="folder of the Python message classes: build/release/tests/system")
parser.add_argument("--rounds", type=int, default=20)
parser.add_argument("--only", help="the attack of this name")
parser.add_argument("--json", action="store_true", help="print the figures as JSON")
options = parser.parse_args()
os.environ.update(EVOD=options.evod, EVOCTL="", MESSAGES=options.messages)
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "system"))
sys.argv[1:] = []
import quota_test as quota  # noqa: E402

TARGET_MS = 1000


def measure(ground, pool, attacked):
    """The longest duration of each request in milliseconds, or the refusal that ended the rounds."""
    server, longest = quota.Server(ground.folder), {}
    try:
        with quota.Ada(ground, server, pool) as ada:
            eve = quota.Greedy(ground, server, pool) if attacked else None
            try:
                if eve:
                    eve.__enter__()
                for _ in range(options.rounds):
                    for what, seconds in ada.one_of_everything().items():
                        longest[what] = max(longest.get(what, 0), 1e3 * seconds)
            except AssertionError as fault:
                message = re.search(r"message: \"(.*)\"", str(fault))
                longest["refused"] = message[1] if message else str(fault).splitlines()[0]
            finally:
                if eve:
                    eve.__exit__()
    finally:
        server.kill()
        server.log.close()
    return longest


ground = quota.Ground()
figures = {}
print_row = print if not options.json else lambda *_: None
heading = None
for pool in ["no attack", *quota.POOLS]:
    if options.only in (None, pool):
        figures[pool] = measure(ground, "sessions" if pool == "no attack" else pool, pool != "no attack")
        if heading is None:
            heading = [what for what in figures[pool] if what != "refused"]
            print_row(f"{'longest, ms':18}", *(f"{what:>17}" for what in heading))
        print_row(f"{pool:18}", *(f"{figures[pool][what]:16.0f}{'!' if figures[pool][what] > TARGET_MS else ' '}"
                                  if what in figures[pool] else f"{'-':>17}" for what in heading),
                  figures[pool].get("refused", ""), flush=True)
ground.cleanup()
if options.json:
    print(json.dumps(figures))
