"""Runs tests/system/attacker.py and reports its counts."""
import json
import pathlib
import subprocess
import sys

import waiting


class Attack:
    """A running attack; as a context manager it ends the attack."""

    def __init__(self, messages, port, kind, number):
        self.process = subprocess.Popen(
            [sys.executable, str(pathlib.Path(__file__).with_name("attacker.py")), messages, str(port), kind,
             str(number)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout.readline() == "ready\n"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        waiting.communicate(self.process)

    def counts(self):
        """The counts so far."""
        self.process.stdin.write("counts\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def end(self):
        """Ends the attack and returns its counts."""
        return json.loads(waiting.communicate(self.process, "enough\n")[0])
