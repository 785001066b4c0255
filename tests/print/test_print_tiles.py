# SPDX-License-Identifier: Apache-2.0
"""Tiles: each shows its part of the pattern true to scale, and together they show all of it."""
import tempfile
import unittest
from pathlib import Path

import print_truth
from print_kit import Box, box_of, differences, make, pdf_picture, pdf_sizes, pdf_text, svg_size

PAPER = {"a4": (210, 297), "a3": (297, 420)}
OVERLAP = 10


def common(a, b):
    return Box(max(a.x0, b.x0), min(a.x1, b.x1), max(a.y0, b.y0), min(a.y1, b.y1))


class TilesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def tiles(self, product, tile):
        (row,) = make(self.folder / "tiles.pdf", product, "--tile", tile)
        return row["file"], row["pages"]

    def assert_paper(self, path, pages, tile):
        sizes = pdf_sizes(path)
        self.assertEqual(len(sizes), len(pages))
        for size in sizes:
            for found, wanted in zip(sorted(size), PAPER[tile]):
                self.assertAlmostEqual(found, wanted, delta=0.1)

    def assert_covered(self, pages, area):
        """Windows form rows and columns that overlap and reach over all of the area."""
        for name, low, high in (("column", "y0", "y1"), ("row", "x0", "x1")):
            spans = sorted({(p[name], getattr(box_of(p["window_mm"]), low),
                             getattr(box_of(p["window_mm"]), high)) for p in pages})
            self.assertEqual([span[0] for span in spans], list(range(1, len(spans) + 1)))
            self.assertLessEqual(spans[0][1], getattr(area, low))
            self.assertGreaterEqual(spans[-1][2], getattr(area, high))
            for before, after in zip(spans, spans[1:]):
                self.assertGreaterEqual(before[2] - after[1], OVERLAP)
        places = {(p["row"], p["column"]) for p in pages}
        self.assertEqual(len(places), len(pages))
        self.assertEqual(len(pages), max(places)[0] * max(places)[1])

    def assert_rulers(self, picture, window):
        right = picture.across(window.x0 - 3.5, window.y0 + 11, window.y0 + 112.5)
        down = picture.down(window.y0 - 3.5, window.x0 + 24, window.x0 + 126)
        for runs, start in ((right, window.y0 + 12), (down, window.x0 + 25)):
            self.assertEqual(len(runs), 11)
            for step, (begin, end) in enumerate(runs):
                self.assertAlmostEqual((begin + end) / 2, start + 10 * step, delta=0.15)

    def assert_tiles(self, product, tile, area, paint):
        path, pages = self.tiles(product, tile)
        self.assert_paper(path, pages, tile)
        self.assert_covered(pages, area)
        words = pdf_text(path)
        for page in pages:
            with self.subTest(product=product, tile=tile, number=page["number"]):
                picture = pdf_picture(path, page, 4)
                window = box_of(page["window_mm"])
                self.assertEqual(differences(picture, common(window, area), paint), [])
                self.assert_rulers(picture, window)
                self.assertIn(f"TILE {page['number']} of {len(pages)}", words)

    def test_the_bar_on_a4(self):
        self.assert_tiles("bar", "a4", print_truth.BAR, print_truth.hope33())

    def test_the_bar_on_a3(self):
        self.assert_tiles("bar", "a3", print_truth.BAR, print_truth.hope33())

    def test_the_evaluation_sheet_on_a3(self):
        self.assert_tiles("evaluation", "a3", print_truth.LINES, print_truth.evaluation())

    def test_the_grid_on_a4_is_covered(self):
        path, pages = self.tiles("grid", "a4")
        self.assert_paper(path, pages, "a4")
        self.assert_covered(pages, print_truth.LINES)

    def test_cut_marks_stand_at_the_joint_and_at_the_neighbours_broken_marks(self):
        # Given the first two tiles of a bar
        path, pages = self.tiles("bar", "a4")
        windows = [box_of(page["window_mm"]) for page in pages]
        first, second = (pdf_picture(path, page, 4) for page in pages[:2])
        joint = windows[1].y0
        # When the margins above the windows are read
        top = windows[1].x0
        solid = second.down(joint, top - 6, top - 1)
        broken = first.down(joint, top - 6, top)
        # Then the second is to be cut there, and the first says where it comes to lie
        self.assertEqual(len(solid), 1)
        self.assertGreaterEqual(solid[0][1] - solid[0][0], 4.5)
        self.assertEqual(len(broken), 3)
        # And the joint runs through a white strip of the bar
        self.assertEqual(second.down(joint + 0.5, -15, 15), [])

    def test_svg_tiles_are_one_file_each(self):
        rows = make(self.folder / "bar.svg", "bar", "--tile", "a3")
        names = [Path(row["file"]).name for row in rows]
        self.assertEqual(names, [f"bar-{n}.svg" for n in range(1, len(rows) + 1)])
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), names)
        for row in rows:
            for found, wanted in zip(sorted(svg_size(row["file"])), PAPER["a3"]):
                self.assertAlmostEqual(found, wanted, delta=0.1)


if __name__ == "__main__":
    unittest.main()
