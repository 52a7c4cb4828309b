"""The snapshot decoder against the reference decoder of the protocol's tests, for every view; and damaged snapshots."""
import copy
import random
import struct
import threading
import unittest
import zlib

import delta_decoder  # the reference decoder, in tests/system
import numpy

import evod
from evod import snapshot_decoder
from evod.v1 import commands_pb2 as c, stream_pb2

from core_support import CoreTestCase

BUSY = {"population_size": 300, "island_width_px": 3000, "island_height_px": 3000, "food_count": 400,
        "poison_count": 300,
        "crate_count": 10, "obstacle_count": 5, "generation_s": 5, "respawn_s": 0.2}


def recorded(lab, world, count, **options):
    """The messages of `count` snapshots as they arrive while the world runs."""
    messages, take = [], lab._link.core._take_snapshot

    def keep(message):
        messages.append(copy.deepcopy(message))
        take(message)

    lab._link.core._take_snapshot = keep
    with world.snapshots(120, **options) as snapshots:
        world.run()
        for _ in range(count):
            next(snapshots)
    world.pause()
    lab._link.core._take_snapshot = take
    return messages


def unpack(data):
    return snapshot_decoder._unpack(data, 1 << 28)


class Decoder(CoreTestCase):
    @classmethod
    def setUpClass(cls):
        with evod.local(seed=3, experiment=BUSY) as lab:
            world = lab.world()
            world.set_speed(3)
            cls.deltas = recorded(lab, world, 60)
            world.set_speed("max")
            cls.deltas += recorded(lab, world, 60)  # across ends of generations
            world.set_speed(3)
            cls.full = recorded(lab, world, 20, region=(0, 0, 1200, 1200))
            cls.dots = recorded(lab, world, 3, detail="dots")
            cls.density = recorded(lab, world, 3, detail="density")

            with world.snapshots(1) as snapshots:  # the same state again, plain
                cls.same = next(snapshots)
            found, take = [], lab._link.core._take_snapshot
            lab._link.core._take_snapshot = lambda message: found.append(
                message) if message.codec == stream_pb2.CODEC_PLAIN else take(message)
            plain = c.SubscribeSnapshots(world=world.name, rate_hz=1)
            # a collected subscription would be unsubscribed
            held = lab._link.core.subscribe(c.Request(subscribe_snapshots=plain))
            while not found:
                world.info()
            (cls.plain,) = found
            del held

    def assert_same(self, entities, reference, columns):
        for name in columns:
            numpy.testing.assert_array_equal(entities._columns[name], reference[name])

    def test_deltas_decode_as_in_the_reference_decoder(self):
        self.assertGreater(len({message.generation for message in self.deltas}), 2)
        self.assertGreater(sum(message.base_sequence != 0 for message in self.deltas), 50)
        decoder, reference = snapshot_decoder.SnapshotDecoder(), delta_decoder.Decoder(unpack)
        for message in self.deltas:
            if not message.base_sequence:
                reference = delta_decoder.Decoder(unpack)
            snapshot, content = decoder.decode(message), reference.decode(message)
            self.assertEqual((snapshot.world, snapshot.width_px, snapshot.tick), ("default", 3000, message.tick))
            self.assert_same(snapshot.organisms, content["organisms"], ("id", "x", "y", "radius", "health", "dx", "dy"))
            self.assert_same(snapshot.food, content["food"], ("id", "x", "y"))
            self.assert_same(snapshot.poison, content["poison"], ("id", "x", "y"))
            self.assert_same(snapshot.crates, content["crates"], ("x", "y", "half_width", "half_height", "dx", "dy"))
            self.assert_same(snapshot.obstacles, content["obstacles"], ("x", "y", "half_width", "half_height"))

    def test_plain_snapshots_and_deltas_decode_to_the_same(self):
        snapshot = snapshot_decoder.SnapshotDecoder().decode(self.plain)
        self.assertEqual((snapshot.tick, snapshot.state_hash), (self.same.tick, self.same.state_hash))
        for kind in ("organisms", "food", "poison", "crates", "obstacles"):
            numpy.testing.assert_array_equal(getattr(snapshot, kind).x_px, getattr(self.same, kind).x_px)
            numpy.testing.assert_array_equal(getattr(snapshot, kind).y_px, getattr(self.same, kind).y_px)
        numpy.testing.assert_array_equal(snapshot.organisms.health, self.same.organisms.health)
        numpy.testing.assert_array_equal(snapshot.crates.half_width_px, self.same.crates.half_width_px)

    def test_damaged_plain_snapshots_are_refused(self):
        damages = (lambda m: m.ClearField("plain"), lambda m: m.plain.food.id.append(10**6),
                   lambda m: m.plain.crates.x_px.pop(), lambda m: m.plain.organisms.id.__setitem__(1, 0),
                   lambda m: m.plain.poison.x_px.__setitem__(0, float("nan")),
                   lambda m: setattr(m, "organism_count", 2**32 - 1))
        for damage in damages:
            message = copy.deepcopy(self.plain)
            damage(message)
            with self.assertRaises(evod.DamagedData):
                snapshot_decoder.SnapshotDecoder().decode(message)

    def test_tiles_decode_as_in_the_reference_decoder(self):
        for messages in (self.full, self.dots, self.density):
            decoder, reference = snapshot_decoder.SnapshotDecoder(), delta_decoder.TilesDecoder(unpack)
            for message in messages:
                snapshot, seen = decoder.decode(message), reference.decode(message)
                self.assertEqual([tile.index for tile in snapshot.tiles], list(seen))
                self.assertTrue(snapshot.tiles)
                full = [seen[tile.index] for tile in snapshot.tiles if tile.detail == stream_pb2.DETAIL_FULL]
                if full:
                    ids = numpy.concatenate([content["organisms"]["id"] for content in full])
                    xs = numpy.concatenate([content["organisms"]["x"] for content in full])
                    numpy.testing.assert_array_equal(snapshot.organisms.id, numpy.sort(ids))
                    numpy.testing.assert_array_equal(snapshot.organisms.x_px, xs[numpy.argsort(ids)] / 16)
                for tile in snapshot.tiles:
                    if tile.dots is not None:
                        x = seen[tile.index]["food"]["x"] * (tile.side_px / 256) + tile.left_px
                        numpy.testing.assert_allclose(tile.dots["food"][0], x)
                    if tile.density is not None:
                        numpy.testing.assert_array_equal(tile.density["poison"], seen[tile.index]["poison"])
        self.assertEqual({tile.detail for message in self.dots for tile in message.tiles}, {2})
        self.assertEqual({tile.detail for message in self.density for tile in message.tiles}, {3})

    def test_later_snapshots_leave_earlier_ones_unchanged(self):
        decoder = snapshot_decoder.SnapshotDecoder()
        snapshots = [decoder.decode(message) for message in self.deltas[:30]]
        again = snapshot_decoder.SnapshotDecoder()
        for snapshot, message in zip(snapshots, self.deltas):
            numpy.testing.assert_array_equal(snapshot.organisms.x_px, again.decode(message).organisms.x_px)
        with self.assertRaises(ValueError):
            snapshots[0].organisms.id[0] = 7

    # ---- headings ----------------------------------------------------------------------------------------------------

    def of_one_organism(self, sequence, count, organisms):
        """A delta (if sequence is 1, a keyframe) of an island, and the same of its only tile. `organisms`: their
        section."""
        part = {"sequence": sequence, "base_sequence": sequence - 1, "organism_count": count,
                "body": b"\1\0" + organisms + b"\0\0\0\0"}
        frame = {"codec": stream_pb2.CODEC_DELTA, "position_bytes": 2, "width_px": 100, "height_px": 100}
        tile = stream_pb2.SnapshotTile(detail=stream_pb2.DETAIL_FULL, **part)
        head = struct.pack("<QQ6I", sequence, sequence - 1, count, 0, 0, 0, 0, 2) + part["body"]
        tile.checksum = zlib.crc32(struct.pack("<III", 512, 0, tile.detail) + head)
        return (stream_pb2.SnapshotFrame(checksum=zlib.crc32(head), **frame, **part),
                stream_pb2.SnapshotFrame(tile_px=512, sequence=sequence, tiles=[tile], **frame))

    def test_sections_without_organisms_have_no_headings(self):
        def comes(heading):  # id 0, at (0, 0), with radius and health 0
            return b"\6\1\0\0\0\0" + bytes(8) + bytes((heading,)) + b"\0\0"

        leaves, stays, turns_by_3 = b"\1\1\0\0\0\0", b"\0\0\0\0", b"\4\0\0\0\1\3"
        moments = ((1, comes(254)), (1, turns_by_3), (0, leaves), (0, b"\0"), (1, comes(5)), (1, turns_by_3))
        for form in (0, 1):
            messages = [self.of_one_organism(sequence, *moment)[form] for sequence, moment in enumerate(moments, 1)]
            decoder = snapshot_decoder.SnapshotDecoder()
            reference = (delta_decoder.TilesDecoder if form else delta_decoder.Decoder)(unpack)
            for message, headings in zip(messages, ([254], [1], [], [], [5], [8])):
                organisms, content = decoder.decode(message).organisms, reference.decode(message)
                organisms_there = (content[0] if form else content)["organisms"]
                steps = numpy.rint(organisms.headings * 128 / numpy.pi) % 256
                self.assertEqual((len(organisms), steps.tolist()), (len(headings), headings))
                self.assertEqual(organisms_there.get("heading", numpy.zeros(0)).tolist(), headings)
            for wrong in (stays, leaves + b"\0\0\0"):
                decoder = snapshot_decoder.SnapshotDecoder()
                decoder.decode(messages[0])
                with self.assertRaisesRegex(evod.DamagedData, "only one of a snapshot and its base has headings"):
                    decoder.decode(self.of_one_organism(2, 1, wrong)[form])
        of_food = bytearray(self.of_one_organism(1, 0, b"\0")[0].body)
        of_food[3] = 4
        with self.assertRaisesRegex(evod.DamagedData, "parts of food are 4, allowed: 0 to 3"):
            snapshot_decoder.SnapshotDecoder().decode(self.resealed(self.of_one_organism(1, 0, b"\0")[0],
                                                                    bytes(of_food)))

    def test_headings_decode_as_in_the_reference_decoder(self):
        few = {"controller": "network", "brain_hidden": 1, "population_size": 12, "generation_s": 30,
               "island_width_px": 1500, "island_height_px": 1500}
        counts, emptied, filled = {}, 0, 0

        def count_changed_tiles(message):
            nonlocal emptied, filled
            for tile in message.tiles:
                if tile.base_sequence:
                    emptied += counts[tile.tile] > 0 and tile.organism_count == 0
                    filled += counts[tile.tile] == 0 and tile.organism_count > 0
                counts[tile.tile] = tile.organism_count
        with evod.local(seed=3, experiment=few) as lab:
            world = lab.world()
            messages, take = [], lab._link.core._take_snapshot
            lab._link.core._take_snapshot = lambda message: (messages.append(copy.deepcopy(message)), take(message))
            with world.snapshots(120, region=(0, 0, 1500, 1500)) as snapshots:
                next(snapshots)
                looked_at = 0
                while len(messages) < 61 or not (emptied and filled):  # a slow machine receives fewer snapshots
                    self.assertLess(len(messages), 1000)
                    world.step(30)
                    next(snapshots)
                    for message in messages[looked_at:]:
                        count_changed_tiles(message)
                        looked_at += 1
            self.assertEqual(lab._link.core.damaged_snapshot_count, 0)
        decoder, reference = snapshot_decoder.SnapshotDecoder(), delta_decoder.TilesDecoder(unpack)
        for message in messages:
            snapshot, seen = decoder.decode(message), reference.decode(message)
            there = [content["organisms"] for content in seen.values() if len(content["organisms"]["id"])]
            if there:
                ids, headings = (numpy.concatenate([organisms[field] for organisms in there])
                                 for field in ("id", "heading"))
                steps = numpy.rint(snapshot.organisms.headings * 128 / numpy.pi) % 256
                numpy.testing.assert_array_equal(steps, headings[numpy.argsort(ids)])

    # ---- damaged snapshots -------------------------------------------------------------------------------------------

    def resealed(self, message, body):
        """The message with another body and its correct checksum."""
        message = copy.deepcopy(message)
        message.body, message.compression = body, stream_pb2.COMPRESSION_NONE
        counts = snapshot_decoder._counts_of(message)
        head = struct.pack("<QQ6I", message.sequence, message.base_sequence, *counts, message.position_bytes)
        message.checksum = zlib.crc32(head + body)
        return message

    def test_damaged_bodies_are_refused_or_keep_their_counts(self):
        chance = random.Random(5)
        base = self.deltas[0]
        victims = [message for message in self.deltas[:4]]
        refused = 0
        for message in victims:
            whole = unpack(message.body) if message.compression == 2 else message.body
            for _ in range(300):
                body = bytearray(whole)
                for _ in range(chance.choice((1, 1, 3))):
                    at = chance.randrange(len(body))
                    body[at] = chance.choice((0, 1, 127, 128, 255, chance.randrange(256)))
                if chance.random() < 0.3:
                    del body[chance.randrange(len(body)):]
                decoder = snapshot_decoder.SnapshotDecoder()
                for before in self.deltas[: self.deltas.index(message)]:
                    decoder.decode(before)
                try:
                    snapshot = decoder.decode(self.resealed(message, bytes(body)))
                except evod.DamagedData:
                    refused += 1
                else:
                    self.assertEqual(len(snapshot.organisms), message.organism_count)
                    self.assertLessEqual(snapshot.organisms.x_px.nbytes, 1 << 20)
        self.assertGreater(refused, 100)
        self.assertTrue(base.base_sequence == 0)

    def test_wrong_header_fields_are_refused(self):
        keyframe, delta = self.deltas[0], self.deltas[1]
        self.assertNotEqual(delta.base_sequence, 0)
        wrong = {
            "position_bytes": (0, 1, 3, 8), "codec": (0, 1, 99),
                 "compression": (1 if keyframe.compression == 2 else 2, 3),
            "checksum": (0,), "organism_count": (0, 2**32 - 1), "obstacle_count": (1, 2**31), "body": (b"", b"\0" * 50),
        }
        for field, values in wrong.items():
            for value in values:
                message = copy.deepcopy(keyframe)
                setattr(message, field, value)
                with self.assertRaises(evod.DamagedData, msg=(field, value)):
                    snapshot_decoder.SnapshotDecoder().decode(message)
        with self.assertRaisesRegex(evod.DamagedData, "base_sequence"):
            snapshot_decoder.SnapshotDecoder().decode(delta)

    def test_false_counts_allocate_no_memory(self):
        keyframe = self.deltas[0]
        endless = struct.pack("<I", 2**32 - 1)
        for section in (b"\1" + endless + b"\0", b"\2" + endless + b"\0", b"\2" + endless + b"\x80" + endless):
            body = b"\1\0" + section
            with self.assertRaises(evod.DamagedData):
                snapshot_decoder.SnapshotDecoder().decode(self.resealed(keyframe, body))

    def test_a_decompression_bomb_is_refused(self):
        if snapshot_decoder.zstandard is None:
            self.skipTest("python3-zstandard is not there")
        message = copy.deepcopy(self.deltas[0])
        message.body = snapshot_decoder.zstandard.ZstdCompressor().compress(bytes(1 << 28))
        message.compression = stream_pb2.COMPRESSION_ZSTD
        with self.assertRaisesRegex(evod.DamagedData, "is 268435456 bytes long, allowed: at most"):
            snapshot_decoder.SnapshotDecoder().decode(message)
        for body in (b"", b"\x28\xb5\x2f\xfd", b"no zstd"):
            message.body = body
            with self.assertRaises(evod.DamagedData):
                snapshot_decoder.SnapshotDecoder().decode(message)

    def test_a_damaged_snapshot_requests_one_keyframe(self):
        core = self.core()
        subscription = core.subscribe(c.Request(subscribe_snapshots=c.SubscribeSnapshots(world="a", rate_hz=1)))
        self.answer(core, 1, subscription=c.Subscription(subscription_id=4, rate_hz=1))
        self.sent(core)
        keyframe, *deltas = (copy.deepcopy(message) for message in self.deltas[:4])
        for message in (keyframe, *deltas):
            message.subscription_id = 4

        def receive(message):
            body = message.SerializeToString()
            core.received(b"EV\1\2" + struct.pack("<I", len(body)) + body)
            replies = [message.request.WhichOneof("kind") or "acknowledged" for message in self.sent(core)]
            return len(subscription.arrived), replies

        self.assertEqual(receive(keyframe), (1, []))  # acknowledged once it is taken
        deltas[0].checksum ^= 1
        self.assertEqual(sorted(receive(deltas[0])[1]), ["acknowledged", "request_keyframe"])
        self.assertEqual(receive(deltas[1]), (1, ["acknowledged"]))
        self.assertEqual(receive(keyframe), (2, []))
        self.assertEqual(core.damaged_snapshot_count, 1)

    def test_wrong_tile_fields_are_refused(self):
        wrong = (("tile", 10_000), ("detail", 0), ("detail", 2), ("detail", 3), ("checksum", 1),
                 ("organism_count", 9999))
        for field, value in wrong:
            message = copy.deepcopy(self.full[0])
            setattr(message.tiles[0], field, value)
            with self.assertRaises(evod.DamagedData, msg=field):
                snapshot_decoder.SnapshotDecoder().decode(message)
        for length in (0, -1, float("nan"), float("inf"), 1e300):
            message = copy.deepcopy(self.full[0])
            message.width_px = length
            with self.assertRaisesRegex(evod.DamagedData, "px long"):
                snapshot_decoder.SnapshotDecoder().decode(message)
        message = copy.deepcopy(self.full[0])
        message.tiles.add().CopyFrom(message.tiles[0])
        with self.assertRaisesRegex(evod.DamagedData, "rising"):
            snapshot_decoder.SnapshotDecoder().decode(message)

    def test_threads_share_no_decompressor(self):
        unpackers = [snapshot_decoder._unpacker()]
        thread = threading.Thread(target=lambda: unpackers.append(snapshot_decoder._unpacker()))
        thread.start()
        thread.join()
        self.assertIsNot(*unpackers)
        self.assertIs(snapshot_decoder._unpacker(), unpackers[0])


if __name__ == "__main__":
    unittest.main()
