# SPDX-License-Identifier: Apache-2.0
"""Convert an 8-bit grey PNG to a binary PGM, with nothing but Python's own library.

    png_to_pgm.py IN.png OUT.pgm
"""

import struct
import sys
import zlib
from pathlib import Path


def chunks(data):
    """Type and content of each chunk."""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("not a PNG file")
    at = 8
    while at < len(data):
        (length,) = struct.unpack_from(">I", data, at)
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += 12 + length


def paeth(left, up, corner):
    estimate = left + up - corner
    distances = [(abs(estimate - v), i, v) for i, v in enumerate((left, up, corner))]
    return min(distances)[2]


def unfilter(kind, row, above):
    """Undo one row's filter in place."""
    for i in range(len(row)):
        left, corner = (row[i - 1], above[i - 1]) if i else (0, 0)
        if kind == 1:
            guess = left
        elif kind == 2:
            guess = above[i]
        elif kind == 3:
            guess = (left + above[i]) // 2
        else:
            guess = paeth(left, above[i], corner)
        row[i] = (row[i] + guess) & 255


def read_grey(data):
    """Width, height and rows of a picture."""
    header, packed = b"", b""
    for kind, content in chunks(data):
        if kind == b"IHDR":
            header = content
        elif kind == b"IDAT":
            packed += content
    width, height, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", header)
    if (depth, colour, interlace) != (8, 0, 0):
        raise ValueError("only 8-bit grey without interlace is read")
    raw, rows, above = zlib.decompress(packed), [], bytes(width)
    for v in range(height):
        start = v * (width + 1)
        row = bytearray(raw[start + 1 : start + 1 + width])
        if raw[start]:
            unfilter(raw[start], row, above)
        rows.append(row)
        above = row
    return width, height, rows


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    width, height, rows = read_grey(Path(sys.argv[1]).read_bytes())
    Path(sys.argv[2]).write_bytes(b"P5\n%d %d\n255\n" % (width, height) + b"".join(rows))


if __name__ == "__main__":
    main()
