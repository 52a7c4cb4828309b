"""Decodes snapshots of CODEC_DELTA with numpy, whole or in tiles, without a loop over the entities."""
import struct
import zlib

import numpy

KINDS = (("organisms", ("radius", "health")), ("food", ()), ("poison", ()),
         ("crates", ("half_width", "half_height")), ("obstacles", ("half_width", "half_height")))
HAVE_IDS, MOVE = {"organisms", "food", "poison"}, {"organisms", "crates"}


class Body:
    """Reads a body from its beginning to its end."""

    def __init__(self, body):
        self.body, self.offset = body, 0

    def number(self, kind):
        return int(self.plain(kind, 1)[0])

    def plain(self, kind, count):
        if self.offset + count * numpy.dtype(kind).itemsize > len(self.body):
            raise ValueError("the body ends too early")
        numbers = numpy.frombuffer(self.body, kind, count, self.offset)
        self.offset += numbers.nbytes
        return numbers.astype(numpy.int64)

    def planes(self, count, size):
        planes = self.plain("<u1", count * size).reshape(size, count)
        return sum(planes[i] << 8 * i for i in range(size))

    def column(self, count):
        width = self.number("<u1")
        indices = values = ()
        if width & 128:
            exceptions = self.number("<u4")
            indices, values = self.plain("<u4", exceptions), self.plain("<i4", exceptions)
        width &= 127
        column = self.plain(f"<i{width}", count) if width else numpy.zeros(count, numpy.int64)
        column[indices if len(indices) else slice(0)] = values
        return column

    def rising_column(self, count):
        return numpy.cumsum((self.column(count) & 0xffffffff) + 1) - 1


def content(message, position_bytes, before, decompress):
    """The uncompressed body of a SnapshotFrame or SnapshotTile after its checksum was verified, and its counts."""
    data = decompress(message.body) if message.compression == 2 else message.body
    counts = [getattr(message, field) for field in
              ("organism_count", "food_count", "poison_count", "crate_count", "obstacle_count")]
    checked = before + struct.pack("<QQ6I", message.sequence, message.base_sequence, *counts, position_bytes) + data
    if zlib.crc32(checked) != message.checksum:
        raise ValueError("damaged")
    return data, counts


class Decoder:
    """Decodes the snapshots of one island of one subscription, or of one of its tiles, in order."""

    def __init__(self, decompress, have_ids=HAVE_IDS):
        """decompress: returns the content of a zstd frame."""
        self.decompress, self.have_ids = decompress, have_ids
        self.sequence = 0  # of the base of the next delta; 0: there is none
        self.ticks, self.entities = 0, {}

    def decode(self, message, position_bytes=None, checked_before=b""):
        """{"organisms": {"id": …, "x": …, …, "dx": …}, "food": …, …} in 1/16 px. ValueError: request a keyframe."""
        position_bytes = position_bytes or message.position_bytes
        base, self.sequence = self.sequence, 0
        if message.base_sequence not in (0, base):
            raise ValueError("the base is not the last snapshot")
        data, counts = content(message, position_bytes, checked_before, self.decompress)
        body = Body(data)
        ticks = body.number("<u2")
        entities = {}
        for (name, sizes), count in zip(KINDS, counts):
            of_base = self.entities[name] if message.base_sequence else None
            entities[name] = self.section(body, name, sizes, of_base, ticks, position_bytes)
            if len(entities[name]["x"]) != count:
                raise ValueError("the number of entities does not match the count")
        self.entities = entities
        self.ticks = ticks if ticks or not message.base_sequence else self.ticks
        self.sequence = message.sequence
        return entities

    def section(self, body, name, sizes, base, ticks, position_bytes):
        parts, come = body.number("<u1"), {}
        fields = [*(["id"] if name in self.have_ids else []), "x", "y", *sizes, *(["heading"] if parts & 4 else []),
                  *(["species"] if parts & 8 else []), *(["dx", "dy"] if name in MOVE else [])]
        stayed = {field: base[field] if base and len(base["x"]) else numpy.zeros(0, numpy.int64) for field in fields}
        if parts & 1:
            gone = body.rising_column(body.number("<u4"))
            stayed = {field: numpy.delete(column, gone) for field, column in stayed.items()}
        if parts & 2:
            count = body.number("<u4")
            if name in self.have_ids:
                come["id"] = body.rising_column(count)
            for field in ("x", "y"):
                come[field] = body.planes(count, position_bytes)
            for field in sizes:
                come[field] = body.planes(count, 2)
            if parts & 4:
                come["heading"] = body.planes(count, 1)
            if parts & 8:
                come["species"] = body.planes(count, 1)
            for field in ("dx", "dy") if name in MOVE else ():
                come[field] = body.column(count)
        count = len(stayed["x"])
        if count and name in MOVE:
            for field in ("x", "y"):
                way = body.column(count) + stayed["d" + field] * ticks // max(self.ticks, 1)
                stayed[field] = (stayed[field] + way) & 0xffffffff
                if ticks:
                    stayed["d" + field] = way.astype(numpy.int32).astype(numpy.int64)
        if count and name == "organisms":
            stayed["health"] = stayed["health"] + body.column(count)
        if count and parts & 4:
            stayed["heading"] = (stayed["heading"] + body.column(count)) % 256
        if come:
            stayed = {field: numpy.concatenate((stayed[field], come[field])) for field in fields}
            if name in self.have_ids:
                order = numpy.argsort(stayed["id"], kind="stable")
                stayed = {field: column[order] for field, column in stayed.items()}
        return stayed


class TilesDecoder:
    """Decodes the snapshots of one island of one subscription with a view."""

    def __init__(self, decompress):
        self.decompress = decompress
        self.full = {}  # a Decoder for each tile of DETAIL_FULL in the last snapshot

    def decode(self, frame):
        """{tile: content}. The content of a tile is its entities; or {"organisms": {"x": …, "y": …}, …} in 1/256 of its
        side; or {"organisms": a square array of counts, …}. ValueError: request a keyframe."""
        before, self.full = self.full, {}
        full, seen = {}, {}
        for tile in frame.tiles:
            checked_before = struct.pack("<III", frame.tile_px, tile.tile, tile.detail)
            if tile.detail == 1:
                full[tile.tile] = before.get(tile.tile) or Decoder(self.decompress, [name for name, _ in KINDS])
                seen[tile.tile] = full[tile.tile].decode(tile, frame.position_bytes, checked_before)
                continue
            data, counts = content(tile, frame.position_bytes, checked_before, self.decompress)
            body, names = Body(data), [name for name, _ in KINDS]
            if tile.detail == 2:
                x, y = (numpy.split(body.plain("<u1", sum(counts)), numpy.cumsum(counts)[:-1]) for _ in "xy")
                seen[tile.tile] = {name: {"x": x[i], "y": y[i]} for i, name in enumerate(names)}
            else:
                cells = body.number("<u1")
                seen[tile.tile] = {name: body.column(cells * cells).reshape(cells, cells) for name in names[:3]}
        self.full = full
        return seen
