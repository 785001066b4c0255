# SPDX-License-Identifier: Apache-2.0
"""Every square, cell and line of a one-page print is where the definition has it."""
import shutil
import tempfile
import unittest
from pathlib import Path

import print_truth
from print_kit import (Box, differences, make, pdf_picture, pdf_sizes, pdf_text, svg_picture,
                       svg_size)


class PatternTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def page_of(self, name, *arguments):
        (row,) = make(self.folder / name, *arguments)
        (page,) = row["pages"]
        return row["file"], page

    def assert_size(self, sizes, width, height):
        for found in sizes:
            self.assertAlmostEqual(found[0], width, delta=0.1)
            self.assertAlmostEqual(found[1], height, delta=0.1)

    def assert_ticks(self, runs, start):
        """Eleven ticks of a ruler: a fine line every 10 mm."""
        self.assertEqual(len(runs), 11)
        for step, (begin, end) in enumerate(runs):
            self.assertAlmostEqual((begin + end) / 2, start + 10 * step, delta=0.13)
            self.assertLess(end - begin, 0.6)

    def test_the_bar_in_pdf_has_every_square_and_cell(self):
        # Given a bar at ten pixels a millimetre
        path, page = self.page_of("bar.pdf", "bar")
        self.assert_size(pdf_sizes(path), 1040, 190)
        picture = pdf_picture(path, page, 10)
        # When it is compared with the definition, pixel by pixel
        wrong = differences(picture, print_truth.BAR, print_truth.hope33())
        # Then nothing differs, and nothing stands within 1 mm around it
        self.assertEqual(wrong, [])
        frame = Box(-16, 16, -501, 501)
        self.assertEqual(differences(picture, frame, print_truth.hope33()), [])

    def test_the_bars_rulers_and_cut_marks_measure_true(self):
        path, page = self.page_of("bar.pdf", "bar")
        picture = pdf_picture(path, page, 10)
        # Rulers of 100 mm to the right and down, from (40, -480)
        self.assert_ticks(picture.across(39, -481, -379.5), -480)
        self.assert_ticks(picture.down(-481, 39, 140.5), 40)
        # Cut marks in line with the bar's ends and long sides
        ends = [(a + b) / 2 for a, b in picture.across(-19, -510, 510)]
        self.assertEqual(len(ends), 2)
        self.assertAlmostEqual(ends[0], -500, delta=0.06)
        self.assertAlmostEqual(ends[1], 500, delta=0.06)
        sides = [(a + b) / 2 for a, b in picture.down(-504, -20, 20)]
        self.assertEqual(len(sides), 2)
        self.assertAlmostEqual(sides[0], -15, delta=0.06)
        self.assertAlmostEqual(sides[1], 15, delta=0.06)

    def test_the_bars_words_name_it_with_scale_and_version(self):
        path, _ = self.page_of("bar.pdf", "bar")
        self.assertRegex(pdf_text(path), r"marker bar hope33 \| scale 1:1 \| opms \d+\.\d+\.\d+")

    @unittest.skipUnless(shutil.which("rsvg-convert"), "rsvg-convert (librsvg2-bin) is not here")
    def test_the_bar_in_svg_is_the_same(self):
        path, page = self.page_of("bar.svg", "bar")
        self.assert_size([svg_size(path)], 1040, 190)
        picture = svg_picture(path, page, 2)
        self.assertEqual(picture.width, 2080)
        self.assertIn(picture.height, (380, 381))  # librsvg rounds up
        self.assertEqual(differences(picture, print_truth.BAR, print_truth.hope33()), [])

    def test_the_grid_has_every_line_and_the_marker(self):
        path, page = self.page_of("grid.pdf", "grid")
        self.assert_size(pdf_sizes(path), 1189, 841)
        picture = pdf_picture(path, page, 4)
        around = Box(-402, 402, -552, 552)
        self.assertEqual(differences(picture, around, print_truth.grid()), [])
        # The sheet's middle is the centre node.
        self.assertEqual(picture.paper, Box(-420.5, 420.5, -594.5, 594.5))
        self.assert_ticks(picture.across(-407.5, 429, 531), 430)
        self.assert_ticks(picture.down(-566, -381, -279), -380)

    def test_the_evaluation_sheet_has_the_bar_over_hidden_nodes(self):
        path, page = self.page_of("evaluation.pdf", "evaluation")
        self.assert_size(pdf_sizes(path), 1189, 841)
        picture = pdf_picture(path, page, 4)
        self.assertEqual(differences(picture, print_truth.LINES, print_truth.evaluation()), [])

    def test_pdf_and_svg_are_the_same_bytes_every_time(self):
        for name in ("grid.pdf", "grid.svg"):
            path, _ = self.page_of(name, "grid")
            first = Path(path).read_bytes()
            self.page_of(name, "grid")
            self.assertEqual(Path(path).read_bytes(), first)


if __name__ == "__main__":
    unittest.main()
