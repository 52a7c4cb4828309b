"""The test vectors of docs/PROTOCOL.md: every frame of proto/vectors decodes to exactly the values of its line, and
every mutation of mutations.txt is refused or decodes to the content with the listed checksum."""
import collections
import copy
import json
import pathlib
import struct
import unittest
import zlib

import delta_decoder  # the reference decoder, in tests/system
import numpy

import evod
from evod import framing, snapshot_decoder
from evod.v1 import stream_pb2

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "proto/vectors"
KINDS = ("organisms", "food", "poison", "crates", "obstacles")
ABOUT = ("world", "run_id", "island", "island_count", "tick", "generation", "generation_tick", "width_px", "height_px",
         "item_radius_px")
Vector = collections.namedtuple("Vector", "name head decoded body snapshot")


def vectors():
    """All vectors, in the order of the files."""
    reader = framing.FrameReader()
    reader.feed((FOLDER / "snapshots.frames").read_bytes())
    frames, found = list(reader.frames()), []
    lines = (FOLDER / "snapshots.jsonl").read_text().splitlines()
    assert len(frames) == len(lines)
    for number, (text, (channel, body)) in enumerate(zip(lines, frames), 1):
        line = json.loads(text)
        head = {field: line.pop(field) for field in ("case", "codec", "frame_bytes", "frame_crc32")}
        decoded = found[line["same_as_line"] - 1].decoded if "same_as_line" in line else line
        assert channel == framing.STREAM and ("same_as_line" not in line or len(line) == 1)
        snapshot = stream_pb2.SnapshotFrame.FromString(body)
        found.append(Vector(f"{head['case']}, line {number}", head, decoded, body, snapshot))
    return found


def columns_of(entities, with_ids):
    columns = dict(entities._columns)
    if with_ids:
        columns["id"] = entities.id
    return {name: column.tolist() for name, column in columns.items() if name not in ("dx", "dy")}


def entities_of(snapshot, with_ids):
    """The integer columns of each kind that has entities."""
    return {kind: columns_of(getattr(snapshot, kind), with_ids) for kind in KINDS if len(getattr(snapshot, kind))}


def tile_of(tile):
    """A tile at DETAIL_FULL without its entities: the decoder returns those of all tiles together."""
    content = {"tile": tile.index, "detail": stream_pb2.Detail.Name(tile.detail)}
    if tile.dots is not None:
        corner = numpy.array([[tile.left_px], [tile.top_px]])
        for kind, places in tile.dots.items():
            if places.size:
                content[kind] = dict(zip("xy", ((places - corner) * 256 / tile.side_px).tolist()))
    if tile.density is not None:
        content |= {kind: cells.tolist() for kind, cells in tile.density.items()}
        content["cells"] = len(tile.density["food"])
    return content


def together(tiles):
    """The tiles without their entities at DETAIL_FULL, and those entities of all tiles, in ascending order of ids."""
    rest, rows = [], collections.defaultdict(dict)
    for tile in tiles:
        if tile["detail"] == "DETAIL_FULL":
            for kind in set(tile) & set(KINDS):
                columns = tile[kind]
                for row in zip(*columns.values()):
                    entity = dict(zip(columns, row))
                    rows[kind][entity["id"]] = entity
            tile = {"tile": tile["tile"], "detail": tile["detail"]}
        rest.append(tile)
    return rest, {kind: {column: [of[id][column] for id in sorted(of)] for column in of[min(of)]}
                  for kind, of in rows.items()}


COUNTS = ("organism_count", "food_count", "poison_count", "crate_count", "obstacle_count")
COLUMNS = ("x", "y", "radius", "health", "half_width", "half_height", "heading", "species")


