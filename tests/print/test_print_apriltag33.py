# SPDX-License-Identifier: Apache-2.0
"""The bar of AprilTags as libapriltag's detector reads it from a rendered page."""
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from print_kit import BLACK, Box, differences, make, pdf_picture, pdf_sizes, pdf_text

JUDGE = os.environ["APRILTAG_JUDGE"]
PX_PER_MM = 4


class AprilTagBarTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (row,) = make(self.folder / "tags.pdf", "bar", "--bar", "apriltag33")
        self.path, (self.page,) = row["file"], row["pages"]
        self.picture = pdf_picture(self.path, self.page, PX_PER_MM)

    def judged(self):
        """Tags in the picture: id -> corners (X, Y), mm, upright from the top left clockwise."""
        picture = self.picture
        text = subprocess.run([JUDGE, str(picture.width), str(picture.height)], check=True,
                              input=picture.pixels, capture_output=True,
                              timeout=120).stdout.decode()
        tags = {}
        for line in text.splitlines():
            number, wrong_bits, *uv = line.split()
            self.assertEqual(wrong_bits, "0")
            uv = [float(value) / PX_PER_MM for value in uv]
            tags[int(number)] = [(uv[i + 1] + picture.paper.x0, uv[i] + picture.paper.y0)
                                 for i in range(0, 8, 2)]
        return tags

    def test_the_detector_reads_all_tags_upright_and_in_place(self):
        tags = self.judged()
        self.assertEqual(sorted(tags), list(range(33)))
        for k, corners in tags.items():
            y = -480 + 30 * k
            wanted = [(-10, y - 10), (-10, y + 10), (10, y + 10), (10, y - 10)]
            for found, where in zip(corners, wanted):
                self.assertAlmostEqual(found[0], where[0], delta=0.1)
                self.assertAlmostEqual(found[1], where[1], delta=0.1)

    def test_borders_are_black_and_what_is_around_them_is_white(self):
        for k in range(33):
            y = -480 + 30 * k
            for box in (Box(-10, -7.5, y - 10, y + 10), Box(7.5, 10, y - 10, y + 10),
                        Box(-10, 10, y - 10, y - 7.5), Box(-10, 10, y + 7.5, y + 10)):
                self.assertEqual({v for line in self.picture.rows(box) for v in line}, {BLACK})
            gap = Box(-15, 15, y + 10, y + 20)
            self.assertEqual(differences(self.picture, gap, []), [])

    def test_the_page_is_as_large_as_that_of_the_other_bar_and_named(self):
        ((width, height),) = pdf_sizes(self.path)
        self.assertAlmostEqual(width, 1040, delta=0.1)
        self.assertAlmostEqual(height, 190, delta=0.1)
        self.assertIn("marker bar apriltag33 | scale 1:1", pdf_text(self.path))


if __name__ == "__main__":
    unittest.main()
