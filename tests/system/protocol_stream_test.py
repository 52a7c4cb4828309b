"""Streams of the protocol: deltas, and views of regions.

Arguments as in plain_client.py.
"""
import math
import sys
import time
import unittest

import numpy

from delta_decoder import Decoder, TilesDecoder
from plain_client import (
    INVALID, NOT_FOUND, PRECONDITION, Client, columns, set_parameters, WithServer, zstd_content, c,
    session_pb2, stream_pb2, w,
)


class Deltas(WithServer):
    """CODEC_DELTA. Every delta received is decoded, so its base must be the snapshot sent before it."""

    def setUp(self):
        super().setUp()
        self.viewer = self.enterContext(Client(self.server))
        self.decoders = {}

    def subscribe(self, world, codec=stream_pb2.CODEC_DELTA, rate_hz=120.0, **fields):
        return self.viewer.call(subscribe_snapshots=c.SubscribeSnapshots(
            world=world, codec=codec, rate_hz=rate_hz, **fields)).subscription.subscription_id

    def acknowledge(self, snapshot):
        self.viewer.send(session_pb2.ClientMessage(acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
            subscription_id=snapshot.subscription_id, island=snapshot.island, sequence=snapshot.sequence)))

    def next(self, condition=lambda snapshot: True):
        """The next snapshot that fulfils the condition, and its entities. Earlier ones are decoded, too."""
        while True:
            snapshot = self.viewer.next_snapshot()
            self.assertGreater(snapshot.sequence, 0)
            if snapshot.codec == stream_pb2.CODEC_PLAIN:
                seen = columns(snapshot)
            else:
                decoder = self.decoders.setdefault((snapshot.subscription_id, snapshot.island), Decoder(zstd_content))
                seen = {kind: {field: column if field in ("id", "dx", "dy") else column / 16
                               for field, column in fields.items()} for kind,
                        fields in decoder.decode(snapshot).items()}
            if condition(snapshot):
                return snapshot, seen

    def assert_same(self, seen, expected):
        for kind, fields in expected.items():
            for field, column in fields.items():
                numpy.testing.assert_array_equal(seen[kind][field], column, f"{kind} {field}")

    def compare(self, world, generations):
        """Views the world with every codec at once until all have shown many equal ticks."""
        kinds = {self.subscribe(world, stream_pb2.CODEC_PLAIN): "plain", self.subscribe(world): "delta",
                 self.subscribe(world, compression=stream_pb2.COMPRESSION_ZSTD): "zstd"}
        self.client.call(run=c.Run(world=world))
        shown, alike, deltas, last_generation = {}, 0, 0, 0
        while alike < 100 or deltas < 100 or last_generation < generations:
            snapshot, seen = self.next()
            deltas += snapshot.base_sequence > 0
            if snapshot.base_sequence > 0:
                self.assertEqual((snapshot.world, snapshot.run_id, snapshot.width_px), ("", b"", 0))
            of_hash = shown.setdefault((snapshot.state_hash, snapshot.island), {})
            of_hash[kinds[snapshot.subscription_id]] = seen
            if len(of_hash) == 3:
                self.assert_same(of_hash["delta"], of_hash["plain"])
                self.assert_same(of_hash["zstd"], of_hash["plain"])
                shown.pop((snapshot.state_hash, snapshot.island))
                alike += 1
                last_generation = snapshot.generation

    def test_deltas_equal_plain_snapshots(self):
        world = self.new_world(seed=3, obstacle_count=3, crate_count=4, obstacle_size_px=50, crate_size_px=30,
                               island_count=2, generation_s=2)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=4)))
        self.compare(world, 3)

    def test_deltas_show_wide_islands(self):
        self.compare(self.new_world(island_width_px=5000.0, crate_count=4), 1)

    def test_islands_and_worlds_that_are_gone_are_not_sent(self):
        world = self.new_world(island_count=3)
        self.subscribe(world)
        for _ in range(3):
            self.next()
        self.client.call(set_parameters=set_parameters(world, island_count=1))
        run = self.client.call(reset_world=c.ResetWorld(world=world)).world.run_id
        keyframe, _ = self.next(lambda p: p.base_sequence == 0 and p.run_id.hex() == run)
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=keyframe.subscription_id))
        again, _ = self.next()
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(([again.island, again.run_id.hex()], self.viewer.snapshots), ([0, run], []))
        self.client.call(delete_world=c.DeleteWorld(world=world))
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=keyframe.subscription_id))
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])
        self.client.call(create_world=c.CreateWorld(name=world))  # for the end of the test
        self.next(lambda p: p.base_sequence == 0)

    def test_a_new_viewer_causes_no_snapshots_for_others(self):
        world = self.new_world()
        self.viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=0.01,
                                                                  codec=stream_pb2.CODEC_DELTA))
        self.next()
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world))
        with Client(self.server) as restless:
            for _ in range(50):
                subscription = restless.call(subscribe_snapshots=c.SubscribeSnapshots(
                    world=world, rate_hz=0.01, codec=stream_pb2.CODEC_DELTA)).subscription
                self.assertEqual(restless.next_snapshot().base_sequence, 0)
                restless.call(unsubscribe=c.Unsubscribe(subscription_id=subscription.subscription_id))
                restless.snapshots.clear()
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertLess(len(self.viewer.snapshots), 5)  # only those of the commands, none for the new viewer

    def test_a_requested_keyframe_comes_from_a_paused_world(self):
        world = self.new_world()
        self.client.run_to(20, world)
        subscription = self.subscribe(world)
        first, seen = self.next()
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription))
        again, seen_again = self.next()
        self.assertEqual((again.base_sequence, again.sequence, again.body), (0, first.sequence, first.body))
        self.assert_same(seen_again, seen)
        status = self.viewer.call(NOT_FOUND, request_keyframe=c.RequestKeyframe(subscription_id=99)).status
        self.assertEqual([v.field for v in status.violations], ["request_keyframe.subscription_id"])

    def test_a_keyframe_follows_a_damaged_snapshot(self):
        world = self.new_world()
        subscription = self.subscribe(world)
        self.client.call(run=c.Run(world=world))
        snapshot, _ = self.next(lambda p: p.base_sequence > 0)
        decoder = self.decoders[subscription, 0]
        damaged = self.viewer.next_snapshot(lambda p: p.base_sequence > 0)
        damaged.body = bytes([damaged.body[0] ^ 1]) + damaged.body[1:]
        with self.assertRaisesRegex(ValueError, "damaged|not the last"):
            decoder.decode(damaged)
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription))
        keyframe = self.viewer.next_snapshot(lambda p: p.base_sequence == 0)  # deltas are discarded meanwhile
        decoder.decode(keyframe)
        self.next(lambda p: p.base_sequence > 0)

    def test_the_newest_snapshot_waits_for_acknowledgements(self):
        world = self.new_world()
        subscription = self.subscribe(world, unacknowledged_max=2)
        self.client.call(run=c.Run(world=world))
        first, second = self.next()[0], self.next()[0]
        with Client(self.server) as other:
            other.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=120))
            other.next_snapshot(lambda p: p.tick > second.tick + 60)
            paused = self.client.call(pause=c.Pause(world=world)).world
            other.next_snapshot(lambda p: p.tick == paused.tick)
        self.viewer.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.viewer.snapshots, [])  # two are unacknowledged
        self.acknowledge(first)
        newest, _ = self.next()
        self.assertEqual((newest.tick, newest.base_sequence), (paused.tick, 0))
        self.assertGreater(newest.dropped_count, 0)
        self.acknowledge(newest)
        self.client.call(run=c.Run(world=world))
        for _ in range(20):
            snapshot, _ = self.next()
            self.acknowledge(snapshot)
        self.viewer.send(session_pb2.ClientMessage(acknowledge_snapshot=session_pb2.AcknowledgeSnapshot(
            subscription_id=subscription + 1, island=7, sequence=1)))  # is ignored

    def test_invalid_subscriptions_are_refused(self):
        world = self.new_world()
        plain_by_zstd = c.SubscribeSnapshots(world=world, rate_hz=1, compression=stream_pb2.COMPRESSION_ZSTD)
        status = self.viewer.call(INVALID, subscribe_snapshots=plain_by_zstd).status
        self.assertEqual([v.field for v in status.violations], ["subscribe_snapshots.codec"])
        for field, number in (("codec", 1), ("codec", 99), ("compression", 99), ("unacknowledged_max", 0),
                              ("unacknowledged_max", 1001)):
            status = self.viewer.call(INVALID, subscribe_snapshots=c.SubscribeSnapshots(
                world=world, rate_hz=1, **{field: number})).status
            self.assertEqual([v.field for v in status.violations], ["subscribe_snapshots." + field])


