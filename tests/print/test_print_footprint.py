# SPDX-License-Identifier: Apache-2.0
"""The footprint's grey marks: where they stand, and what the sheet says about them."""
import math
import tempfile
import unittest
from pathlib import Path

import print_truth
from print_kit import Box, differences, make, pdf_picture, pdf_text


class FootprintTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def marks(self, *arguments, product="grid"):
        """Grey patches and words of a sheet; no mark may disturb a line."""
        (row,) = make(self.folder / "sheet.pdf", product, *arguments)
        picture = pdf_picture(row["file"], row["pages"][0], 4)
        paint = print_truth.grid() if product == "grid" else print_truth.evaluation()
        self.assertEqual(differences(picture, print_truth.LINES, paint), [])
        boxes = sorted(picture.grey_boxes(print_truth.LINES))
        for box in boxes:
            self.assert_in_one_white_square(box)
        return boxes, pdf_text(row["file"])

    def assert_in_one_white_square(self, box):
        for low, high in ((box.x0, box.x1), (box.y0, box.y1)):
            line = math.floor((low + high) / 2 / 25) * 25
            self.assertGreaterEqual(low, line + 1)
            self.assertLessEqual(high, line + 24)

    def assert_box(self, box, wanted):
        for found, value in zip(box, wanted):
            self.assertAlmostEqual(found, value, delta=0.13)

    def test_four_ticks_go_outwards_from_the_outline_on_the_heads_axes(self):
        boxes, words = self.marks("--footprint", "112.5,12.5,0", "--head-diameter-mm", 150)
        self.assertEqual(len(boxes), 4)
        for box, wanted in zip(boxes, [Box(31.5, 37.5, 12.25, 12.75),
                                       Box(112.25, 112.75, -68.5, -62.5),
                                       Box(112.25, 112.75, 87.5, 93.5),
                                       Box(187.5, 193.5, 12.25, 12.75)]):
            self.assert_box(box, wanted)
        self.assertIn("centre X 112.5 mm, Y 12.5 mm, yaw 0 deg, diameter 150 mm", words)
        self.assertIn("two Y ticks and two X ticks", words)
        self.assertNotIn("leaves", words)

    def test_by_default_the_outline_leaves_the_sheet_and_the_sheet_says_so(self):
        boxes, words = self.marks()
        self.assertIn("centre X 350 mm, Y 0 mm, yaw 0 deg, diameter 200 mm", words)
        self.assertIn("The outline leaves the sheet beyond +X.", words)
        self.assertIn("two Y ticks and the X centre line", words)
        # A line along the head's X axis and two ticks on its Y axis, none under the head, each
        # beside the grid line on which it would stand
        self.assertEqual(len(boxes), 3)
        line, left, right = boxes
        self.assertAlmostEqual(line.x1 - line.x0, 18, delta=0.13)
        self.assertLessEqual(line.x1, 250)
        self.assertLess(max(abs(line.y0), abs(line.y1)), 2)
        for tick, side in ((left, -1), (right, 1)):
            near, far = sorted((side * tick.y0, side * tick.y1))
            self.assertAlmostEqual(far - near, 6, delta=0.13)
            self.assertGreaterEqual(near, 100)
            self.assertLess(near, 102)
            self.assertLess(abs((tick.x0 + tick.x1) / 2 - 350), 2)

    def test_a_turned_head_has_turned_ticks(self):
        boxes, _ = self.marks("--footprint", "-112.5,-12.5,90", "--head-diameter-mm", 150)
        self.assertEqual(len(boxes), 4)
        boxes, words = self.marks("--footprint=-112.5,-12.5,30", "--head-diameter-mm", 160)
        self.assertEqual(len(boxes), 4)
        self.assertIn("yaw 30 deg", words)
        # The X axis of a head turned by +30 degrees points down and to the right.
        reach = 83
        wanted = (-112.5 + reach * math.cos(math.pi / 6), -12.5 + reach * math.sin(math.pi / 6))
        nearest = min(math.hypot((b.x0 + b.x1) / 2 - wanted[0], (b.y0 + b.y1) / 2 - wanted[1])
                      for b in boxes)
        self.assertLess(nearest, 4)

    def test_a_head_beyond_a_y_side_keeps_its_x_ticks(self):
        boxes, words = self.marks("--footprint", "112.5,512.5,0", "--head-diameter-mm", 200)
        self.assertEqual(len(boxes), 3)
        self.assertIn("leaves the sheet beyond +Y", words)
        self.assertIn("the Y centre line and two X ticks", words)

    def test_no_mark_stands_on_the_bar_or_beside_the_marker(self):
        self.marks("--footprint", "-262.5,12.5,0", "--head-diameter-mm", 190, product="evaluation")
        boxes, _ = self.marks("--footprint", "100,12,0", "--head-diameter-mm", 170)
        for box in boxes:
            self.assertFalse(0 < box.x1 and box.x0 < 25 and 0 < box.y1 and box.y0 < 25)


if __name__ == "__main__":
    unittest.main()
