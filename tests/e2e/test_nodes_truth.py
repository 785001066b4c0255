# SPDX-License-Identifier: Apache-2.0
"""opms nodes on path-traced pictures of the grid, judged by their truth."""
import json
import os
import subprocess
import unittest
from pathlib import Path

from grid_truth import node_errors_px, nodes_in_sight, rms

OPMS = os.environ.get("OPMS", "opms")
GRID = Path(__file__).resolve().parents[1] / "data" / "grid"
PITCH_LEAST_PX = 9  # what opms/grid.h promises to find


def nodes_of(*pictures):
    call = [OPMS, "nodes", "--grid", "a0-25", "--json", *map(str, pictures)]
    result = subprocess.run(call, capture_output=True, text=True, timeout=300)
    assert result.returncode == 0, f"exit {result.returncode}: {result.stderr}"
    return [json.loads(line) for line in result.stdout.splitlines()]


class Nodes(unittest.TestCase):
    def test_nodes_lie_where_the_truth_has_them_and_none_is_mislabelled(self):
        pictures = sorted(GRID.glob("*.png"))
        self.assertEqual(len(pictures), 5)
        for picture, row in zip(pictures, nodes_of(*pictures), strict=True):
            with self.subTest(picture=picture.name):
                truth = json.loads(picture.with_suffix(".json").read_text())
                self.assertEqual(row["schema"], "opms.nodes/1")
                self.assertEqual(row["image"], str(picture))
                self.assertEqual(row["state"], "labelled")
                errors = node_errors_px(row, truth)
                print(f"{picture.name}: {len(errors)} nodes of {len(nodes_in_sight(truth, 4))}, "
                      f"{rms(errors):.4f} px RMS, at most {max(errors):.3f} px")
                self.assertLess(rms(errors), 0.03)
                self.assertLess(max(errors), PITCH_LEAST_PX / 2)  # a wrong label is a pitch off

    def test_nodes_are_there_once_and_each_with_a_sigma(self):
        [row] = nodes_of(GRID / "grid_02001.png")
        labels = [tuple(node["label"]) for node in row["nodes"]]
        self.assertEqual(len(labels), len(set(labels)))
        self.assertEqual(len(labels), row["node_count"])
        self.assertIn((50, 50), labels)
        for node in row["nodes"]:
            self.assertGreater(node["sigma_px"], 0)
            self.assertLess(node["sigma_px"], 0.5)

    def test_98_of_100_nodes_in_sight_are_found(self):
        for picture in sorted(GRID.glob("*.png")):
            with self.subTest(picture=picture.name):
                truth = json.loads(picture.with_suffix(".json").read_text())
                seen = set(nodes_in_sight(truth, margin_px=4))
                [row] = nodes_of(picture)
                found = {tuple(node["label"]) for node in row["nodes"]}
                self.assertGreaterEqual(len(found & seen), 0.98 * len(seen))


if __name__ == "__main__":
    unittest.main()
