"""The test vectors of docs/PROTOCOL.md: every frame of proto/vectors decodes to exactly the values of its line."""
import collections
import json
import pathlib
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
        sections |= {("tile", "delta", "organisms", "parts", parts) for parts in range(4)}
        sections |= {("tile", "delta", "crates", "parts", parts) for parts in range(3)}
        sections |= {("island", "delta", "organisms", "parts", parts) for parts in range(2)}  # no organism is born within a generation
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