def mutated(snapshot, tile, change, where, value):
    """A frame with one change of its body or of that of a tile, and with the right checksum."""
    changed = stream_pb2.SnapshotFrame()
    changed.CopyFrom(snapshot)
    message, before = changed, b""
    if tile >= 0:
        message = changed.tiles[tile]
        before = struct.pack("<III", changed.tile_px, message.tile, message.detail)
    body = bytearray(message.body)
    if change == "byte":
        body[where] = value
    elif change == "word":
        body[where:where + 4] = struct.pack("<I", value)
    elif change == "cut":
        del body[where:]
    elif change == "add":
        body.append(value)
    else:
        assert change == "count"
        setattr(message, COUNTS[where], value)
    message.body = bytes(body)
    counts = [getattr(message, count) for count in COUNTS]
    fields = struct.pack("<QQ6I", message.sequence, message.base_sequence, *counts, changed.position_bytes)
    message.checksum = zlib.crc32(before + fields + message.body)
    return changed


def checksum_of_content(snapshot):
    """As checksum_of_content() in tests/unit/codec/vectors_test.cpp."""
    numbers = []
    for kind in KINDS:
        entities = getattr(snapshot, kind)
        numbers.append([len(entities)])
        if kind not in ("crates", "obstacles"):
            numbers.append(entities.id)
        numbers += [entities._columns[name] for name in COLUMNS if len(entities) and name in entities._columns]
    for tile in snapshot.tiles:
        if tile.density is not None:
            numbers += [tile.density[kind].ravel() for kind in KINDS[:3]]
    words = [(numpy.asarray(column).astype(numpy.int64) & 0xFFFFFFFF).astype("<u4") for column in numbers]
    return f"{zlib.crc32(numpy.concatenate(words).tobytes()):08x}"


def copy_of(decoder):
    """A decoder in the same state. Decoding replaces columns and does not change them, so that they can be shared."""
    twin = copy.copy(decoder)
    twin._whole = copy.copy(decoder._whole)
    twin._tiles = {tile: copy.copy(deltas) for tile, deltas in decoder._tiles.items()}
    return twin


