"""tests/system/attacker.py under way, from where its work is to be seen."""
import json
import pathlib
import subprocess
import sys


class Attack:
    def __init__(self, messages, port, kind, number):
        self.process = subprocess.Popen(
            [sys.executable, str(pathlib.Path(__file__).with_name("attacker.py")), messages, str(port), kind, str(number)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout.readline() == "ready\n"

    def end(self, patience_s=None):
        """What became of it."""
        return json.loads(self.process.communicate("enough\n", patience_s)[0])
