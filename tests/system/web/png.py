"""Reads PNG files of 8 bits a channel with NumPy, so that tests need no further library."""
import struct
import zlib

import numpy


def decode(data):
    """The colours as an array of shape (height, width, 3)."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, content = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert (depth, interlaced) == (8, 0) and colour in (2, 6), (depth, colour, interlaced)
        elif kind == b"IDAT":
            content += body
        at += 12 + length
    channels = 3 if colour == 2 else 4
    rows = numpy.frombuffer(zlib.decompress(content), numpy.uint8).reshape(height, 1 + width * channels)
    above = numpy.zeros(width * channels, numpy.uint8)
    pixels = numpy.empty((height, width * channels), numpy.uint8)
    for y in range(height):
        above = pixels[y] = unfiltered(rows[y, 0], rows[y, 1:], above, channels)
    return pixels.reshape(height, width, channels)[:, :, :3]


def unfiltered(kind, row, above, channels):
    """The bytes of a row (ISO/IEC 15948, section 9)."""
    if kind == 0:
        return row
    if kind == 1:
        return numpy.cumsum(row.reshape(-1, channels), axis=0, dtype=numpy.uint8).reshape(-1)
    if kind == 2:
        return row + above
    done, over = bytearray(row), above.tobytes()
    for i, byte in enumerate(row.tobytes()):
        a, b, c = (done[i - channels], over[i], over[i - channels]) if i >= channels else (0, over[i], 0)
        done[i] = byte + ((a + b) // 2 if kind == 3 else paeth(a, b, c)) & 255
    return numpy.frombuffer(bytes(done), numpy.uint8)


def paeth(a, b, c):
    to_a, to_b, to_c = abs(b - c), abs(a - c), abs(a + b - 2 * c)
    return a if to_a <= to_b and to_a <= to_c else b if to_b <= to_c else c
