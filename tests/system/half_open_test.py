"""Clients that vanish as when a cable is pulled: a real server in its own network namespace that goes down.

    EVOD=… MESSAGES=… half_open_test.py     skipped with status 77 where no such network may be made
"""
import subprocess
import time
import unittest

import namespaces

if __name__ == "__main__":
    namespaces.enter(["--net"], ["ip", "link", "set", "lo", "up"],
                     "no network of its own may be made here, or there is no ip (Debian's package iproute2)")

import recovery_test as recovery  # noqa: E402
import waiting  # noqa: E402
from recovery_test import Server, c  # noqa: E402

found_within_s = 45


class HalfOpen(unittest.TestCase):
    def test_a_vanished_client_is_detected(self):
        waiting.quicker_than(found_within_s, self.vanish)

    def vanish(self, lap):
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        server = Server("--keep-nothing", "--start", "--log-level", "debug")
        self.addCleanup(server.log.close)
        self.addCleanup(server.kill)
        # One client is idle. Another receives snapshots and reads none.
        silent, watching = recovery.Client(server, "silent"), recovery.Client(server, "watching")
        self.addCleanup(silent.socket.close)
        self.addCleanup(watching.socket.close)
        watching.call(1, subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
        self.assertEqual(server.output().count("disconnected"), 0)
        lap()
        gone = time.monotonic()
        subprocess.run(["ip", "link", "set", "lo", "down"], check=True)
        waiting.until(lambda: server.output().count("disconnected") == 2, "both are noticed",
                      stalled_s=2 * found_within_s)
        self.assertLess(time.monotonic() - gone, found_within_s)
        server.end()


if __name__ == "__main__":
    unittest.main()