class Vectors(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.vectors = vectors()

    def test_frames_have_the_listed_size_and_checksum(self):
        for vector in self.vectors:
            frame = b"EV\x01\x02" + len(vector.body).to_bytes(4, "little") + vector.body
            self.assertEqual({"frame_bytes": len(frame), "frame_crc32": zlib.crc32(frame)},
                             {field: vector.head[field] for field in ("frame_bytes", "frame_crc32")}, vector.name)
            self.assertEqual(stream_pb2.Codec.Name(vector.snapshot.codec), vector.head["codec"], vector.name)

    @unittest.skipUnless(snapshot_decoder.can_unpack, "the package zstandard is not installed")
    def test_frames_decode_to_the_listed_values(self):
        decoders = collections.defaultdict(snapshot_decoder.SnapshotDecoder)  # by case and island
        for vector in self.vectors:
            decoder = decoders[vector.head["case"], vector.snapshot.island]
            if "refused" in vector.decoded:
                self.assertEqual(vector.decoded, {"refused": True}, vector.name)
                with self.assertRaises(evod.DamagedData, msg=vector.name):
                    decoder.decode(vector.snapshot)
                continue
            snapshot, expected = decoder.decode(vector.snapshot), dict(vector.decoded)
            shown = {field: getattr(snapshot, field) for field in ABOUT} | entities_of(snapshot, "tiles" in expected)
            if "tiles" in expected:
                shown |= {"tile_px": vector.snapshot.tile_px, "tiles": [tile_of(tile) for tile in snapshot.tiles]}
                expected["tiles"], entities = together(expected["tiles"])
                expected |= entities
            self.assertEqual(shown, expected, vector.name)

    def test_mutations_have_the_listed_verdicts(self):
        mutations = collections.defaultdict(list)  # by line
        for text in (FOLDER / "mutations.txt").read_text().splitlines():
            line, tile, change, where, value, verdict = text.split()
            mutations[int(line)].append(((int(tile), change, int(where), int(value)), verdict))
        self.assertEqual(sum(map(len, mutations.values())), 1000)
        decoders = collections.defaultdict(snapshot_decoder.SnapshotDecoder)  # by case and island
        for line, vector in enumerate(self.vectors, 1):
            if vector.head["case"].endswith("_zstd"):
                continue
            decoder = decoders[vector.head["case"], vector.snapshot.island]
            for mutation, verdict in mutations.pop(line, ()):
                try:
                    got = checksum_of_content(copy_of(decoder).decode(mutated(vector.snapshot, *mutation)))
                except evod.DamagedData:
                    got = "damaged"
                self.assertEqual(got, verdict, (vector.name, mutation))
            if "refused" in vector.decoded:
                with self.assertRaises(evod.DamagedData):
                    decoder.decode(vector.snapshot)
            else:
                decoder.decode(vector.snapshot)
        self.assertEqual(dict(mutations), {})

    @unittest.skipUnless(snapshot_decoder.can_unpack, "the package zstandard is not installed")
    def test_vectors_cover_every_form_of_a_delta(self):
        seen = set()

        class Body(delta_decoder.Body):
            def column(self, count):
                width = self.body[self.offset]
                seen.add(("column", width & 127, "with exceptions" if width & 128 else "plain"))
                return super().column(count)

        class Decoder(delta_decoder.Decoder):
            def section(self, body, name, sizes, base, ticks, position_bytes):
                scope = "tile" if "crates" in self.have_ids else "island"
                form = "keyframe" if base is None else "delta"
                seen.add((scope, form, name, "parts", body.body[body.offset]))
                seen.add((scope, form, "ticks", min(ticks, 2)))
                seen.add((scope, "position_bytes", position_bytes))
                return super().section(body, name, sizes, base, ticks, position_bytes)

        decoders, refused = {}, 0
        originals = delta_decoder.Body, delta_decoder.Decoder
        delta_decoder.Body, delta_decoder.Decoder = Body, Decoder
        try:
            for vector in self.vectors:
                snapshot = vector.snapshot
                for part in [snapshot, *snapshot.tiles]:
                    detail = getattr(part, "detail", "island")
                    form = "delta" if part.base_sequence else "keyframe"
                    seen.add((detail, form, "compression", part.compression))
                if snapshot.codec == stream_pb2.CODEC_DELTA:
                    of = delta_decoder.TilesDecoder if snapshot.tile_px else Decoder
                    name = vector.head["case"], snapshot.island
                    decoder = decoders.setdefault(name, of(lambda data: snapshot_decoder._unpack(data, 1 << 28)))
                    try:
                        decoder.decode(snapshot)
                    except ValueError:
                        refused += 1
        finally:
            delta_decoder.Body, delta_decoder.Decoder = originals
        columns = {("column", width, form) for width in (0, 1, 2) for form in ("plain", "with exceptions")}
        columns.add(("column", 4, "plain"))  # columns with exceptions are narrower
        sections = {(scope, "delta", "food", "parts", parts) for scope in ("island", "tile") for parts in range(4)}
        sections |= {("tile", "delta", "organisms", "parts", parts) for parts in (*range(4), 4, 5)}
        sections |= {("tile", "delta", "crates", "parts", parts) for parts in range(3)}
        # no organism is born within a generation
        sections |= {("island", "delta", "organisms", "parts", parts) for parts in range(2)}
        ticks = {(scope, "delta", "ticks", ticks) for scope in ("island", "tile") for ticks in range(3)}
        ticks |= {("island", "keyframe", "ticks", ticks) for ticks in range(3)}
        positions = {(scope, "position_bytes", count) for scope in ("island", "tile") for count in (2, 4)}
        packed = {(detail, form, "compression", 2) for detail in ("island", stream_pb2.DETAIL_FULL)
                  for form in ("keyframe", "delta")}
        packed.add((stream_pb2.DETAIL_DENSITY, "keyframe", "compression", 2))
        self.assertEqual((columns | sections | ticks | positions | packed) - seen, set())
        self.assertEqual(refused, sum("refused" in vector.decoded and vector.snapshot.codec == stream_pb2.CODEC_DELTA
                                      for vector in self.vectors))


if __name__ == "__main__":
    unittest.main()
