# SPDX-License-Identifier: Apache-2.0
"""Write the seeds of fuzz_grid: pieces of the test pictures, in the form that it reads.

    make_grid_corpus.py        (needs Pillow; the seeds are kept in corpus/grid)
"""
import struct
from pathlib import Path

from PIL import Image

HERE = Path(__file__).resolve().parent
PICTURES = HERE.parent / "data" / "grid"
WIDE, WHITE_LEVEL, OTHER_SIZE = 1, 2, 4
# In each picture the marker, and in the last one a piece without it.
PIECES = {
    "marker": ("grid_02005.png", (400, 280, 224, 200)),
    "lifted": ("grid_02009.png", (400, 280, 240, 240)),
    "plain": ("grid_02010.png", (60, 60, 160, 140)),
}


def setup(size, flags=0, min_pitch=9, padding=0, shift=(3, -2), turn=1):
    return struct.pack("<5B2bB", size[0] - 1, size[1] - 1, flags, min_pitch, padding, *shift, turn)


def piece(name):
    file, (left, top, width, height) = PIECES[name]
    picture = Image.open(PICTURES / file).convert("L")
    return picture.crop((left, top, left + width, top + height))


def seeds():
    for name in PIECES:
        pixels = piece(name)
        yield name, setup(pixels.size) + pixels.tobytes()
    pixels = piece("plain")
    yield "plain_12_bit", setup(pixels.size, WIDE | WHITE_LEVEL) + b"".join(
        struct.pack("<H", 16 * grey) for grey in pixels.tobytes())
    yield "padded", setup((90, 80), padding=3) + pixels.crop((0, 0, 93, 80)).tobytes()
    yield "other_size", setup((64, 64), OTHER_SIZE) + b"\x80"
    yield "black", setup((64, 64)) + b"\0"
    yield "stripes", setup((120, 90)) + b"\0\0\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff"
    row = b"\0\0" + b"\xff" * 13
    yield "crosses", setup((150, 150)) + (b"\0" * 300 + 13 * (10 * row))
    yield "smallest", setup((16, 16)) + b"\x80"


def main():
    folder = HERE / "corpus" / "grid"
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in seeds():
        (folder / name).write_bytes(data)
        print(f"{name}: {len(data)} bytes")


if __name__ == "__main__":
    main()
