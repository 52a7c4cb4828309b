"""From what is sent of pictures to their numbers, without a loop over the entities (docs/PROTOCOL.md, Pictures)."""
from __future__ import annotations

import struct
import threading
import zlib
from typing import Any, Mapping, Sequence

import numpy

from evod.errors import DamagedData
from evod.snapshots import Array, Boxes, Columns, Snapshot, Items, Organisms, Tile
from evod.v1 import stream_pb2, world_pb2

try:
    import zstandard
except ImportError:  # pictures are sent as they are, then
    zstandard = None  # type: ignore[assignment]

Content = Mapping[str, Columns]  # by kind

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
_LENGTH_PX_MAX = 1e7  # of an island; evod's parameters allow less
_DENSITY_CELLS = (1, 2, 4, 8, 16)
can_unpack = zstandard is not None  #: whether compressed pictures can be read


class FrameDecoder:
    """The pictures of one island of one subscription, one after another."""

    def __init__(self) -> None:
        self._whole = _Deltas(_HAVE_IDS)
        self._tiles: dict[int, _Deltas] = {}
        self._same: dict[str, Any] = {}  # what deltas leave out

    def decode(self, message: stream_pb2.SnapshotFrame) -> Snapshot:
        """DamagedData: ask for a keyframe, if it is of CODEC_DELTA."""
        tiles: tuple[Tile, ...] = ()
        if message.codec != stream_pb2.CODEC_DELTA:
            content = _columns(message)
        elif message.tile_px:
            content, tiles = self._decode_tiles(message)
        else:
            content = self._whole.decode(message, message.position_bytes)
        if message.codec != stream_pb2.CODEC_DELTA or message.tile_px or not message.base_sequence:
            self._same = {
                field: getattr(message, field)
                for field in ("world", "run_id", "island_count", "width_px", "height_px", "item_radius_px")
            }
        live = world_pb2.LiveStatistics()  # of its own, so that the picture does not hold the whole message
        live.CopyFrom(message.live)
        return Snapshot(
            **{**self._same, "run_id": self._same["run_id"].hex()},
            island=message.island,
            tick=message.tick,
            generation=message.generation,
            generation_tick=message.generation_tick,
            simulated_s=message.simulated_s,
            state=message.state,
            state_hash=message.state_hash.hex(),
            live=live,
            ticks_per_s=message.ticks_per_s,
            slowed=message.slowed,
            sequence=message.sequence,
            dropped_count=message.dropped_count,
            organisms=Organisms(content["organisms"]),
            food=Items(content["food"]),
            poison=Items(content["poison"]),
            crates=Boxes(content["crates"]),
            obstacles=Boxes(content["obstacles"]),
            tiles=tiles,
        )

    def _decode_tiles(self, message: stream_pb2.SnapshotFrame) -> tuple[Content, tuple[Tile, ...]]:
        before, self._tiles = self._tiles, {}
        side = message.tile_px
        for length in (message.width_px, message.height_px):
            if not 0 < length <= _LENGTH_PX_MAX:
                raise DamagedData(f"an island is {length} px long")
        in_row, in_column = (max(1, -int(-length // side)) for length in (message.width_px, message.height_px))
        full: dict[int, _Deltas] = {}
        contents: list[Content] = []
        tiles: list[Tile] = []
        for picture in message.tiles:
            if picture.tile >= in_row * in_column or tiles and picture.tile <= tiles[-1].index:
                raise DamagedData(f"a tile is {picture.tile}, not a rising one of {in_row * in_column}")
            left, top = picture.tile % in_row * side, picture.tile // in_row * side
            checked_before = struct.pack("<III", side, picture.tile, picture.detail)
            counts = dict(zip(_SIZES, _counts_of(picture)))
            dots = density = None
            if picture.detail == stream_pb2.DETAIL_FULL:
                decoder = full[picture.tile] = before.get(picture.tile) or _Deltas(frozenset(_SIZES))
                contents.append(decoder.decode(picture, message.position_bytes, checked_before))
            elif picture.detail == stream_pb2.DETAIL_DOTS:
                body = _body_of(picture, message.position_bytes, checked_before, 2 * sum(counts.values()))
                dots = _dots(body, counts, side / 256, left, top)
            elif picture.detail == stream_pb2.DETAIL_DENSITY:
                density = _density(_body_of(picture, message.position_bytes, checked_before, 1 << 16))
            else:
                raise DamagedData(f"a tile's detail is {picture.detail}, not one that is known here")
            tiles.append(Tile(picture.tile, picture.detail, left, top, side, counts, dots, density))
        self._tiles = full
        return _together(contents), tuple(tiles)


# ---- bodies -----------------------------------------------------------------------------------------------------------


class _Body:
    """What a body holds, from its beginning to its end."""

    def __init__(self, data: bytes) -> None:
        self.data, self.offset = data, 0

    def take(self, kind: str, count: int) -> Array:
        itemsize = numpy.dtype(kind).itemsize
        if count > (len(self.data) - self.offset) // itemsize:
            raise DamagedData("a picture's body ends too early")
        numbers = numpy.frombuffer(self.data, kind, count, self.offset)
        self.offset += count * itemsize
        return numbers

    def number(self, kind: str) -> int:
        return int(self.take(kind, 1)[0])

    def end(self) -> None:
        if self.offset != len(self.data):
            raise DamagedData("a picture's body is longer than it should be")

    def count(self, bytes_each: int) -> int:
        """Of what takes at least so many bytes each: memory is taken for no more than there can be."""
        count = self.number("<u4")
        if count * bytes_each > len(self.data) - self.offset:
            raise DamagedData("a picture's body ends too early")
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
            raise DamagedData(f"a column's width is {width}, not 0, 1, 2 or 4")
        column = self.take(f"<i{width}", count).astype(numpy.int32) if width else numpy.zeros(count, numpy.int32)
        if indices is not None:
            if len(indices) and int(indices.max()) >= count:
                raise DamagedData("a column has an exception beyond its end")
            column[indices] = values
        return column

    def rising_column(self, count: int) -> Array:
        numbers = numpy.cumsum(self.column(count).view(numpy.uint32).astype(numpy.int64) + 1) - 1
        if count and int(numbers[-1]) > 0xFFFFFFFF:
            raise DamagedData("an id does not fit into 32 bits")
        ids: Array = numbers.astype(numpy.uint32)
        return ids


def _counts_of(picture: Any) -> list[int]:
    return [getattr(picture, field) for field in _COUNTS]


def _body_of(picture: Any, position_bytes: int, checked_before: bytes, bytes_max: int) -> _Body:
    """The body of a SnapshotFrame or a SnapshotTile, once it is known to be whole. bytes_max: it is refused beyond."""
    data = picture.body
    if picture.compression == stream_pb2.COMPRESSION_ZSTD:
        data = _unpack(data, bytes_max)
    elif picture.compression > stream_pb2.COMPRESSION_NONE:
        raise DamagedData(f"a picture's compression is {picture.compression}, not one that is known here")
    head = struct.pack("<QQ6I", picture.sequence, picture.base_sequence, *_counts_of(picture), position_bytes)
    if zlib.crc32(data, zlib.crc32(checked_before + head)) != picture.checksum:
        raise DamagedData("a picture's checksum is not that of its body")
    return _Body(data)


_of_thread = threading.local()


def _unpacker() -> Any:
    """A decompressor of this thread: they are not safe to share, and decompressing lets other threads run."""
    if zstandard is None:
        raise DamagedData("a picture is compressed, and the package zstandard is not there")
    if not hasattr(_of_thread, "unpacker"):
        _of_thread.unpacker = zstandard.ZstdDecompressor()
    return _of_thread.unpacker


def _unpack(data: bytes, bytes_max: int) -> bytes:
    unpacker = _unpacker()
    try:
        content_bytes = zstandard.frame_content_size(data)
        if not 0 <= content_bytes <= bytes_max:
            raise DamagedData(f"a picture's content is {content_bytes} bytes long, not at most {bytes_max}")
        return bytes(unpacker.decompress(data)) if content_bytes else b""
    except zstandard.ZstdError as error:
        raise DamagedData(f"a picture cannot be unpacked: {error}") from None


def _columns(message: stream_pb2.SnapshotFrame) -> Content:
    """A body of CODEC_COLUMNS."""
    if message.codec != stream_pb2.CODEC_COLUMNS:
        raise DamagedData(f"a picture's codec is {message.codec}, not one that is known here")
    position = _position_kind(message.position_bytes)
    body = _body_of(message, message.position_bytes, b"", len(message.body))
    content = {}
    for (name, sizes), count in zip(_SIZES.items(), _counts_of(message)):
        columns = {"id": body.take("<u4", count)} if name in _HAVE_IDS else {}
        columns |= {field: body.take(position, count) for field in ("x", "y")}
        columns |= {field: body.take("<u2", count) for field in sizes}
        content[name] = columns
    body.end()
    return content


def _position_kind(position_bytes: int) -> str:
    if position_bytes not in (2, 4):
        raise DamagedData(f"position_bytes is {position_bytes}, not 2 or 4")
    return f"<u{position_bytes}"


# ---- told from the picture before ---------------------------------------------------------------------------------------


class _Deltas:
    """Bodies of CODEC_DELTA: of one island of one subscription, or of one tile of it."""

    def __init__(self, have_ids: frozenset[str]) -> None:
        self._have_ids = have_ids
        self._sequence = 0  # of the picture that the next one is told from; 0: there is none
        self._ticks = 0  # that its displacements took
        self._content: Content = {}

    def decode(self, picture: Any, position_bytes: int, checked_before: bytes = b"") -> Content:
        """picture: a SnapshotFrame or a SnapshotTile."""
        base, self._sequence = self._sequence, 0
        keyframe = picture.base_sequence == 0
        if not keyframe and picture.base_sequence != base:
            raise DamagedData(f"a picture's base_sequence is {picture.base_sequence}, not the last one, {base}")
        _position_kind(position_bytes)
        counts = _counts_of(picture)
        content_before = {} if keyframe else self._content
        known = sum(counts) + sum(len(columns["x"]) for columns in content_before.values())
        body = _body_of(picture, position_bytes, checked_before, 1024 + 64 * known)
        ticks = body.number("<u2")
        content = {}
        for (name, sizes), count in zip(_SIZES.items(), counts):
            section = self._section(body, name, sizes, content_before.get(name), ticks, position_bytes)
            if len(section["x"]) != count:
                raise DamagedData(f"a picture has {len(section['x'])} {name}, not {count}")
            content[name] = section
        body.end()
        self._ticks = ticks if ticks or keyframe else self._ticks
        self._content, self._sequence = content, picture.sequence
        return content

    def _section(
        self, body: _Body, name: str, sizes: Sequence[str], base: Columns | None, ticks: int, position_bytes: int
    ) -> Columns:
        has_ids, moves = name in self._have_ids, name in _MOVE
        fields = ("id",) * has_ids + ("x", "y", *sizes) + ("dx", "dy") * moves
        stayed = dict(base) if base is not None else {field: numpy.zeros(0, _kind_of(field)) for field in fields}
        parts = body.number("<u1")
        if parts & 1:
            gone_count = body.number("<u4")
            if gone_count > len(stayed["x"]):
                raise DamagedData(f"a picture tells that {gone_count} are gone of {len(stayed['x'])}")
            gone = body.rising_column(gone_count)
            if len(gone) and int(gone[-1]) >= len(stayed["x"]):
                raise DamagedData("a picture tells that something is gone which was not there")
            stays = numpy.ones(len(stayed["x"]), bool)
            stays[gone] = False
            stayed = {field: column[stays] for field, column in stayed.items()}
        come: dict[str, Array] = {}
        if parts & 2:
            count = body.count(2 * position_bytes + 2 * len(sizes))
            if has_ids:
                come["id"] = body.rising_column(count)
            come |= {field: body.planes(count, position_bytes) for field in ("x", "y")}
            come |= {field: body.planes(count, 2).astype(numpy.int32) for field in sizes}
            if moves:
                come |= {field: body.column(count) for field in ("dx", "dy")}
        count = len(stayed["x"])
        if count and moves:
            for field in ("x", "y"):
                before = stayed["d" + field]
                if ticks != max(self._ticks, 1):
                    before = (before.astype(numpy.int64) * ticks // max(self._ticks, 1)).astype(numpy.int32)
                way = body.column(count) + before  # modulo 2^32, as all of it
                stayed[field] = stayed[field] + way.view(numpy.uint32)
                if ticks:
                    stayed["d" + field] = way
        if count and name == "organisms":
            stayed["health"] = stayed["health"] + body.column(count)
        columns = _merged(stayed, come, has_ids) if come else stayed
        if has_ids and columns["id"].flags.writeable:
            columns["id"].flags.writeable = False
        return columns


def _kind_of(field: str) -> type[numpy.generic]:
    return numpy.uint32 if field in ("id", "x", "y") else numpy.int32


def _merged(stayed: Mapping[str, Array], come: Mapping[str, Array], by_id: bool) -> Columns:
    """Those that have come among the others by id; boxes have none, and come last."""
    if not by_id or not len(stayed["x"]):
        return {field: numpy.concatenate((stayed[field], come[field])) for field in come}
    places = numpy.searchsorted(stayed["id"], come["id"])
    at_old = numpy.minimum(places, len(stayed["id"]) - 1)
    if numpy.any(stayed["id"][at_old] == come["id"]):
        raise DamagedData("a picture tells that something has come which was there")
    new = numpy.zeros(len(stayed["id"]) + len(come["id"]), bool)
    new[places + numpy.arange(len(places))] = True
    old = ~new
    columns = {}
    for field, column in stayed.items():
        merged = numpy.empty(len(new), column.dtype)
        merged[old], merged[new] = column, come[field]
        columns[field] = merged
    return columns


# ---- tiles ----------------------------------------------------------------------------------------------------------------


def _dots(body: _Body, counts: Mapping[str, int], cell_px: float, left: float, top: float) -> Mapping[str, Array]:
    count = sum(counts.values())
    x, y = (body.take("<u1", count) * cell_px for _ in range(2))
    body.end()
    places = numpy.stack((x + left, y + top))
    ends = numpy.cumsum(list(counts.values()))
    return dict(zip(counts, numpy.split(places, ends[:-1], axis=1)))


def _density(body: _Body) -> Mapping[str, Array]:
    cells = body.number("<u1")
    if cells not in _DENSITY_CELLS:
        raise DamagedData(f"a density has {cells} cells in a row, not 1, 2, 4, 8 or 16")
    density = {name: body.column(cells * cells).reshape(cells, cells) for name in ("organisms", "food", "poison")}
    body.end()
    return density


def _together(contents: Sequence[Content]) -> Content:
    """The entities of several tiles, by id."""
    together: dict[str, Columns] = {}
    for name, sizes in _SIZES.items():
        fields = ("id", "x", "y", *sizes)
        columns = {
            field: numpy.concatenate([content[name][field] for content in contents])
            if contents
            else numpy.zeros(0, _kind_of(field))
            for field in fields
        }
        order = numpy.argsort(columns["id"], kind="stable")
        together[name] = {field: column[order] for field, column in columns.items()}
    return together
