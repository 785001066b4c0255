# SPDX-License-Identifier: Apache-2.0
"""opms nodes: what it takes, what it refuses, and how it says so."""
import unittest

from cli_kit import DATA, INPUT, OK, USAGE, CliTest, opms, png, rows
from grey_png import grey_pixels, pgm

PICTURE = DATA / "grid" / "grid_02001.png"


def nodes(*arguments):
    return opms("nodes", "--grid", "a0-25", *arguments)


class Nodes(CliTest):
    def test_wrong_use_exits_with_2_and_says_why_on_stderr(self):
        calls = [["nodes"], ["nodes", "--grid", "a0-25"], ["nodes", self.blank],
                 ["nodes", "--grid", "a0-30", self.blank],
                 ["nodes", "--grid", "a0-25", "--white-level", "-1", self.blank]]
        for call in calls:
            with self.subTest(call=call):
                result = opms(*call)
                self.assertEqual(result.returncode, USAGE)
                self.assertEqual(result.stdout, "")
                self.assertNotEqual(result.stderr, "")

    def test_a_picture_without_a_grid_is_absent_and_no_error(self):
        result = nodes("--json", self.blank)
        self.assertEqual(result.returncode, OK)
        self.assertEqual(rows(result), [{"schema": "opms.nodes/1", "image": str(self.blank),
                                         "state": "absent", "node_count": 0, "nodes": []}])

    def test_pictures_of_any_size_are_read_in_one_call(self):
        other = self.write("other.png", png(80, 60, bits=16))
        result = nodes("--json", self.blank, PICTURE, other)
        self.assertEqual(result.returncode, OK)
        self.assertEqual([row["state"] for row in rows(result)], ["absent", "labelled", "absent"])

    def test_a_bad_file_is_named_and_the_others_are_still_done(self):
        text = self.write("text.png", "no picture")
        gone = self.folder / "gone.png"
        tiny = self.write("tiny.png", png(15, 16))
        cut = self.write("cut.png", PICTURE.read_bytes()[:100000])
        claim = self.write("claim.png", png(claim=(60000, 60000)))
        bad = [text, gone, tiny, cut, claim]
        result = nodes("--json", *bad, self.blank)
        self.assertEqual(result.returncode, INPUT)
        self.assertEqual([row["state"] for row in rows(result)], ["error"] * 5 + ["absent"])
        for path, row in zip(bad, rows(result)):
            self.assertNotEqual(row["reason"], "")
            self.assertIn(str(path), result.stderr)

    def test_a_grid_whose_marker_is_out_of_sight_says_so_and_gives_no_labels(self):
        width, _, pixels = grey_pixels(PICTURE.read_bytes())
        cut = self.write("cut.pgm", pgm(width, 300, pixels[:300 * width]))
        result = nodes("--json", cut)
        self.assertEqual(result.returncode, OK)
        [row] = rows(result)
        self.assertEqual((row["state"], row["nodes"]), ("unlabelled", []))
        self.assertGreater(row["node_count"], 100)
        self.assertIn("not its marker", result.stderr)

    def test_the_table_has_one_line_a_picture(self):
        result = nodes(PICTURE, self.blank)
        self.assertEqual(result.returncode, OK)
        heading, labelled, absent = result.stdout.splitlines()
        self.assertIn("nodes", heading)
        self.assertRegex(labelled, r" labelled +8\d\d +34\.\.65 ")
        self.assertRegex(absent, r" absent +0$")


if __name__ == "__main__":
    unittest.main()
