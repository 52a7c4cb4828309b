"""Wire frames: an 8-byte header and a body (docs/PROTOCOL.md, Frames)."""
from __future__ import annotations

import struct
from typing import Iterator

from evod.errors import DamagedData

CONTROL, STREAM = 1, 2
BODY_BYTES_MAX = {CONTROL: 64 << 20, STREAM: 256 << 20}  # the largest body that a client accepts, by channel
HEADER_BYTES = 8

_header = struct.Struct("<2sBBI")


def encode(body: bytes) -> bytes:
    """Returns a control frame with this body."""
    return _header.pack(b"EV", 1, CONTROL, len(body)) + body


class FrameReader:
    """Splits a stream of bytes into frames."""

    def __init__(self) -> None:
        self._data = bytearray()
        self._offset = 0  # offset in the buffer of the first byte that no returned frame contains

    def feed(self, data: bytes | bytearray | memoryview) -> None:
        """Appends the bytes that arrived next."""
        if self._offset:
            del self._data[: self._offset]
            self._offset = 0
        self._data += data

    def frames(self) -> Iterator[tuple[int, bytes]]:
        """Yields (channel, body) for each complete frame. After DamagedData the rest of the stream cannot be read."""
        while len(self._data) - self._offset >= HEADER_BYTES:
            magic, version, channel, length = _header.unpack_from(self._data, self._offset)
            if magic != b"EV":
                raise DamagedData(f"a frame begins with {magic.hex(' ')}, not with 45 56")
            if version != 1:
                raise DamagedData(f"a frame's version is {version}, not 1")
            if channel not in BODY_BYTES_MAX:
                raise DamagedData(f"a frame's channel is {channel}, not 1 or 2")
            if length > BODY_BYTES_MAX[channel]:
                raise DamagedData(f"a frame's body is {length} bytes long, more than {BODY_BYTES_MAX[channel]}")
            begin = self._offset + HEADER_BYTES
            if len(self._data) < begin + length:
                return
            with memoryview(self._data) as data:
                body = bytes(data[begin : begin + length])
            self._offset = begin + length
            yield channel, body
