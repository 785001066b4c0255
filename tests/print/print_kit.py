# SPDX-License-Identifier: Apache-2.0
"""What the print tests share: running `opms print`, and poppler and librsvg as outside judges.

Positions are in the pattern's frame, mm: X down in print, Y right. A picture of a page is compared
with rectangles that the tests paint from numbers of their own.
"""
import json
import os
import re
import struct
import subprocess
import zlib
from collections import namedtuple
from pathlib import Path

OPMS = os.environ.get("OPMS", "opms")
OK, USAGE, INPUT = 0, 2, 4

BLACK, WHITE, GREY = 0, 255, 204
# 1 where a pixel is dark; the 20 % grey of the footprint's ticks is not.
DARK = bytes(1 if level < 128 else 0 for level in range(256))
# 1 where there is any ink: a ruler's line is finer than a pixel of the coarser pictures.
INK = bytes(1 if level < 250 else 0 for level in range(256))

Box = namedtuple("Box", "x0 x1 y0 y1")


def opms(*arguments, **kwargs):
    """Run the program; both outputs as text."""
    return subprocess.run([OPMS, *map(str, arguments)], capture_output=True, text=True,
                          timeout=300, **kwargs)


def make(out, *arguments):
    """`opms print ... --out OUT --json`; its rows."""
    result = opms("print", *arguments, "--out", out, "--json")
    if result.returncode != OK:
        raise AssertionError(f"exit {result.returncode}: {result.stderr}")
    return [json.loads(line) for line in result.stdout.splitlines()]


def box_of(json_box):
    return Box(*json_box["x"], *json_box["y"])


class Picture:
    """Grey picture of a page, and where its paper lies in the pattern's frame."""

    def __init__(self, width, height, pixels, px_per_mm, paper):
        self.width, self.height, self.pixels = width, height, pixels
        self.scale, self.paper = px_per_mm, paper

    def pixel_box(self, box):
        """(row0, row1, column0, column1); the tests choose boxes on whole pixels."""
        return tuple(round(value) for value in (
            (box.x0 - self.paper.x0) * self.scale, (box.x1 - self.paper.x0) * self.scale,
            (box.y0 - self.paper.y0) * self.scale, (box.y1 - self.paper.y0) * self.scale))

    def rows(self, box):
        """The rows of pixels inside a box."""
        row0, row1, column0, column1 = self.pixel_box(box)
        assert 0 <= row0 <= row1 <= self.height and 0 <= column0 <= column1 <= self.width
        for row in range(row0, row1):
            yield self.pixels[row * self.width + column0:row * self.width + column1]

    def across(self, x, y0, y1):
        """Runs of ink along Y at X = x: a list of (from, to) in mm."""
        line = next(self.rows(Box(x, x + 1 / self.scale, y0, y1)))
        return [(y0 + a, y0 + b) for a, b in self._runs(line)]

    def down(self, y, x0, x1):
        """Runs of ink along X at Y = y."""
        line = b"".join(self.rows(Box(x0, x1, y, y + 1 / self.scale)))
        return [(x0 + a, x0 + b) for a, b in self._runs(line)]

    def _runs(self, line):
        return [(m.start() / self.scale, m.end() / self.scale)
                for m in re.finditer(b"\x01+", line.translate(INK))]

    def grey_boxes(self, area):
        """Hulls of the connected patches of exactly 20 % grey inside an area."""
        patches = []
        for number, line in enumerate(self.rows(area)):
            x = area.x0 + number / self.scale
            for match in re.finditer(bytes([GREY]) + b"+", line):
                self._join(patches, Box(x, x + 1 / self.scale, area.y0 + match.start() / self.scale,
                                        area.y0 + match.end() / self.scale))
        return patches

    @staticmethod
    def _join(patches, box, near=1.0):
        for i, other in enumerate(patches):
            if (box.x0 <= other.x1 + near and other.x0 <= box.x1 + near and
                    box.y0 <= other.y1 + near and other.y0 <= box.y1 + near):
                patches[i] = Box(min(box.x0, other.x0), max(box.x1, other.x1),
                                 min(box.y0, other.y0), max(box.y1, other.y1))
                return
        patches.append(box)


