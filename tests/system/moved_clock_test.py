"""Real servers while the wall clock is set ten years forward and back: nothing changes.

    EVOD=… EVOCTL=… MESSAGES=… MOVED_CLOCK_LIBRARY=… moved_clock_test.py
"""
import datetime
import mmap
import os
import re
import struct
import tempfile
import unittest

import waiting
from recovery_test import Client, Server, c, set_parameter, until, w

ten_years_s = 10 * 365 * 86400


class MovedClock(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.data, self.servers = folder.name, []
        path = f"{self.data}/clock"
        with open(path, "wb") as file:
            file.write(bytes(mmap.PAGESIZE))
        with open(path, "r+b") as file:
            self.moved_s = mmap.mmap(file.fileno(), 0)
        self.addCleanup(self.moved_s.close)
        self.environment = {**os.environ, "LD_PRELOAD": os.environ["MOVED_CLOCK_LIBRARY"], "MOVED_CLOCK": path}

    def tearDown(self):
        for server in self.servers:
            if server.process.poll() is None:
                server.kill()
            server.log.close()

    def serve(self, folder, *options):
        self.servers.append(Server("--data", f"{self.data}/{folder}", "--log-level", "debug", *options,
                                   env=self.environment))
        return self.servers[-1]

    def move(self, server, seconds):
        """From now on; and that the server sees it."""
        self.moved_s[:8] = struct.pack("<q", seconds)
        year = (datetime.datetime.now() + datetime.timedelta(seconds=seconds)).year

        def sees_it():
            Client(server, "is logged").socket.close()
            return re.findall(r"^\S\S\S\S", server.output(), re.M)[-1] == str(year)
        until(sees_it, f"the year {year} in the log")

    def test_an_expired_certificate_shows_its_time(self):
        waiting.run([os.environ["EVOD"], "certificate", "localhost", "--folder", self.data], check=True)
        certificate = f"{self.data}/evod.crt"
        server = Server("--data", f"{self.data}/tls", "--log-level", "debug", "--tls-cert", certificate, "--tls-key",
                        f"{self.data}/evod.key")
        self.servers.append(server)
        for seconds, words in ((ten_years_s, r"it expired on \w+ +\d+ .* GMT: the server needs a new one"),
                               (-ten_years_s, r"it is valid from \w+ +\d+ .* GMT on: is this machine's clock right\?")):
            self.moved_s[:8] = struct.pack("<q", seconds)
            done = waiting.run([os.environ["EVOCTL"], "--server", f"localhost:{server.port}", "--ca", certificate,
                                "worlds"],
                               capture_output=True, text=True, env=self.environment)
            self.assertEqual(done.returncode, 3)
            self.assertRegex(done.stderr, words)

    def run_in_stretches(self, folder, moves):
        """Runs 500 ticks for each of `moves`, in the midst of which the clock is put to so many seconds from the right
        time, and a command after each; killed and started again after the second. The last moment's tick and hash."""
        server = self.serve(folder, "--seed", "8", "--speed", "10")
        for stretch, seconds in enumerate(moves, 1):
            with Client(server, "key") as client:
                client.call(2 * stretch, run_until_tick=c.RunUntilTick(tick=500 * stretch))
                until(lambda: client.world().tick > 500 * stretch - 400, "ticks")
                self.move(server, seconds)
                until(lambda: client.world().state == w.RUN_STATE_PAUSED, "the stretch's end")
                for answered in range(1, stretch + 1):  # the last for the first time, the others again
                    response = client.call(2 * answered + 1, **set_parameter("food_health", answered))
                    self.assertEqual((response.status.code, response.applied_tick), (0, 500 * answered))
            if stretch == 2:
                server.kill()
                server = self.serve(folder)
        with Client(server, "key") as client:
            last = client.world()
        server.end()
        return last.tick, last.state_hash

    def test_runs_recovery_and_replies_are_the_same(self):
        still = self.run_in_stretches("still", [0, 0, 0, 0])
        self.assertEqual(still[0], 2000)
        self.assertEqual(self.run_in_stretches("moved", [ten_years_s, -ten_years_s, 0, ten_years_s]), still)
        self.assertEqual(self.run_in_stretches("back", [-ten_years_s, ten_years_s, -ten_years_s, 0]), still)


if __name__ == "__main__":
    unittest.main()