class Views(WithServer):
    """Snapshots in tiles, compared with CODEC_PLAIN of the same ticks."""

    def setUp(self):
        super().setUp()
        self.viewer = self.enterContext(Client(self.server))
        self.decoders = {}

    def wide_world(self, **parameters):
        return self.new_world(**{"seed": 3, "population_size": 200, "food_count": 300, "poison_count": 200,
                                 "island_width_px": 2600.0, "island_height_px": 1700.0, "obstacle_count": 6,
                                 "crate_count": 20, **parameters})

    def subscribe(self, world, view=None, rate_hz=120.0, **fields):
        codec = stream_pb2.CODEC_PLAIN if view is None else stream_pb2.CODEC_DELTA
        return self.viewer.call(subscribe_snapshots=c.SubscribeSnapshots(
            world=world, codec=codec, rate_hz=rate_hz, view=view, **fields)).subscription.subscription_id

    def set_view(self, subscription, **view):
        answer = self.viewer.call(set_view=c.SetView(subscription_id=subscription, view=c.View(**view))).subscription
        self.assertEqual(answer.subscription_id, subscription)

    def change_view(self, subscription, **view):
        """Sends set_view. Afterwards next() returns only snapshots sent after the change."""
        self.set_view(subscription, **view)
        while self.viewer.snapshots:
            self.next()

    def next(self, condition=lambda snapshot: True):
        """The next snapshot that fulfils the condition, and the contents of its tiles. Earlier ones are decoded,
        too."""
        while True:
            snapshot = self.viewer.next_snapshot()
            seen = None
            if snapshot.codec == stream_pb2.CODEC_DELTA:
                self.assertEqual(snapshot.base_sequence, 0)
                self.assertEqual((snapshot.tile_px, snapshot.body), (512, b""))
                decoder = self.decoders.setdefault((snapshot.subscription_id, snapshot.island),
                                                   TilesDecoder(zstd_content))
                seen = decoder.decode(snapshot)
            if condition(snapshot):
                return snapshot, seen

    def tiles_of(self, snapshot):
        return math.ceil(snapshot.width_px / 512), math.ceil(snapshot.height_px / 512)

    def in_tiles(self, plain_snapshot):
        """{kind: {"tile": …, "id": …, "x": …, …}} in 1/16 px, of a snapshot of CODEC_PLAIN."""
        across, down = self.tiles_of(plain_snapshot)
        entities = {}
        for kind, fields in columns(plain_snapshot).items():
            of_kind = {field: numpy.asarray(column * (1 if field == "id" else 16), numpy.int64)
                       for field, column in fields.items()}
            of_kind.setdefault("id", numpy.arange(len(of_kind["x"])))
            of_kind["tile"] = (numpy.minimum(of_kind["y"] // 8192, down - 1) * across +
                               numpy.minimum(of_kind["x"] // 8192, across - 1))
            entities[kind] = of_kind
        return entities

    def assert_full(self, seen, entities):
        """Asserts that the tiles of DETAIL_FULL together show exactly the entities in them."""
        for kind, expected in entities.items():
            there = numpy.isin(expected["tile"], list(seen))
            order = numpy.argsort(numpy.concatenate([of[kind]["id"] for of in seen.values()] or [[]]), kind="stable")
            for field in set(expected) - {"tile"}:
                together = numpy.concatenate([of[kind][field] for of in seen.values()] or [[]])
                numpy.testing.assert_array_equal(together[order], expected[field][there], f"{kind} {field}")

    def touched(self, snapshot, region):
        across, down = self.tiles_of(snapshot)
        return [row * across + column for row in range(down) for column in range(across)
                if column * 512 < region.left_px + region.width_px and (column + 1) * 512 > region.left_px and
                row * 512 < region.top_px + region.height_px and (row + 1) * 512 > region.top_px and
                region.left_px < snapshot.width_px and region.top_px < snapshot.height_px]

    def watch_together(self, world, generations=1, **fields):
        """Subscribes to plain snapshots, to all tiles, and to a region that moves with every snapshot."""
        whole, all_tiles = self.subscribe(world), self.subscribe(world, c.View(), **fields)
        panning = self.subscribe(world, c.View(region=c.Region(left_px=-500, width_px=600, height_px=600)), **fields)
        regions, step = {}, 0
        self.client.call(run=c.Run(world=world))
        shown, alike, bases, last_generation = {}, 0, {all_tiles: 0, panning: 0}, 0
        while alike < 150 or min(bases.values()) < 150 or last_generation < generations:
            snapshot, seen = self.next()
            subscription = snapshot.subscription_id
            if seen is not None:
                bases[subscription] += sum(tile.base_sequence > 0 for tile in snapshot.tiles)
                self.assertEqual([tile.tile for tile in snapshot.tiles], sorted(seen))
                self.assertTrue(all(tile.detail == stream_pb2.DETAIL_FULL for tile in snapshot.tiles))
            if subscription == panning:
                step += 1
                if step % 3 == 0:
                    region = c.Region(left_px=step * 17 % 3400 - 500, top_px=step * 11 % 2200 - 300, width_px=600,
                                      height_px=600)
                    self.set_view(panning, region=region)
                    regions[tuple(self.touched(snapshot, region))] = True
                    if len(seen) > 0:
                        self.assertLess(len(seen), 10)
            of_hash = shown.setdefault(snapshot.state_hash, {})
            of_hash[subscription] = snapshot if seen is None else seen
            if whole in of_hash and len(of_hash) > 1:
                entities = self.in_tiles(of_hash[whole])
                for seen in [of_hash.pop(name) for name in (all_tiles, panning) if name in of_hash]:
                    self.assert_full(seen, entities)
                    alike += 1
                last_generation = snapshot.generation
        self.assertGreater(len(regions), 3)

    def test_all_tiles_and_regions_equal_plain_snapshots(self):
        world = self.wide_world(generation_s=2)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(real_time_factor=3)))
        self.watch_together(world, 2)

    def test_compressed_tiles_of_wide_islands_equal_plain(self):
        self.watch_together(self.wide_world(island_width_px=5000.0), compression=stream_pb2.COMPRESSION_ZSTD)

    def test_dots_and_densities_are_counted_right(self):
        world = self.wide_world()
        whole = self.subscribe(world)
        kinds = {self.subscribe(world, c.View(detail=detail), compression=compression): detail
                 for detail in (stream_pb2.DETAIL_DOTS, stream_pb2.DETAIL_DENSITY) for compression in (1, 2)}
        self.client.run_to(30, world)
        snapshots = {}
        while len(snapshots) < 5:
            snapshot, seen = self.next(lambda p: p.tick == 30)
            snapshots[snapshot.subscription_id] = snapshot, seen
        entities = self.in_tiles(snapshots[whole][0])
        across, down = self.tiles_of(snapshots[whole][0])
        for subscription, detail in kinds.items():
            snapshot, seen = snapshots[subscription]
            self.assertEqual(sorted(seen), list(range(across * down)))
            self.assertEqual({tile.detail for tile in snapshot.tiles}, {detail})
            for kind, of_kind in list(entities.items())[:5 if detail == stream_pb2.DETAIL_DOTS else 3]:
                for tile, shown in seen.items():
                    there = of_kind["tile"] == tile
                    x, y = of_kind["x"][there] - tile % across * 8192, of_kind["y"][there] - tile // across * 8192
                    if detail == stream_pb2.DETAIL_DOTS:
                        numpy.testing.assert_array_equal(shown[kind]["x"], x // 32)
                        numpy.testing.assert_array_equal(shown[kind]["y"], y // 32)
                    else:
                        cells = len(shown[kind])
                        self.assertGreater(cells, 1)
                        expected = numpy.zeros((cells, cells), int)
                        numpy.add.at(expected, (y * cells // 8192, x * cells // 8192), 1)
                        numpy.testing.assert_array_equal(shown[kind], expected)

    def test_a_moved_region_is_sent_from_a_paused_world(self):
        world = self.wide_world()
        self.client.run_to(20, world)
        subscription = self.subscribe(world, c.View(region=c.Region(width_px=600, height_px=100)))
        first, seen = self.next()
        self.assertEqual(sorted(seen), [0, 1])
        self.assertGreater(first.organism_count, sum(tile.organism_count for tile in first.tiles))
        self.set_view(subscription, region=c.Region(left_px=520, width_px=600, height_px=100))
        moved, seen_moved = self.next()
        self.assertEqual([(t.tile, t.base_sequence) for t in moved.tiles], [(1, first.sequence), (2, 0)])
        for kind, fields in seen_moved[1].items():
            for field, column in fields.items():
                numpy.testing.assert_array_equal(column, seen[1][kind][field])
        self.set_view(subscription, region=c.Region(width_px=10, height_px=10))
        back, _ = self.next()
        self.assertEqual([(t.tile, t.base_sequence) for t in back.tiles], [(0, 0)])
        for outside in ({"left_px": -700}, {"left_px": 2600}, {"top_px": 5000}, {"left_px": 1e300}):
            self.set_view(subscription, region=c.Region(width_px=600, height_px=600, **outside))
            self.assertEqual(self.next()[1], {})
        self.set_view(subscription)
        self.assertEqual(len(self.next()[1]), 6 * 4)

    def test_a_damaged_tile_is_mended_by_a_keyframe(self):
        world = self.wide_world()
        subscription = self.subscribe(world, c.View())
        self.client.call(run=c.Run(world=world))
        self.next(lambda p: any(t.base_sequence for t in p.tiles))
        decoder = self.decoders[subscription, 0]
        damaged = self.viewer.next_snapshot()
        damaged.tiles[3].body = bytes([damaged.tiles[3].body[0] ^ 1]) + damaged.tiles[3].body[1:]
        with self.assertRaisesRegex(ValueError, "damaged|not the last"):
            decoder.decode(damaged)
        self.viewer.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription))
        decoder.decode(self.viewer.next_snapshot(lambda p: not any(t.base_sequence for t in p.tiles)))
        self.next(lambda p: all(t.base_sequence for t in p.tiles))

    def test_a_budget_reduces_detail_then_rate_and_is_kept(self):
        world = self.wide_world()
        subscription = self.subscribe(world, c.View(), rate_hz=60)
        self.client.call(run=c.Run(world=world))
        self.assertEqual({t.detail for t in self.next()[0].tiles}, {stream_pb2.DETAIL_FULL})
        began = time.monotonic()
        wanted_bytes_per_s = sum(8 + self.next()[0].ByteSize() for _ in range(60)) / (time.monotonic() - began)
        # A few times too much for the first budget, and far too much for the second, on any machine.
        for bytes_per_s, dropped_count in (wanted_bytes_per_s // 4, 0), (wanted_bytes_per_s // 100, 100):
            bytes_per_s = max(1000, int(bytes_per_s))
            began, got, details, snapshot = time.monotonic(), 0, set(), None
            self.change_view(subscription, bytes_per_s_max=bytes_per_s)
            while (got < 5 * bytes_per_s or stream_pb2.DETAIL_DENSITY not in details or
                   snapshot.dropped_count < dropped_count):
                snapshot, _ = self.next()
                got += 8 + snapshot.ByteSize()
                details |= {tile.detail for tile in snapshot.tiles}
            # In addition to what was saved and in transit.
            self.assertLess(got, bytes_per_s * (time.monotonic() - began + 2) + 60_000)
        self.set_view(subscription)
        self.next(lambda p: {t.detail for t in p.tiles} == {stream_pb2.DETAIL_FULL})

    def test_invalid_views_are_refused(self):
        world = self.new_world()
        nan, good = float("nan"), {"width_px": 1.0, "height_px": 1.0}
        wrong = [("region.left_px", {"region": c.Region(**good, left_px=nan)}),
                 ("region.top_px", {"region": c.Region(**good, top_px=float("inf"))}),
                 ("region.width_px", {"region": c.Region(width_px=0, height_px=1)}),
                 ("region.height_px", {"region": c.Region(width_px=1, height_px=nan)}),
                 ("detail", {"detail": 9}), ("bytes_per_s_max", {"bytes_per_s_max": 999}),
                 ("bytes_per_s_max", {"bytes_per_s_max": 10 ** 12 + 1})]
        subscription = self.subscribe(world, c.View())
        for field, view in wrong:
            for path, request in (("subscribe_snapshots.view.", {"subscribe_snapshots": c.SubscribeSnapshots(
                    world=world, rate_hz=1, codec=2, view=c.View(**view))}),
                    ("set_view.view.", {"set_view": c.SetView(subscription_id=subscription, view=c.View(**view))})):
                status = self.viewer.call(INVALID, **request).status
                self.assertEqual([v.field for v in status.violations], [path + field])
                self.assertTrue(status.violations[0].allowed and status.violations[0].got)
        for codec in (stream_pb2.CODEC_UNSPECIFIED, stream_pb2.CODEC_PLAIN):
            status = self.viewer.call(INVALID, subscribe_snapshots=c.SubscribeSnapshots(
                world=world, rate_hz=1, codec=codec, view=c.View())).status
            self.assertEqual([v.field for v in status.violations], ["subscribe_snapshots.codec"])
        status = self.viewer.call(INVALID, set_view=c.SetView(subscription_id=subscription)).status
        self.assertEqual([v.field for v in status.violations], ["set_view.view"])
        status = self.viewer.call(NOT_FOUND, set_view=c.SetView(subscription_id=99, view=c.View())).status
        self.assertEqual([v.field for v in status.violations], ["set_view.subscription_id"])
        whole = self.subscribe(world)
        self.viewer.call(PRECONDITION, set_view=c.SetView(subscription_id=whole, view=c.View()))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