def pdf_sizes(path):
    """Width and height of each page, mm, as pdfinfo has them."""
    text = subprocess.run(["pdfinfo", "-f", "1", "-l", "999", path], check=True,
                          capture_output=True, text=True).stdout
    return [(float(w) * 25.4 / 72, float(h) * 25.4 / 72)
            for w, h in re.findall(r"Page\s+\d+ size:\s+([\d.]+) x ([\d.]+) pts", text)]


def pdf_text(path):
    """All words of a PDF, one blank between them."""
    text = subprocess.run(["pdftotext", "-layout", path, "-"], check=True, capture_output=True,
                          text=True).stdout
    return " ".join(text.split())


def pdf_picture(path, page, px_per_mm):
    """One page, drawn by poppler. @p page is the row of `pages` in the program's report."""
    data = subprocess.run(["pdftoppm", "-r", str(25.4 * px_per_mm), "-gray", "-f",
                           str(page["number"]), "-l", str(page["number"]), path],
                          check=True, capture_output=True).stdout
    width, height, start = pgm_header(data)
    return Picture(width, height, data[start:], px_per_mm, box_of(page["paper_mm"]))


def pgm_header(data):
    match = re.match(rb"P5\s+(\d+)\s+(\d+)\s+255\s", data)
    return int(match[1]), int(match[2]), match.end()


def svg_size(path):
    """Width and height of an SVG, mm; its units must be points."""
    match = re.search(r'<svg[^>]*width="([\d.]+)pt" height="([\d.]+)pt"',
                      Path(path).read_text(encoding="utf-8"))
    return tuple(float(value) * 25.4 / 72 for value in match.groups())


def svg_picture(path, page, px_per_mm):
    """One SVG, drawn by librsvg."""
    dpi = str(25.4 * px_per_mm)
    data = subprocess.run(["rsvg-convert", "-d", dpi, "-p", dpi, "-b", "white", path], check=True,
                          capture_output=True).stdout
    width, height, pixels = read_png(data)
    return Picture(width, height, pixels, px_per_mm, box_of(page["paper_mm"]))


def read_png(data):
    """Width, height and first channel of a PNG of 8 bit RGB or RGBA."""
    packed, at = b"", 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    channels = {2: 3, 6: 4}[colour]
    assert depth == 8
    raw, stride = zlib.decompress(packed), width * channels
    pixels, above = bytearray(), bytes(stride)
    for row in range(height):
        start = row * (stride + 1)
        above = unfilter(raw[start], bytearray(raw[start + 1:start + 1 + stride]), above, channels)
        pixels += above[::channels]
    return width, height, bytes(pixels)


def unfilter(kind, line, above, step):
    """One row of a PNG; the five filters of its standard."""
    if kind == 0 or (kind == 2 and not any(above)):
        return line
    for i in range(len(line)):
        left = line[i - step] if i >= step else 0
        corner = above[i - step] if i >= step else 0
        up = above[i]
        guess = (0, left, up, (left + up) // 2, paeth(left, up, corner))[kind]
        line[i] = (line[i] + guess) & 255
    return line


def paeth(left, up, corner):
    near_left, near_up, near_corner = (abs(up - corner), abs(left - corner),
                                       abs(left + up - 2 * corner))
    if near_left <= near_up and near_left <= near_corner:
        return left
    return up if near_up <= near_corner else corner


def differences(picture, area, paint):
    """Rows (X in mm) at which a picture differs, inside an area, from painted boxes.

    @param paint  List of (1 for black or 0 for white, Box), in painting order."""
    row0, _, column0, column1 = picture.pixel_box(area)
    wanted_boxes = [(dark, picture.pixel_box(box)) for dark, box in paint]
    found = []
    for number, line in enumerate(picture.rows(area)):
        row, wanted = row0 + number, bytearray(column1 - column0)
        for dark, (top, bottom, left, right) in wanted_boxes:
            left, right = max(left, column0) - column0, min(right, column1) - column0
            if top <= row < bottom and left < right:
                wanted[left:right] = bytes([dark]) * (right - left)
        if line.translate(DARK) != wanted:
            found.append(row / picture.scale + picture.paper.x0)
    return found
