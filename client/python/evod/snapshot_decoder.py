"""Decodes snapshots with numpy, without a loop over the entities (docs/PROTOCOL.md, Snapshots)."""
from __future__ import annotations

import struct
import threading
import zlib
from typing import Any, Mapping, Sequence

import numpy

from evod.conversion import result
from evod.errors import DamagedData
from evod.results import Detail, RunState
from evod.snapshots import HEADING_STEPS, STEPS_PER_PX, Array, Boxes, Columns, Items, Organisms, Snapshot, Tile
from evod.v1 import stream_pb2

try:
    import zstandard
except ImportError:  # without zstandard, the client requests uncompressed snapshots
    zstandard = None  # type: ignore[assignment]

Content = Mapping[str, Columns]  # the columns for each kind of entity

_SIZES: dict[str, tuple[str, ...]] = {
    "organisms": ("radius", "health"),
    "food": (),
    "poison": (),
    "crates": ("half_width", "half_height"),
    "obstacles": ("half_width", "half_height"),
}
_HAVE_IDS = frozenset(("organisms", "food", "poison"))
_MOVE = frozenset(("organisms", "crates"))
_COUNTS = ("organism_count", "food_count", "poison_count", "crate_count", "obstacle_count")
_LENGTH_PX_MAX = 1e7  # largest accepted width or height of an island; the limits of evod's parameters are lower
_DENSITY_CELLS = (1, 2, 4, 8, 16)
_SPECIES_MAX = 255  # a byte in CODEC_DELTA
#: Columns that organisms may have: what they contain, and the bit in the parts of a section.
_OPTIONAL = {"heading": ("headings", 4), "species": ("species", 8)}
can_unpack = zstandard is not None  #: whether this client can decode compressed snapshots


