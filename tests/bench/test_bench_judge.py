# SPDX-License-Identifier: Apache-2.0
"""The judge itself: that its limit is the known one and that it sees what is wrong."""

from __future__ import annotations

import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench_geometry import (Pose, exp_so3, inside, log_so3, project, rotation_2d,
                            square_corners)
from bench_limit import (STRETCHES, edge_information, image_edges, moved, scene_limit,
                         side_stretches)
from bench_locate_cli import Row, compare
from bench_photometry import measure
from bench_render import Light, digitise, render_clean
from bench_rotations import rotated
from bench_scenes import HOPE_LENS, hope_truth, random_head
from bench_stats import coverage, summarise

LIGHT = Light()
PER_PX = edge_information(150.0, 3.0, 0.75)


def scene(seed: int, tilt_deg: float = 19.3):
    return hope_truth(Path("none.png"), random_head(np.random.default_rng(seed)), tilt_deg)


def perfect_answer(truth, pose=None, shift_index=0) -> dict:
    pose = pose or truth.bar_camera
    px, seen = project(truth.lens, pose, square_corners())
    shown = np.nonzero(inside(truth.lens, px, 2).all(1) & seen.all(1))[0]
    detector = truth.ground_bar @ pose @ truth.camera_detector
    limit = scene_limit(truth, PER_PX)
    return {"state": "located",
            "squares": [{"index": int(k) + shift_index, "corners_px": px[k].tolist()}
                        for k in shown if k + shift_index < 33],
            "R_bar_camera": pose.R.tolist(), "t_bar_camera_m": pose.t.tolist(),
            "R_ground_detector": detector.R.tolist(), "t_ground_detector_m": detector.t.tolist(),
            "covariance": limit.camera.tolist(),
            "covariance_ground_detector": limit.detector.tolist()}


