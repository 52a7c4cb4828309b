"""Hostile and failing clients with honest ones: the run stays the same, others are served, and memory is released.

EVOD names the program, MESSAGES the folder of the message classes; PAUSE_S is for how long a reader pauses, in whole
seconds, and where SANITIZED is set memory is not judged: a sanitizer keeps what has been freed. Each test lets
tests/system/attacker.py, a process of its own, at a server for a bounded time.
"""
import itertools
import math
import os
import pathlib
import re
import sys
import unittest

EVOD, MESSAGES = os.environ["EVOD"], os.environ["MESSAGES"]
sys.argv[1:1] = [EVOD, MESSAGES, "-"]  # arguments of plain_client
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import plain_client as plain  # noqa: E402
import waiting  # noqa: E402
from attack import Attack  # noqa: E402
from delta_decoder import Decoder  # noqa: E402

c, w = plain.c, plain.w
MEMORY_BACK_BYTES = math.inf if os.environ.get("SANITIZED") else 8 << 20
STEPS, STEP_TICKS = 10, 200
STALLED_S, FRAME_S, HELLO_S = (plain.limit(name) for name in ("stalled_timeout_s", "frame_timeout_s",
                                                              "hello_timeout_s"))
PAUSE_S = int(os.environ.get("PAUSE_S", 15))
PARAMETERS = {"population_size": 500, "scale_with_population": True}


class Attacked(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = plain.Server("--sessions-max", "2000")
        with plain.Client(cls.server) as client:
            cls.begin_world(client)
            cls.hash = client.run_to(STEPS * STEP_TICKS, "w").state_hash
            client.call(delete_world=c.DeleteWorld(world="w"))

    @classmethod
    def tearDownClass(cls):
        cls.server.end()
        assert "Sanitizer" not in cls.server.output(), cls.server.output()

    @staticmethod
    def begin_world(client):
        client.response(client.ask(delete_world=c.DeleteWorld(world="w")))  # left by a failed test
        client.call(create_world=c.CreateWorld(name="w", seed=1, parameters=plain.assignments(**PARAMETERS)))
        client.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))

    def memory_bytes(self):
        status = pathlib.Path(f"/proc/{self.server.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) << 10

    def honest(self, viewer, control, tick):
        """One client steps the world and one views it: both get everything they request."""
        control.call(run_until_tick=c.RunUntilTick(world="w", tick=tick))
        snapshot = viewer.next_snapshot(lambda one: viewer.decoder.decode(one) is not None and one.tick == tick)
        stepped = control.run_to(tick, "w")
        self.assertEqual(snapshot.state_hash.hex(), stepped.state_hash)
        return stepped

    def attacked(self, kind, number, at_least_s=3.0, memory_back_bytes=MEMORY_BACK_BYTES, enough=lambda counts: True):
        """The state of the attackers after honest work during the attacks."""
        with plain.Client(self.server) as control, plain.Client(self.server) as viewer:
            self.begin_world(control)
            viewer.decoder = Decoder(plain.zstd_content)
            viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=20,
                                                                 codec=plain.stream_pb2.CODEC_DELTA))
            self.honest(viewer, control, 1)
            before = self.memory_bytes()
            with Attack(MESSAGES, self.server.port, kind, number) as attack:
                # paced so that it lasts that long
                pace = w.Speed(real_time_factor=STEPS * STEP_TICKS / 60 / at_least_s)
                control.call(set_speed=c.SetSpeed(world="w", speed=pace))
                for step in range(1, STEPS + 1):
                    stepped = self.honest(viewer, control, step * STEP_TICKS)
                self.assertEqual(stepped.state_hash, self.hash)
                further_steps = itertools.count(STEPS + 1)

                def is_enough():
                    if enough(attack.counts()):
                        return True
                    self.honest(viewer, control, next(further_steps) * STEP_TICKS)  # attackers still get snapshots
                    return False
                plain.until(is_enough, f"enough of {kind}")
                became = attack.end()
            plain.until(lambda: self.memory_bytes() <= before + memory_back_bytes, "memory comes back")
            control.call(delete_world=c.DeleteWorld(world="w"))
        return became


class Hostile(Attacked):
    def test_a_thousand_idle_sessions(self):
        def stay(_):
            became = self.attacked("idle", 1000)
            self.assertEqual((became["open"], became["closed"]), (1000, 0))
        waiting.quicker_than(HELLO_S, stay)

    def test_two_hundred_clients_send_single_bytes(self):
        became = self.attacked("slow", 200, at_least_s=1.3 * FRAME_S, enough=lambda counts: counts["closed"] >= 200)
        self.assertGreater(became["closed_after_s"][0], 0.5 * HELLO_S)

    def test_a_hundred_subscribers_never_read(self):
        became = self.attacked("deaf", 100, at_least_s=2.0 * STALLED_S, enough=lambda counts: counts["closed"] == 100)
        self.assertEqual((became["open"], became["closed"]), (0, 100))
        self.assertGreater(became["closed_after_s"][0], 0.9 * STALLED_S)  # data already in the kernel is sent first

    def test_five_hundred_connections_a_second(self):
        self.attacked("connects", 500, enough=lambda counts: counts["connected"] > 500)

    def test_fifty_thousand_malformed_frames_a_second(self):
        # With a slow attacker as many answers wait as allowed; the heap does not shrink for one session.
        self.attacked("malformed", 50_000, memory_back_bytes=MEMORY_BACK_BYTES +
                      plain.limit("queued_response_bytes_max"),
                      enough=lambda counts: counts["frames"] > 1000)

    def test_a_pausing_reader_is_closed_and_reconnects(self):
        def has_come_again(counts):
            return (counts.get("paused", 0) >= 1 and counts["closed"] >= 1 and counts["connected"] >= 2 and
                    counts["bytes"] > 5000)  # of snapshots, since it reconnected
        self.attacked("pauses", PAUSE_S, at_least_s=PAUSE_S + 5.0, enough=has_come_again)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
