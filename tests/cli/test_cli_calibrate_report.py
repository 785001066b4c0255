# SPDX-License-Identifier: Apache-2.0
"""opms calibrate --report: a page that stands alone, whose numbers can be traced, or none."""
import html
import json
import os
import re
import shutil
import unittest

from cli_kit import DATA, INPUT, OK, CliTest, opms, png
from report_reader import ReportReader, at_pointer, drawings, leaves, shows

PICTURES = sorted((DATA / "grid").glob("*.png"))


class CalibrateReport(CliTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "camera.yaml.new"
        self.report = self.folder / "report"

    def calibrate(self, *arguments, report=None, **kwargs):
        return opms("calibrate", "--grid", "a0-25", "--json", "--out", self.out, "--report",
                    report or self.report, *arguments, **kwargs)

    def read(self):
        """The page's text, what a strict reader finds, and the document."""
        page = (self.report / "report.html").read_text(encoding="utf-8")
        document = json.loads((self.report / "report.json").read_text(encoding="utf-8"))
        self.assertEqual(sorted(p.name for p in self.report.iterdir()),
                         ["report.html", "report.json"])
        return page, ReportReader(page), document

    def test_the_page_needs_nothing_else_and_is_well_formed(self):
        result = self.calibrate(*PICTURES)
        self.assertEqual(result.returncode, OK, result.stderr)
        page, reader, document = self.read()
        for outside in ("http:", "https:", "//", "url(", "@import", "<script", "<link", "<img"):
            self.assertNotIn(outside, page)
        self.assertEqual([a for a in reader.attributes if a[1] in ("src", "href", "xlink:href")],
                         [])
        pictures = len(PICTURES)
        self.assertGreaterEqual(len(drawings(page)), 2 * pictures + 7)  # bars, residuals, maps
        labels = [d.get("aria-label") for d in drawings(page)]
        for words in ("residuals of all nodes", "mean residuals", "nodes in each part",
                      "distortion", "places of the camera", "expected position error"):
            self.assertTrue(any(words in label for label in labels), words)
        self.assertEqual(document["schema"], "opms.calibrate-report/1")

    def test_every_number_in_a_table_is_that_of_the_document(self):
        self.calibrate(*PICTURES, PICTURES[0])
        _, reader, document = self.read()
        self.assertGreater(len(reader.traced), 150)
        for pointer, factor, text in reader.traced:
            with self.subTest(pointer=pointer):
                self.assertTrue(shows(text, factor * at_pointer(document, pointer)), text)
        known = set(leaves(document))
        for cell in reader.cells:
            words = cell.strip()
            for part in (words, words.partition(" from ")[2], words.partition("opms ")[2]):
                if part in known:
                    words = ""
            for name in re.split(", ", words):  # of options in options
                self.assertTrue(name in known or not re.search(r"\d", name.replace("3-D", "")),
                                cell)

    def test_the_document_is_the_json_output_and_more(self):
        result = self.calibrate(*PICTURES)
        row = json.loads(result.stdout)
        _, _, document = self.read()
        for key, value in row.items():
            with self.subTest(key=key):
                if key == "expected":
                    self.assertEqual(value, {k: document[key][k] for k in value})
                elif key == "pictures":
                    for given, shown in zip(value, document[key]):
                        self.assertEqual(given, {k: shown[k] for k in given})
                elif key != "schema":
                    self.assertEqual(value, document[key])

    def test_the_residuals_of_the_document_make_the_stated_rms(self):
        self.calibrate(*PICTURES)
        _, _, document = self.read()
        for picture in document["pictures"]:
            nodes = picture["nodes"]
            self.assertEqual(len(nodes["px"]), picture["node_count"])
            squares = [u * u + v * v for (u, v), good
                       in zip(nodes["residual_px"], nodes["inlier"]) if good]
            self.assertEqual(len(nodes["px"]) - len(squares), picture["outliers"])
            self.assertAlmostEqual((sum(squares) / len(squares)) ** 0.5,
                                   picture["residual_rms_px"], 4)
        cells = [count for row in document["coverage_cells"] for count in row]
        self.assertAlmostEqual(sum(c > 0 for c in cells) / 64, document["coverage"])

    def test_a_good_lift_is_called_good_and_parts_add_up(self):
        self.calibrate(*PICTURES)
        _, reader, document = self.read()
        self.assertEqual(document["verdict"]["level"], "good")
        self.assertIn(document["verdict"]["headline"], reader.text)
        parts = document["expected"]["parts"]
        for figure in ("position_rms_mm", "rotation_rms_deg"):
            total = sum(parts[p][figure] ** 2 for p in ("image", "lens", "placing")) ** 0.5
            self.assertAlmostEqual(parts["total"][figure], total, 9)
        self.assertLess(parts["lens"]["position_rms_mm"], 0.3)
        self.assertLess(parts["total"]["position_rms_mm"], 5.0)

    def test_a_better_laid_head_is_expected_to_give_better_positions(self):
        figures = []
        for sigma in ("1,0.4", "0.5,0.2", "0,0"):
            self.calibrate("--footprint-sigma", sigma, *PICTURES)
            figures.append(self.read()[2]["expected"]["parts"]["placing"]["position_rms_mm"])
        self.assertAlmostEqual(figures[0] / figures[1], 2.0, 3)
        self.assertLess(figures[2], 1e-3)

    def test_the_same_pictures_make_the_same_bytes(self):
        first, second = self.folder / "first", self.folder / "second"
        for report in (first, second):
            self.assertEqual(self.calibrate(*PICTURES, report=report).returncode, OK)
        for name in ("report.html", "report.json"):
            self.assertEqual((first / name).read_bytes(), (second / name).read_bytes())

    def test_names_of_files_are_shown_and_never_run(self):
        names = ['<script>alert(1)<b>&"\'.png', "\N{BLACK SUN WITH RAYS}.png"]
        copies = [self.folder / name for name in names]
        for copy, picture in zip(copies, PICTURES):
            shutil.copyfile(picture, copy)
        raw = os.fsencode(self.folder) + b"/not\xffutf8.png"
        shutil.copyfile(PICTURES[2], raw)
        result = self.calibrate("--name", "</title><script>x</script>", *copies, os.fsdecode(raw),
                                *PICTURES[3:], errors="surrogateescape")
        self.assertEqual(result.returncode, OK, result.stderr)
        page, reader, _ = self.read()
        self.assertNotIn("<script", page)
        self.assertNotIn("script", reader.tags)
        self.assertIn(html.escape(names[0], quote=True).replace("&#x27;", "&#39;"), page)
        self.assertIn(names[1], reader.text)
        self.assertIn("not\N{REPLACEMENT CHARACTER}utf8.png", reader.text)

    def test_pictures_that_do_for_no_camera_make_a_report_that_says_why(self):
        blank = self.write("large.png", png(1024, 768))
        result = self.calibrate(PICTURES[0], PICTURES[1], blank)
        self.assertEqual(result.returncode, INPUT)
        _, reader, document = self.read()
        self.assertEqual(document["verdict"]["level"], "again")
        self.assertIn("at least 3", document["verdict"]["reasons"][0])
        self.assertIn("no grid is seen", reader.text)
        self.assertIn(str(blank), reader.text)
        self.assertNotIn("lens", document)
        self.assertFalse(self.out.exists())

    def test_a_file_that_is_no_picture_is_named_in_the_report(self):
        text = self.write("text.png", "no picture")
        self.assertEqual(self.calibrate(*PICTURES, text).returncode, INPUT)
        _, reader, document = self.read()
        self.assertIn(f"{text}: is no picture", document["verdict"]["reasons"][0])
        self.assertIn(str(text), reader.text)

    def test_where_no_report_can_be_nothing_is_done(self):
        in_the_way = self.write("taken", "a file")
        folder = self.folder / "full"
        (folder / "report.html").mkdir(parents=True)
        for report in (in_the_way, in_the_way / "below", folder):
            with self.subTest(report=report.name):
                result = self.calibrate(*PICTURES, report=report)
                self.assertEqual(result.returncode, INPUT)
                self.assertIn(str(report), result.stderr)
                self.assertEqual(result.stdout, "")
                self.assertFalse(self.out.exists())
        self.assertEqual(in_the_way.read_text(), "a file")
        self.assertEqual([p.name for p in folder.iterdir()], ["report.html"])

    def test_a_new_report_takes_the_place_of_the_old(self):
        self.report.mkdir()
        for name in ("report.html", "report.json"):
            (self.report / name).write_text("old")
        self.assertEqual(self.calibrate(*PICTURES).returncode, OK)
        page, _, _ = self.read()
        self.assertTrue(page.startswith("<!DOCTYPE html>"))


if __name__ == "__main__":
    unittest.main()