class TestJudge(unittest.TestCase):
    def test_limit_over_the_volume_is_the_one_that_the_targets_state(self):
        for tilt, position_mm, worst_deg in ((0.0, 0.123, 0.021), (19.3, 0.096, 0.014)):
            limits = [scene_limit(hope_truth(Path(), Pose(np.eye(3), np.array(head)), tilt), PER_PX)
                      for head in ((x, y, z) for x in np.linspace(0.15, 0.55, 5)
                                   for y in np.linspace(-0.5, 0.5, 11)
                                   for z in (0, 0.038, 0.077, 0.115))]
            rms = np.sqrt(np.mean([limit.position_mm**2 for limit in limits]))
            self.assertAlmostEqual(rms, position_mm, delta=0.0006)
            worst = np.sqrt(np.mean([limit.worst_angle_deg**2 for limit in limits]))
            self.assertAlmostEqual(worst, worst_deg, delta=0.0006)

    def test_logarithm_undoes_the_exponential_at_every_angle(self):
        rng = np.random.default_rng(1)
        for angle in (0.0, 1e-9, 1e-4, 1.0, 3.0, 3.14159):
            axis = rng.normal(size=3)
            w = axis / np.linalg.norm(axis) * angle
            np.testing.assert_allclose(log_so3(exp_so3(w)), w, atol=1e-9)

    def test_labels_off_by_one_are_seen(self):
        truth = scene(2)
        self.assertEqual(compare(truth, perfect_answer(truth), None, 0.0).wrong_labels, 0)
        off = compare(truth, perfect_answer(truth, shift_index=1), None, 0.0)
        self.assertEqual(off.wrong_labels, off.squares)

    def test_a_true_covariance_covers_and_a_small_one_does_not(self):
        rng = np.random.default_rng(3)
        true, small = [], []
        for seed in range(40):
            truth = scene(seed)
            root = np.linalg.cholesky(scene_limit(truth, PER_PX).camera)
            for _ in range(10):
                found = moved(truth.bar_camera, root @ rng.normal(size=6))
                row = compare(truth, perfect_answer(truth, found), None, 0.0)
                true.append(row)
                small.append(replace(row, camera_covariance=row.camera_covariance / 4,
                                     detector_covariance=row.detector_covariance / 4))
        for which in ("camera", "detector"):
            self.assertAlmostEqual(coverage(true, which)["pose_inside"], 0.95, delta=0.035)
            self.assertAlmostEqual(coverage(true, which)["mean_chi2_6_over_6"], 1, delta=0.1)
            self.assertLess(coverage(small, which)["pose_inside"], 0.6)

    def test_pictures_that_are_not_located_are_counted(self):
        rows = [Row("a", "absent"), compare(scene(4), perfect_answer(scene(4)), None, 0.0)]
        summary = summarise(rows)
        self.assertEqual((summary["pictures"], summary["located"]), (2, 1))

    def test_a_rotated_picture_has_the_rotated_camera_model(self):
        truth = scene(5)
        image = np.zeros((HOPE_LENS.height, HOPE_LENS.width), np.uint8)
        before, _ = project(truth.lens, truth.bar_camera, square_corners())
        for angle in (0, 30, 90, 200, 330):
            turned, picture = rotated(truth, image, angle, Path("none.png"))
            after, _ = project(turned.lens, turned.bar_camera, square_corners())
            A = rotation_2d(np.radians(angle))
            centre = (np.array(image.shape[::-1]) - 1) / 2
            expected = (before - centre) @ A.T + (np.array(picture.shape[::-1]) - 1) / 2
            near = np.abs(before).max(-1) < 4000
            np.testing.assert_allclose(after[near], expected[near], atol=1e-8)

    def test_rendered_edges_lie_where_the_truth_has_them(self):
        stretches = side_stretches()
        # Along the bar: 5 mm of white on one side, all of the square on the other.
        middle = ((np.arange(len(stretches.bar)) % STRETCHES == STRETCHES // 2)
                  & (np.abs(stretches.outward[:, 0]) > 0.5))
        for seed in range(3):
            truth = scene(seed)
            white = np.full((HOPE_LENS.height, HOPE_LENS.width), LIGHT.white, np.float32)
            clean = render_clean("hope33", truth.lens, truth.bar_camera, white, LIGHT)
            edges = image_edges(truth.lens, truth.bar_camera, stretches)
            offsets = [edge_offset(clean, edges.px[i], edges.normal[i])
                       for i in np.nonzero(middle & edges.visible)[0]]
            self.assertLess(abs(np.median(offsets)), 0.008)

    def test_contrast_noise_and_blur_are_measured_as_drawn(self):
        truth = hope_truth(Path(), Pose(np.eye(3), np.array([0.15, 0.0, 0.0])), 19.3)
        ground = np.full((HOPE_LENS.height, HOPE_LENS.width), LIGHT.ground, np.float32)
        clean = render_clean("hope33", truth.lens, truth.bar_camera, ground, LIGHT)
        measured = measure(truth, digitise(clean, LIGHT.noise, np.random.default_rng(1)))
        self.assertAlmostEqual(measured.photometry.contrast, 150, delta=6)
        self.assertAlmostEqual(measured.photometry.noise, 3.0, delta=0.4)
        self.assertAlmostEqual(measured.photometry.blur_px, 0.75, delta=0.12)


def edge_offset(clean: np.ndarray, px: np.ndarray, normal: np.ndarray) -> float:
    """Distance of the half-way grey level from px along the row or column that crosses best."""
    axis = int(np.argmax(np.abs(normal)))
    line = round(float(px[1 - axis]))
    start = int(np.floor(px[axis])) - 2
    values = clean[line, start:start + 6] if axis == 0 else clean[start:start + 6, line]
    level = (LIGHT.white + LIGHT.black) / 2
    cross = next(i for i in range(5) if (values[i] - level) * (values[i + 1] - level) <= 0)
    at = start + cross + (level - values[cross]) / (values[cross + 1] - values[cross])
    found = np.array([at, line] if axis == 0 else [line, at], float)
    return float((found - px) @ normal)


if __name__ == "__main__":
    unittest.main()
