"""The memory that clients make the server hold, compared with the memory that it counts, and with its limits. A viewer
does what costs most; the memory of the server must stay below the documented bound, and an administrator is served.

EVOD and EVOCTL name the programs, MESSAGES the folder of the message classes.
"""
import pathlib
import re
import select
import sys
import threading
import time
import unittest

import access_test as access
from access_test import ADMIN, VIEWER, c, plain

MIB = 1 << 20
BEYOND_MIB = 128  # what the server needs in addition to client_buffer_bytes_max
ISLANDS = 4096


def rss_mib(server):
    return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path(f"/proc/{server.process.pid}/status").read_text())[1]) >> 10


class Reader(threading.Thread):
    """Reads what arrives on many sockets, and drops it."""
    def __init__(self):
        super().__init__(daemon=True)
        self.sockets, self.over = [], False
        self.start()

    def run(self):
        while not self.over:
            for ready in select.select(list(self.sockets), [], [], 0.05)[0]:
                try:
                    if ready.recv(1 << 20):
                        continue
                except OSError:
                    pass
                self.sockets.remove(ready)  # the server has closed it

    def stop(self):
        self.over = True
        self.join()


class Attacks(access.Access):
    def setUp(self):
        super().setUp()
        self.token("ada", ADMIN)
        self.token("eve", VIEWER)

    def begin(self):
        """A server with a paused world of many islands. A first viewer has received its snapshots, so what the server
        needs for itself is allocated."""
        server = self.serve("--durability", "relaxed", "--require-token")
        admin = self.come(server, self.secrets["ada"])
        admin.call(create_world=c.CreateWorld(name="many", seed=1, parameters=plain.assignments(
            island_count=ISLANDS, population_size=4)))
        admin.call(run_until_tick=c.RunUntilTick(world="many", tick=2))
        admin.wait_world(lambda world: world.tick == 2, "many")
        with access.Client(server, self.secrets["eve"]) as first:
            first.call(subscribe_snapshots=c.SubscribeSnapshots(world="many", rate_hz=60))
            for _ in range(ISLANDS):
                first.next_snapshot()
        return server, admin

    def metric(self, admin, name):
        families = admin.call(get_metrics=c.GetMetrics()).metrics.families
        return next(family.samples[0].value for family in families if family.name == name)

    def counted_mib(self, admin):
        return self.metric(admin, "evod_client_buffer_bytes") / MIB

    def limit_reached(self, admin):
        families = admin.call(get_metrics=c.GetMetrics()).metrics.families
        return next(sample.value for family in families if family.name == "evod_limit_reached_total"
                    for sample in family.samples for label in sample.labels if label.value == "client_buffer_bytes_max")

    def subscribe(self, client, **fields):
        for i in range(4):
            client.ask(subscribe_snapshots=c.SubscribeSnapshots(
                world="many", rate_hz=1 + i, codec=plain.stream_pb2.CODEC_DELTA,
                view=c.View(detail=plain.stream_pb2.DETAIL_DENSITY), **fields))

    def ask_keyframes(self, client, count):
        try:
            for i in range(count):
                client.ask(request_keyframe=c.RequestKeyframe(subscription_id=1 + i % 4))
        except OSError:
            pass  # the server has closed it

    def observe(self, server, admin):
        """The highest memory and the highest count, in MiB, until both have not grown any more for a while. The
        administrator is answered meanwhile."""
        rss = counted = unchanged = 0
        while unchanged < 100:
            now = max(rss, rss_mib(server)), max(counted, self.counted_mib(admin))
            unchanged = 0 if now > (rss, counted) else unchanged + 1
            rss, counted = now
            time.sleep(0.01)
        return rss, counted

    def check(self, what, before, rss, counted, limit):
        print(f"{what}: {before} MiB before, {rss} MiB at the most, of which {counted:.0f} MiB were counted",
              file=sys.stderr)
        self.assertLess(rss, limit // MIB + BEYOND_MIB)
        self.assertLess(counted, limit // MIB * 5 / 8, "a user may hold half, and a check allows for some growth")
        self.assertGreater(counted, (rss - before) / 2 - 8, "most of the growth is counted")

    def test_subscriptions_that_are_read(self):
        server, admin = self.begin()
        reader, before = Reader(), rss_mib(server)
        for _ in range(40):
            client = self.come(server, self.secrets["eve"])
            self.subscribe(client, unacknowledged_max=1)
            reader.sockets.append(client.socket)
            self.ask_keyframes(client, 28)
        rss, counted = self.observe(server, admin)
        reader.stop()
        self.check("subscriptions that are read", before, rss, counted, admin.welcome.limits.client_buffer_bytes_max)

    def test_keyframes_that_are_not_read(self):
        server, admin = self.begin()
        before = rss_mib(server)
        clients = [self.come(server, self.secrets["eve"]) for _ in range(40)]
        for client in clients:
            self.subscribe(client)
            self.ask_keyframes(client, 28)
        rss, counted = self.observe(server, admin)
        for client in clients:
            self.ask_keyframes(client, 28)
        rss, counted = max((rss, counted), self.observe(server, admin))
        self.check("keyframes that are not read", before, rss, counted, admin.welcome.limits.client_buffer_bytes_max)

    def test_groups_of_a_single_session(self):
        server, admin = self.begin()
        before = rss_mib(server)
        for i in range(40):
            client = self.come(server, self.secrets["eve"])
            for k in range(4):  # no other subscription has this rate, so each has snapshots of its own
                client.ask(subscribe_snapshots=c.SubscribeSnapshots(
                    world="many", rate_hz=1 + i / 10 + k / 100, codec=plain.stream_pb2.CODEC_DELTA))
        admin.call(run=c.Run(world="many"))
        plain.until(lambda: self.limit_reached(admin) > 0, "a session is closed")
        rss, counted = self.observe(server, admin)
        self.check("groups of a single session", before, rss, counted, admin.welcome.limits.client_buffer_bytes_max)

    def begin_large(self):
        """As begin(), with a world of 50,000 organisms that has run for three ticks."""
        server, admin = self.begin()
        admin.call(create_world=c.CreateWorld(name="large", seed=1, parameters=plain.assignments(
            population_size=50_000, scale_with_population=True)))
        admin.call(run_until_tick=c.RunUntilTick(world="large", tick=3))
        admin.wait_world(lambda world: world.tick >= 3, "large")
        return server, admin

    def test_replays(self):
        server, admin = self.begin_large()
        before, counted = rss_mib(server), self.counted_mib(admin)
        client = self.come(server, self.secrets["eve"])
        for _ in range(4):
            client.call(open_replay=c.OpenReplay(world="large"))
        grown, held = rss_mib(server) - before, self.counted_mib(admin) - counted
        print(f"4 replays of 50,000 organisms: {grown} MiB, of which {held:.0f} MiB are counted", file=sys.stderr)
        self.assertGreater(held, 0.6 * grown)
        self.assertGreater(held, 20)
        client.call(close_replay=c.CloseReplay(world="large@1"))
        plain.until(lambda: self.counted_mib(admin) < counted + 0.8 * held, "one is no longer counted")
        client.socket.close()
        plain.until(lambda: self.counted_mib(admin) < counted + 1, "none is counted")

    def test_the_opener_of_a_replay_is_charged(self):
        """Also if another session moves or closes it."""
        server, admin = self.begin_large()
        counted = self.counted_mib(admin)
        client = self.come(server, self.secrets["eve"])
        replay = client.call(open_replay=c.OpenReplay(world="large")).world.name
        plain.until(lambda: self.counted_mib(admin) > counted + 5, "it is counted")
        held = self.counted_mib(admin)
        other = self.come(server, self.secrets["ada"])
        other.call(seek=c.Seek(world=replay, to=c.RunMoment(tick=2)))
        other.socket.close()
        plain.until(lambda: self.counted_mib(admin) < held + 1, "the session that moved it is not charged")
        self.assertGreater(self.counted_mib(admin), counted + 5)
        admin.call(close_replay=c.CloseReplay(world=replay))
        plain.until(lambda: self.counted_mib(admin) < counted + 1, "it is not counted any more")

    def test_waiting_queries_evict_no_session(self):
        server, admin = self.begin()
        admin.call(create_world=c.CreateWorld(name="w", seed=1, parameters=plain.assignments(
            population_size=20, generation_s=1)))
        admin.call(set_speed=c.SetSpeed(world="w", speed=plain.w.Speed(max=True)))
        admin.call(run_until_tick=c.RunUntilTick(world="w", tick=600))
        clients = [self.come(server, self.secrets["eve"]) for _ in range(120)]
        for _ in range(3):
            for client in clients:
                client.ask(get_history=c.GetHistory(world="w"))
            self.assertLess(self.counted_mib(admin), 64)
            for client in clients:
                client.response(client.request_id)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
