# SPDX-License-Identifier: Apache-2.0
"""What the command line tests share: running `opms`, and small pictures and camera files."""
import json
import os
import struct
import subprocess
import tempfile
import unittest
import zlib
from pathlib import Path

OPMS = os.environ.get("OPMS", "opms")
DATA = Path(__file__).resolve().parents[1] / "data"

OK, RESULT, USAGE, INPUT = 0, 1, 2, 4

CAMERA = """\
image_width: 64
image_height: 48
camera_name: test
camera_matrix:
  rows: 3
  cols: 3
  data: [60.0, 0.0, 31.5, 0.0, 60.0, 23.5, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.1, 0.02, 0.001, -0.001, 0.0]
opms:
  version: 1
  R_detector_camera: [-1, 0, 0, 0, 1, 0, 0, 0, -1]
  t_detector_camera_m: [-0.1, 0.0, 0.4]
"""


def opms(*arguments, **kwargs):
    """Run the program; both outputs as text."""
    return subprocess.run([OPMS, *map(str, arguments)], capture_output=True, text=True,
                          timeout=120, **kwargs)


def rows(result):
    """The JSON rows of a run."""
    return [json.loads(line) for line in result.stdout.splitlines()]


def _chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png(width=64, height=48, bits=8, channels=1, claim=None, level=90):
    """Bytes of a PNG of one grey level. @p claim is another size for its header."""
    sample = bytes([level]) * (bits // 8)
    raw = (b"\0" + sample * channels * width) * height
    header = struct.pack(">IIBBBBB", *(claim or (width, height)), bits,
                         {1: 0, 3: 2, 4: 6}[channels], 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) +
            _chunk(b"IDAT", zlib.compress(raw)) + _chunk(b"IEND", b""))


class CliTest(unittest.TestCase):
    """A test with a folder of its own that holds a camera file and a picture without a bar."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.camera = self.write("camera.yaml", CAMERA)
        self.blank = self.write("blank.png", png())

    def write(self, name, content):
        path = self.folder / name
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            path.write_text(content, encoding="utf-8")
        return path

    def locate(self, *arguments, camera=None, **kwargs):
        return opms("locate", "--camera", camera or self.camera, *arguments, **kwargs)
