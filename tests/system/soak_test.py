"""Clients that come and go for a long time and worlds that are reset many times: the server does not grow.

EVOD names the program, MESSAGES the folder of the message classes. SECONDS, which is 20 unless it is set, is for how
long they come and go, and RESETS, 250, how often worlds are reset. Where SANITIZED is set there are fewer at a time,
and the memory is not judged: a sanitizer keeps what has been freed.
"""
import math
import os
import sys
import time
import unittest

import hostile_test as hostile
from hostile_test import c, plain, w

SECONDS, ROUND_S = float(os.environ.get("SECONDS", 20)), 10.0
RESETS, AT_ONCE, TICKS_EACH = int(os.environ.get("RESETS", 250)), 25, 3
CLIENTS, GROWTH_BYTES = (25, math.inf) if os.environ.get("SANITIZED") else (100, 8 << 20)


class Soak(hostile.Attacked):
    def test_clients_come_and_go(self):
        """Repeats the attacks together with honest clients."""
        begun, rounds, connected = time.monotonic(), [], 0
        while len(rounds) < 3 or time.monotonic() - begun < SECONDS:
            # The first round brings the heap to its size.
            back_bytes = GROWTH_BYTES if rounds else 8 * GROWTH_BYTES
            became = self.attacked("churn", CLIENTS, at_least_s=ROUND_S, memory_back_bytes=back_bytes,
                                   enough=lambda counts: counts["closed"] > 5 * CLIENTS)
            connected += became["connected"]
            with plain.Client(self.server) as last:
                plain.until(lambda: self.sessions(last) == 1, "all have gone")
            rounds.append(self.memory_bytes())
        print(f"{connected} clients; MiB after each round:", *(f"{x / (1 << 20):.1f}" for x in rounds), file=sys.stderr)
        self.assertLess(rounds[-1], rounds[0] + GROWTH_BYTES)

    @staticmethod
    def sessions(client):
        families = client.call(get_metrics=c.GetMetrics()).metrics.families
        return sum(sample.value for family in families if family.name == "evod_sessions" for sample in family.samples)

    def test_worlds_are_reset_many_times(self):
        with plain.Client(self.server) as control, plain.Client(self.server) as viewer:
            control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=plain.assignments(
                population_size=10, food_count=5, poison_count=5)))
            control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
            viewer.call(subscribe_events=c.SubscribeEvents(world="w"))
            viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=60))
            memory, hashes = [], set()
            while len(memory) < 10:
                for _ in range(RESETS // 10 // AT_ONCE):
                    asked = [control.ask(reset_world=c.ResetWorld(world="w")) for _ in range(AT_ONCE)]
                    self.assertEqual({control.response(one).status.code for one in asked}, {0})
                    hashes.add(control.run_to(TICKS_EACH, "w").state_hash)
                    viewer.next_snapshot(lambda one: one.tick == TICKS_EACH)
                    viewer.events.clear()
                memory.append(self.memory_bytes())
            control.call(delete_world=c.DeleteWorld(world="w"))
        print(f"{RESETS} resets; MiB after each tenth:", *(f"{x / (1 << 20):.1f}" for x in memory), file=sys.stderr)
        self.assertEqual(len(hashes), 1)  # no other seed was given
        self.assertLess(memory[-1], memory[0] + GROWTH_BYTES)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
