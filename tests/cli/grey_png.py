# SPDX-License-Identifier: Apache-2.0
"""Pixels of a grey PNG of 8 bit, and a PGM of pixels, with the standard library alone."""
import struct
import zlib


def _chunks(data):
    at = 8
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        yield kind, data[at + 8:at + 8 + length]
        at += 12 + length


def _paeth(left, above, corner):
    guess = left + above - corner
    return min((abs(guess - left), 0, left), (abs(guess - above), 1, above),
               (abs(guess - corner), 2, corner))[2]


def _unfiltered(kind, line, above):
    """One row by the filters of the PNG specification, one byte a pixel."""
    out = bytearray(len(line))
    for i, value in enumerate(line):
        left, corner = (out[i - 1], above[i - 1]) if i else (0, 0)
        add = (0, left, above[i], (left + above[i]) // 2,
               _paeth(left, above[i], corner) if kind == 4 else 0)[kind]
        out[i] = (value + add) & 255
    return out


def grey_pixels(data):
    """(width, height, pixels row by row)."""
    chunks = list(_chunks(data))
    width, height, bits, colour, _, _, interlaced = struct.unpack(">IIBBBBB", chunks[0][1])
    assert (bits, colour, interlaced) == (8, 0, 0), "grey, 8 bit, not interlaced"
    raw = zlib.decompress(b"".join(body for kind, body in chunks if kind == b"IDAT"))
    above, rows = bytearray(width), []
    for row in range(height):
        start = row * (width + 1)
        above = _unfiltered(raw[start], raw[start + 1:start + 1 + width], above)
        rows.append(bytes(above))
    return width, height, b"".join(rows)


def pgm(width, height, pixels):
    """Bytes of a PGM."""
    return b"P5\n%d %d\n255\n" % (width, height) + bytes(pixels)
