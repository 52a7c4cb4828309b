"""Clients that are gone without a word, as when a cable is pulled: a real server in a network of its own that goes down.

    EVOD=… MESSAGES=… half_open_test.py     skipped with status 77 where no such network may be made
"""
import os
import shutil
import subprocess
import sys
import time
import unittest

skipped = 77
if __name__ == "__main__" and "NETWORK" not in os.environ:
    unshare = ["unshare", "--user", "--map-root-user", "--net"]
    tried = shutil.which("ip") and subprocess.run([*unshare, "ip", "link", "set", "lo", "up"], capture_output=True)
    if not tried or tried.returncode != 0:
        print("skipped: no network of its own may be made here, or there is no ip (Debian's package iproute2)")
        sys.exit(skipped)
    os.execvpe(unshare[0], [*unshare, sys.executable, __file__, *sys.argv[1:]], {**os.environ, "NETWORK": "own"})

import recovery_test as recovery  # noqa: E402
from recovery_test import Server, c  # noqa: E402

found_within_s = 45


class HalfOpen(unittest.TestCase):
    def test_who_is_gone_without_a_word_is_noticed(self):
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        server = Server("--keep-nothing", "--start")
        self.addCleanup(server.log.close)
        self.addCleanup(server.kill)
        # One says nothing and is sent nothing; another is sent pictures, which nobody takes.
        silent, watching = recovery.Client(server, "silent"), recovery.Client(server, "watching")
        self.addCleanup(silent.socket.close)
        self.addCleanup(watching.socket.close)
        watching.call(1, subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
        self.assertEqual(server.output().count("disconnected"), 0)
        gone = time.monotonic()
        subprocess.run(["ip", "link", "set", "lo", "down"], check=True)
        recovery.until(lambda: server.output().count("disconnected") == 2, "both are noticed")
        self.assertLess(time.monotonic() - gone, found_within_s)
        server.end()


if __name__ == "__main__":
    unittest.main()
