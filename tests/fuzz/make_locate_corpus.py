# SPDX-License-Identifier: Apache-2.0
"""Write the seeds of fuzz_locate: pieces of the test pictures, in the form that it reads.

    make_locate_corpus.py        (needs Pillow; the seeds are kept in corpus/locate)

A piece of a picture taken with a lens is a picture of the same lens with its principal point
moved, so the bar in it can be located.
"""
import struct
from pathlib import Path

from PIL import Image

HERE = Path(__file__).resolve().parent
PICTURES = HERE.parent / "data" / "bar"
WIDE, ROI, HINT, WHITE_LEVEL = 1, 2, 4, 8
BOXES = {"near": (480, 256, 256, 256), "far": (640, 256, 256, 256)}


def setup(size, flags=0, focal=20, cx=0, cy=0, roi=(0, 0, 0, 0), padding=0):
    return struct.pack("<4B7b5B", size[0] - 1, size[1] - 1, flags, 7, focal, cx, cy,
                       -12, 3, 1, -1, *roi, padding)


def piece(name, box):
    """Pixels of a box (left, top, width, height), and the lens of that piece as setup() has it."""
    left, top, width, height = box
    picture = Image.open(PICTURES / name).convert("L")
    pixels = picture.crop((left, top, left + width, top + height))
    longer = max(width, height)
    lens = {
        "focal": round(50 * (585 / longer - 0.6)),
        "cx": round(100 * (517.3 - left - (width - 1) / 2) / longer),
        "cy": round(100 * (379.6 - top - (height - 1) / 2) / longer),
    }
    return pixels, lens


def seeds():
    pixels, lens = piece("bar_01011.png", BOXES["near"])
    data = pixels.tobytes()
    yield "near", setup(pixels.size, **lens) + data
    yield "near_hint", setup(pixels.size, HINT, **lens, roi=(100, 50, 0, 0)) + data
    yield "near_roi", setup(pixels.size, ROI, **lens, roi=(20, 20, 200, 200)) + data
    sixteen = b"".join(struct.pack("<H", 16 * grey) for grey in data)
    yield "near_12_bit", setup(pixels.size, WIDE | WHITE_LEVEL, **lens) + sixteen
    pixels, lens = piece("bar_01005.png", BOXES["far"])
    yield "far", setup(pixels.size, **lens) + pixels.tobytes()
    yield "black", setup((64, 64)) + b"\0"
    yield "stripes", setup((120, 90)) + b"\0\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff\xff"
    yield "one_pixel", setup((1, 1)) + b"\x80"


def main():
    folder = HERE / "corpus" / "locate"
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in seeds():
        (folder / name).write_bytes(data)
        print(f"{name}: {len(data)} bytes")


if __name__ == "__main__":
    main()