class SnapshotDecoder:
    """Decodes the snapshots for one subscription and one island, in the order in which they arrive."""

    def __init__(self) -> None:
        self._whole = _Deltas(_HAVE_IDS)
        self._tiles: dict[int, _Deltas] = {}
        self._same: dict[str, Any] = {}  # values of the fields that deltas omit
        self._moment: tuple[int, int, float] | None = None  # generation, tick and simulated time of the last snapshot
        self._tick_s = 0.0  # simulated time of a tick

    def decode(self, message: stream_pb2.SnapshotFrame) -> Snapshot:
        """Decodes a snapshot. Raises DamagedData; with CODEC_DELTA, only a keyframe can be decoded after this error."""
        tiles: tuple[Tile, ...] = ()
        if message.codec != stream_pb2.CODEC_DELTA:
            content = _plain(message)
        elif message.tile_px:
            content, tiles = self._decode_tiles(message)
        else:
            content = self._whole.decode(message, message.position_bytes)
        if message.codec != stream_pb2.CODEC_DELTA or message.tile_px or not message.base_sequence:
            self._same = {
                field: getattr(message, field)
                for field in ("world", "run_id", "island_count", "width_px", "height_px", "item_radius_px")
            }
        return Snapshot(
            **{**self._same, "run_id": self._same["run_id"].hex()},
            island=message.island,
            tick=message.tick,
            generation=message.generation,
            generation_tick=message.generation_tick,
            simulated_s=message.simulated_s,
            state=RunState(message.state),
            state_hash=message.state_hash.hex(),
            live=result(message.live),
            ticks_per_s=message.ticks_per_s,
            slowed=message.slowed,
            sequence=message.sequence,
            dropped_count=message.dropped_count,
            organisms=Organisms(content["organisms"], interval_s=self._interval_s(message)),
            food=Items(content["food"]),
            poison=Items(content["poison"]),
            crates=Boxes(content["crates"]),
            obstacles=Boxes(content["obstacles"]),
            tiles=tiles,
        )

    def _interval_s(self, message: stream_pb2.SnapshotFrame) -> float:
        """Returns the simulated time of the displacements in this snapshot; 0 if it is not known."""
        before, self._moment = self._moment, (message.generation, message.tick, message.simulated_s)
        if before is not None and before[0] == message.generation and before[1] < message.tick:
            self._tick_s = (message.simulated_s - before[2]) / (message.tick - before[1])
        elif before is None or before[0] != message.generation:
            # The parameter tick_s can change between generations. Without another snapshot of this generation, its
            # value is estimated by its mean over the run.
            self._tick_s = message.simulated_s / message.tick if message.tick else 0.0
        is_delta = message.codec == stream_pb2.CODEC_DELTA and not message.tile_px
        return self._whole.ticks * self._tick_s if is_delta else 0.0

    def _decode_tiles(self, message: stream_pb2.SnapshotFrame) -> tuple[Content, tuple[Tile, ...]]:
        before, self._tiles = self._tiles, {}
        side = message.tile_px
        for length in (message.width_px, message.height_px):
            if not 0 < length <= _LENGTH_PX_MAX:
                raise DamagedData(f"an island is {length} px long, allowed: above 0, at most {_LENGTH_PX_MAX:g}")
        in_row, in_column = (max(1, -int(-length // side)) for length in (message.width_px, message.height_px))
        full: dict[int, _Deltas] = {}
        contents: list[Content] = []
        tiles: list[Tile] = []
        for tile in message.tiles:
            if tile.sequence != message.sequence:
                raise DamagedData(f"a tile's sequence is {tile.sequence}, not that of its snapshot, {message.sequence}")
            if tile.tile >= in_row * in_column or tiles and tile.tile <= tiles[-1].index:
                raise DamagedData(f"a tile's index is {tile.tile}, allowed: rising, below {in_row * in_column}")
            left, top = tile.tile % in_row * side, tile.tile // in_row * side
            checked_before = struct.pack("<III", side, tile.tile, tile.detail)
            counts = dict(zip(_SIZES, _counts_of(tile)))
            dots = density = None
            if tile.detail == stream_pb2.DETAIL_FULL:
                decoder = full[tile.tile] = before.get(tile.tile) or _Deltas(frozenset(_SIZES))
                contents.append(decoder.decode(tile, message.position_bytes, checked_before))
            elif tile.detail == stream_pb2.DETAIL_DOTS:
                body = _body_of(tile, message.position_bytes, checked_before, 2 * sum(counts.values()))
                dots = _dots(body, counts, side / 256, left, top)
            elif tile.detail == stream_pb2.DETAIL_DENSITY:
                density = _density(_body_of(tile, message.position_bytes, checked_before, 1 << 16), counts)
            else:
                raise DamagedData(f"a tile's detail is {tile.detail}, allowed: 1 to 3")
            tiles.append(Tile(tile.tile, Detail(tile.detail), left, top, side, counts, dots, density))
        self._tiles = full
        return _merged_tiles(contents), tuple(tiles)


# ---- bodies
# -----------------------------------------------------------------------------------------------------------


class _Body:
    """Reads the fields of a body in order."""

    def __init__(self, data: bytes) -> None:
        self.data, self.offset = data, 0

    def take(self, kind: str, count: int) -> Array:
        itemsize = numpy.dtype(kind).itemsize
        if count > (len(self.data) - self.offset) // itemsize:
            raise DamagedData("a snapshot's body ends too early")
        numbers = numpy.frombuffer(self.data, kind, count, self.offset)
        self.offset += count * itemsize
        return numbers

    def number(self, kind: str) -> int:
        return int(self.take(kind, 1)[0])

    def end(self) -> None:
        if self.offset != len(self.data):
            raise DamagedData("a snapshot's body has surplus bytes at its end")

    def count(self, bytes_each: int) -> int:
        """Reads a number of entities. Each takes at least `bytes_each` bytes.

        Raises DamagedData if the rest of the body is too short for them, before memory is allocated for them.
        """
        count = self.number("<u4")
        if count * bytes_each > len(self.data) - self.offset:
            raise DamagedData("a snapshot's body ends too early")
        return count

    def planes(self, count: int, size: int) -> Array:
        planes = self.take("<u1", count * size).reshape(size, count)
        numbers = numpy.zeros((count, 4), numpy.uint8)
        numbers[:, :size] = planes.T
        whole: Array = numbers.view("<u4").reshape(count)
        return whole

    def column(self, count: int) -> Array:
        width = self.number("<u1")
        indices: Array | None = None
        if width & 128:
            exceptions = self.number("<u4")
            indices, values = self.take("<u4", exceptions), self.take("<i4", exceptions)
            width &= 127
        if width not in (0, 1, 2, 4):
            raise DamagedData(f"a snapshot's body has a column of {width} bytes per value, allowed 0, 1, 2, 4")
        column = self.take(f"<i{width}", count).astype(numpy.int32) if width else numpy.zeros(count, numpy.int32)
        if indices is not None:
            if len(indices) and int(indices.max()) >= count:
                raise DamagedData("a column has an exception after its end")
            column[indices] = values
        return column

    def rising_column(self, count: int) -> Array:
        numbers = numpy.cumsum(self.column(count).view(numpy.uint32).astype(numpy.int64) + 1) - 1
        if count and int(numbers[-1]) > 0xFFFFFFFF:
            raise DamagedData("an id does not fit into 32 bits")
        ids: Array = numbers.astype(numpy.uint32)
        return ids


def _counts_of(message: Any) -> list[int]:
    return [getattr(message, field) for field in _COUNTS]


def _body_of(message: Any, position_bytes: int, checked_before: bytes, bytes_max: int) -> _Body:
    """Verifies the checksum of a SnapshotFrame or a SnapshotTile and returns its uncompressed body.

    checked_before  bytes that the checksum covers in addition to the body, before it.
    bytes_max       the largest allowed size of the uncompressed body; a larger one raises DamagedData.
    """
    data = message.body
    if message.compression == stream_pb2.COMPRESSION_ZSTD:
        data = _unpack(data, bytes_max)
    elif message.compression > stream_pb2.COMPRESSION_NONE:
        raise DamagedData(f"a snapshot's compression is {message.compression}, allowed: 0 to 2")
    head = struct.pack("<QQ6I", message.sequence, message.base_sequence, *_counts_of(message), position_bytes)
    if zlib.crc32(data, zlib.crc32(checked_before + head)) != message.checksum:
        raise DamagedData("a snapshot's checksum does not match its body")
    return _Body(data)


_of_thread = threading.local()


def _unpacker() -> Any:
    """Returns this thread's decompressor. Threads cannot share one, because decompression releases the interpreter
    lock."""
    if zstandard is None:
        raise DamagedData("a snapshot is compressed, but the package zstandard is not installed")
    if not hasattr(_of_thread, "unpacker"):
        _of_thread.unpacker = zstandard.ZstdDecompressor()
    return _of_thread.unpacker


def _unpack(data: bytes, bytes_max: int) -> bytes:
    unpacker = _unpacker()
    try:
        content_bytes = zstandard.frame_content_size(data)
        if not 0 <= content_bytes <= bytes_max:
            raise DamagedData(f"a snapshot's content is {content_bytes} bytes long, allowed: at most {bytes_max}")
        return bytes(unpacker.decompress(data)) if content_bytes else b""
    except zstandard.ZstdError as error:
        raise DamagedData(f"a snapshot cannot be decompressed: {error}") from None


def _plain(message: stream_pb2.SnapshotFrame) -> Content:
    """Returns the entities in a snapshot with CODEC_PLAIN. Converts lengths to 1/16 px, the unit of the other
    codecs."""
    if message.codec != stream_pb2.CODEC_PLAIN:
        raise DamagedData(f"a snapshot's codec is {message.codec}, allowed: 2 and 3")
    content = {}
    for (name, sizes), count in zip(_SIZES.items(), _counts_of(message)):
        columns = getattr(message.plain, name)
        fields = {"x": "x_px", "y": "y_px"} | {size: size if size == "health" else size + "_px" for size in sizes}
        kind: dict[str, Any] = {field: numpy.array(getattr(columns, column), numpy.float64) for field,
                                column in fields.items()}
        if name in _HAVE_IDS:
            kind = {"id": numpy.array(columns.id, numpy.uint32)} | kind
            if numpy.any(kind["id"][1:] <= kind["id"][:-1]):
                raise DamagedData(f"a snapshot's plain.{name}.id does not rise")
        for field, column in kind.items():
            if len(column) != count:
                raise DamagedData(f"a snapshot's plain.{name} has {len(column)} of {field}, not {count} as its count "
                                  "says")
            if not numpy.all(numpy.isfinite(column)):
                raise DamagedData(f"a snapshot's plain.{name} has a number in {field} that is not finite")
            if field != "id":
                kind[field] = numpy.rint(column * STEPS_PER_PX).astype(_kind_of(field))
        if name == "organisms" and len(columns.heading):
            kind["heading"] = _plain_headings(columns.heading, count)
        if name == "organisms" and len(columns.species):
            kind["species"] = _plain_species(columns.species, count)
        content[name] = kind
    return content


def _plain_headings(radians: Sequence[float], count: int) -> Array:
    headings = numpy.array(radians, numpy.float64)
    if len(headings) != count:
        raise DamagedData(f"a snapshot's plain.organisms has {len(headings)} of heading, not {count} as its count says")
    if not numpy.all(numpy.abs(headings) < 3.1416):
        raise DamagedData("a snapshot's plain.organisms has a heading that is not -pi to pi")
    steps: Array = numpy.rint(headings * (HEADING_STEPS / (2 * numpy.pi))).astype(numpy.int32) % HEADING_STEPS
    return steps


def _plain_species(numbers: Sequence[int], count: int) -> Array:
    species = numpy.array(numbers, numpy.uint32)
    if len(species) != count:
        raise DamagedData(f"a snapshot's plain.organisms has {len(species)} of species, not {count} as its count says")
    if numpy.any(species > _SPECIES_MAX):
        raise DamagedData(f"a snapshot's plain.organisms has a species that is not 0 to {_SPECIES_MAX}")
    return species.astype(numpy.int32)


def _position_kind(position_bytes: int) -> str:
    if position_bytes not in (2, 4):
        raise DamagedData(f"position_bytes is {position_bytes}, allowed: 2 and 4")
    return f"<u{position_bytes}"


# ---- deltas
# -------------------------------------------------------------------------------------------------------------


class _Deltas:
    """Decodes bodies of CODEC_DELTA for one island, or for one tile of it, in one subscription."""

    def __init__(self, have_ids: frozenset[str]) -> None:
        self._have_ids = have_ids
        self._sequence = 0  # sequence number of the baseline for the next delta; 0: there is no baseline
        self.ticks = 0  # number of ticks over which the displacements in the baseline were measured
        self._content: Content = {}
        self._position_bytes = 0  # of the baseline

    def decode(self, message: Any, position_bytes: int, checked_before: bytes = b"") -> Content:
        """Decodes a SnapshotFrame or a SnapshotTile and returns its entities."""
        base, self._sequence = self._sequence, 0
        keyframe = message.base_sequence == 0
        if not keyframe and message.base_sequence != base:
            raise DamagedData(f"a snapshot's base_sequence is {message.base_sequence}, not the last one, {base}")
        _position_kind(position_bytes)
        if not keyframe and position_bytes != self._position_bytes:
            raise DamagedData("a snapshot's position_bytes differ from those of its base")
        counts = _counts_of(message)
        content_before = {} if keyframe else self._content
        entities_max = sum(counts) + sum(len(columns["x"]) for columns in content_before.values())
        body = _body_of(message, position_bytes, checked_before, 1024 + 64 * entities_max)
        ticks = body.number("<u2")
        content = {}
        for (name, sizes), count in zip(_SIZES.items(), counts):
            content[name] = self._section(body, name, sizes, content_before.get(name, {}), count, ticks, position_bytes)
        body.end()
        self.ticks = ticks if ticks or keyframe else self.ticks
        self._content, self._sequence, self._position_bytes = content, message.sequence, position_bytes
        return content

    def _section(
        self, body: _Body, name: str, sizes: Sequence[str], base: Columns, count: int, ticks: int, position_bytes: int
    ) -> Columns:
        """Decodes the section of one kind of entity.

        base   the entities of this kind in the base; empty for a keyframe.
        count  the number of entities of this kind in the snapshot, as its message states it.
        """
        parts, parts_max = body.number("<u1"), 15 if name == "organisms" else 3  # only organisms have optional columns
        if parts > parts_max:
            raise DamagedData(f"a snapshot's parts of {name} are {parts}, allowed: 0 to {parts_max}")
        has_ids, moves = name in self._have_ids, name in _MOVE
        base_count = len(base.get("x", ()))
        optional = tuple(field for field, (_, bit) in _OPTIONAL.items() if parts & bit and count > 0)
        for field, (content, _) in _OPTIONAL.items():
            if base_count and count and (field in optional) != (field in base):
                raise DamagedData(f"only one of a snapshot and its base has {content}")
        fields = ("id",) * has_ids + ("x", "y", *sizes, *optional) + ("dx", "dy") * moves
        stayed = {field: base[field] if base_count else numpy.zeros(0, _kind_of(field)) for field in fields}
        if parts & 1:
            gone_count = body.number("<u4")
            if gone_count > base_count:
                raise DamagedData(f"a snapshot removes {gone_count} {name}, but its base has {base_count}")
            gone = body.rising_column(gone_count)
            if len(gone) and int(gone[-1]) >= base_count:
                raise DamagedData("a snapshot removes an entity that is not in its base")
            stays = numpy.ones(base_count, bool)
            stays[gone] = False
            stayed = {field: column[stays] for field, column in stayed.items()}
        come: dict[str, Array] = {}
        if parts & 2:
            come_count = body.count(2 * position_bytes + 2 * len(sizes))
            if has_ids:
                come["id"] = body.rising_column(come_count)
            come |= {field: body.planes(come_count, position_bytes) for field in ("x", "y")}
            come |= {field: body.planes(come_count, 2).astype(numpy.int32) for field in sizes}
            come |= {field: body.planes(come_count, 1).astype(numpy.int32) for field in optional}
            if moves:
                come |= {field: body.column(come_count) for field in ("dx", "dy")}
        stayed_count = len(stayed["x"])
        whole_count = stayed_count + (len(come["x"]) if come else 0)
        if whole_count != count:
            raise DamagedData(f"a snapshot has {whole_count} {name}, not {count} as its count says")
        if stayed_count and moves:
            for field in ("x", "y"):
                before = stayed["d" + field]
                if ticks != max(self.ticks, 1):
                    before = (before.astype(numpy.int64) * ticks // max(self.ticks, 1)).astype(numpy.int32)
                way = body.column(stayed_count) + before  # all these numbers are modulo 2^32
                stayed[field] = stayed[field] + way.view(numpy.uint32)
                if ticks:
                    stayed["d" + field] = way
                if position_bytes == 2 and int(stayed[field].max()) > 0xFFFF:
                    raise DamagedData(f"a snapshot moves {name} out of the range of {field}")
        if stayed_count and name == "organisms":
            stayed["health"] = stayed["health"] + body.column(stayed_count)
            if int(stayed["health"].view(numpy.uint32).max()) > 0xFFFF:
                raise DamagedData("a snapshot has a health outside its range")
        if stayed_count and "heading" in optional:
            stayed["heading"] = (stayed["heading"] + body.column(stayed_count)) % HEADING_STEPS
        columns = _merged(stayed, come, has_ids) if come else stayed
        if has_ids and columns["id"].flags.writeable:
            columns["id"].flags.writeable = False
        return columns


def _kind_of(field: str) -> type[numpy.generic]:
    return numpy.uint32 if field in ("id", "x", "y") else numpy.int32


def _merged(stayed: Mapping[str, Array], come: Mapping[str, Array], by_id: bool) -> Columns:
    """Merges remaining and new entities. Sorts them by id, or appends the new ones if they have no ids, as boxes."""
    if not by_id or not len(stayed["x"]):
        return {field: numpy.concatenate((stayed[field], come[field])) for field in come}
    places = numpy.searchsorted(stayed["id"], come["id"])
    at_old = numpy.minimum(places, len(stayed["id"]) - 1)
    if numpy.any(stayed["id"][at_old] == come["id"]):
        raise DamagedData("a snapshot adds an entity that is in its base")
    new = numpy.zeros(len(stayed["id"]) + len(come["id"]), bool)
    new[places + numpy.arange(len(places))] = True
    old = ~new
    columns = {}
    for field, column in stayed.items():
        merged = numpy.empty(len(new), column.dtype)
        merged[old], merged[new] = column, come[field]
        columns[field] = merged
    return columns


# ---- tiles
# ----------------------------------------------------------------------------------------------------------------


def _dots(body: _Body, counts: Mapping[str, int], cell_px: float, left: float, top: float) -> Mapping[str, Array]:
    count = sum(counts.values())
    x, y = (body.take("<u1", count) * cell_px for _ in range(2))
    body.end()
    places = numpy.stack((x + left, y + top))
    ends = numpy.cumsum(list(counts.values()))
    return dict(zip(counts, numpy.split(places, ends[:-1], axis=1)))


def _density(body: _Body, counts: Mapping[str, int]) -> Mapping[str, Array]:
    cells = body.number("<u1")
    if cells not in _DENSITY_CELLS:
        raise DamagedData(f"a density has {cells} cells per row, allowed: 1, 2, 4, 8 and 16")
    density = {name: body.column(cells * cells).reshape(cells, cells) for name in ("organisms", "food", "poison")}
    body.end()
    for name, numbers in density.items():
        if int(numbers.view(numpy.uint32).sum(dtype=numpy.int64)) != counts[name]:
            raise DamagedData(f"the cells of a density do not add up to the count of {name}")
    return density


def _merged_tiles(contents: Sequence[Content]) -> Content:
    """Returns the entities of several tiles, in ascending order of ids."""
    together: dict[str, Columns] = {}
    for name, sizes in _SIZES.items():
        # Tiles without organisms have no headings and no species.
        parts = [content for content in contents if len(content[name]["x"])]
        optional = [field for field in _OPTIONAL if any(field in content[name] for content in parts)]
        for field in optional:
            if not all(field in content[name] for content in parts):
                raise DamagedData(f"only some tiles of a snapshot have {_OPTIONAL[field][0]}")
        fields = ("id", "x", "y", *sizes, *optional)
        columns = {
            field: numpy.concatenate([content[name][field] for content in parts])
            if parts
            else numpy.zeros(0, _kind_of(field))
            for field in fields
        }
        order = numpy.argsort(columns["id"], kind="stable")
        ids = columns["id"][order]
        if numpy.any(ids[1:] == ids[:-1]):
            raise DamagedData(f"a snapshot has {name} with the same id in two tiles")
        together[name] = {field: column[order] for field, column in columns.items()}
    return together
