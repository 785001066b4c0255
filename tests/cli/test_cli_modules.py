# SPDX-License-Identifier: Apache-2.0
"""The installed program and its modules: found beside it, and said plainly where they are not."""
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from cli_kit import CAMERA, INPUT, OK, png, rows

PGM = b"P5 64 48 255\n" + b"\x50" * 64 * 48


class InstalledProgram(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.prefix = cls.folder / "prefix"
        made = subprocess.run([os.environ["CMAKE"], "--install", os.environ["BUILD"], "--strip",
                               "--component", "runtime", "--prefix", str(cls.prefix)],
                              capture_output=True, text=True)
        if made.returncode != 0:
            raise AssertionError(f"not installed: {made.stderr}")
        # What is installed is judged where the build folder's own modules cannot help.
        [cls.program] = cls.prefix.glob("bin/opms")
        cls.modules = {path.name: path for path in cls.prefix.glob("**/opms/opms_*.so")}
        for name, content in (("camera.yaml", CAMERA.encode()), ("grey.pgm", PGM),
                              ("grey.png", png())):
            (cls.folder / name).write_bytes(content)

    def opms(self, *arguments):
        environment = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
        return subprocess.run([self.program, *map(str, arguments)], capture_output=True,
                              text=True, timeout=120, env=environment, cwd=self.folder)

    def locate(self, picture):
        return self.opms("locate", "--json", "--camera", "camera.yaml", picture)

    def without(self, module):
        """Take a module away until the test is over."""
        path = self.modules[module]
        aside = path.with_suffix(".aside")
        path.rename(aside)
        self.addCleanup(aside.rename, path)

    def test_other_formats_than_png_are_read_with_the_module(self):
        result = self.locate("grey.pgm")
        self.assertEqual((result.returncode, rows(result)[0]["state"]), (OK, "absent"),
                         result.stderr)

    def test_without_it_png_is_read_and_the_module_is_named_for_the_others(self):
        self.without("opms_imgcodecs.so")
        self.assertEqual(rows(self.locate("grey.png"))[0]["state"], "absent")
        result = self.locate("grey.pgm")
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("opms_imgcodecs.so is not installed", rows(result)[0]["reason"])

    def test_a_module_that_is_none_is_named(self):
        self.without("opms_imgcodecs.so")
        self.modules["opms_imgcodecs.so"].write_bytes(b"no library")
        self.addCleanup(self.modules["opms_imgcodecs.so"].unlink)
        result = self.locate("grey.pgm")
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("opms_imgcodecs.so cannot be loaded", rows(result)[0]["reason"])

    def preview(self):
        if "opms_preview.so" not in self.modules:
            self.skipTest("built without OpenCV's videoio")
        result = self.opms("scan", "--box", "none", "--camera", "camera.yaml",
                           "--source", "preview:987")
        self.assertNotEqual(result.returncode, OK)
        return result.stderr

    def test_the_preview_finds_its_module(self):
        self.assertIn("OpenCV finds no camera 987", self.preview())

    def test_without_it_the_preview_names_the_module(self):
        self.preview()
        self.without("opms_preview.so")
        self.assertIn("opms_preview.so is not installed", self.preview())

    def test_the_program_itself_loads_neither_codecs_nor_video(self):
        listing = subprocess.run(["ldd", self.program], capture_output=True, text=True,
                                 check=True).stdout
        self.assertIn("libopencv_core", listing)
        for library in ("libopencv_imgcodecs", "libopencv_videoio", "libgdal", "libavcodec"):
            self.assertNotIn(library, listing)


if __name__ == "__main__":
    unittest.main()
