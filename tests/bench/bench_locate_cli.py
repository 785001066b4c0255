# SPDX-License-Identifier: Apache-2.0
"""Runs `opms locate --json` over scenes and compares its answers with the truth."""

from __future__ import annotations

import json
import subprocess
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench_geometry import (HALF_SIDE_M, PITCH_M, Pose, inside, pose_error, project,
                            square_centre_y, square_corners)
from bench_limit import Limit
from bench_truth import Truth

_BATCH = 200  # pictures a call: keeps the command line short


@dataclass
class Row:
    """One picture: what was said of it, and how far that is from the truth."""

    image: str
    state: str
    reason: str = ""
    squares: int = 0
    visible_squares: int = 0
    wrong_labels: int = 0
    camera_error: np.ndarray | None = None    # (w, d), rad and m
    detector_error: np.ndarray | None = None
    camera_covariance: np.ndarray | None = None
    detector_covariance: np.ndarray | None = None
    edge_shift_px: float = float("nan")
    residual_px: float = float("nan")
    time_us: float = float("nan")
    limit: Limit | None = None
    saturated: float = float("nan")
    tilt_deg: float = 0.0

    @property
    def located(self) -> bool:
        return self.detector_error is not None

    @property
    def position_mm(self) -> float:
        return float(np.linalg.norm(self.detector_error[3:])) * 1e3

    @property
    def angle_deg(self) -> float:
        return float(np.degrees(np.linalg.norm(self.detector_error[:3])))


def run_locate(binary: Path, scenes: list[Truth], camera: Path, extra: list[str],
               prefix: list[str] | None = None) -> list[dict]:
    """One answer a scene, in their order. Pictures of one tilt go into one call."""
    groups = defaultdict(list)
    for i, scene in enumerate(scenes):
        groups[scene.tilt_deg].append(i)
    answers: list[dict] = [{}] * len(scenes)
    for tilt, members in groups.items():
        for start in range(0, len(members), _BATCH):
            batch = members[start:start + _BATCH]
            command = [*(prefix or []), str(binary), "locate", "--json", "--camera", str(camera)]
            command += ["--tilt-deg", repr(tilt)] if tilt else []
            command += [*extra, *(str(scenes[i].image) for i in batch)]
            for i, answer in zip(batch, call(command, len(batch))):
                answers[i] = answer
    return answers


def call(command: list[str], count: int) -> list[dict]:
    done = subprocess.run(command, capture_output=True, text=True, timeout=1800)
    rows = [json.loads(line) for line in done.stdout.splitlines() if line.strip()]
    rows = [row for row in rows if str(row.get("schema", "")).startswith("opms.locate/")]
    if len(rows) == count:
        return rows
    reason = f"exit {done.returncode}, {len(rows)} of {count} rows: {done.stderr.strip()[-300:]}"
    return [{"state": "error", "reason": reason}] * count


def compare(scene: Truth, answer: dict, limit: Limit | None, saturated: float) -> Row:
    row = Row(scene.image.name, str(answer.get("state", "error")), str(answer.get("reason", "")),
              limit=limit, saturated=saturated, tilt_deg=scene.tilt_deg)
    row.squares = len(answer.get("squares", []))
    row.visible_squares = int(visible_squares(scene).sum())
    if row.state != "located":
        return row
    row.wrong_labels = count_wrong_labels(scene, answer["squares"])
    found = Pose(np.array(answer["R_bar_camera"], float), np.array(answer["t_bar_camera_m"], float))
    row.camera_error = pose_error(scene.bar_camera, found)
    row.camera_covariance = matrix6(answer.get("covariance"))
    detector = detector_pose(scene, answer, found)
    truth = scene.ground_detector or scene.ground_bar @ scene.bar_camera
    row.detector_error = pose_error(truth, detector)
    row.detector_covariance = matrix6(answer.get("covariance_ground_detector"))
    row.edge_shift_px = float(answer.get("edge_shift_px", "nan"))
    row.residual_px = float(answer.get("residual_px", "nan"))
    row.time_us = float(answer.get("time_us", {}).get("total", "nan"))
    return row


def detector_pose(scene: Truth, answer: dict, found: Pose) -> Pose:
    """As answered; from the camera's pose where the camera file holds no transform."""
    if "t_ground_detector_m" in answer:
        return Pose(np.array(answer["R_ground_detector"], float),
                    np.array(answer["t_ground_detector_m"], float))
    return scene.ground_bar @ found @ scene.camera_detector


def matrix6(values) -> np.ndarray | None:
    if values is None:
        return None
    matrix = np.array(values, float)
    return matrix.reshape(6, 6) if matrix.size == 36 else None


def count_wrong_labels(scene: Truth, squares: list[dict]) -> int:
    """Squares that lie more than half a pitch from where the truth has the square so named."""
    wrong = 0
    corners = square_corners()
    for square in squares:
        index = int(square["index"])
        if not 0 <= index < len(corners):
            wrong += 1
            continue
        px, seen = project(scene.lens, scene.bar_camera, corners[index])
        if not seen.all():
            wrong += 1
            continue
        distance = np.linalg.norm(np.mean(np.array(square["corners_px"], float) - px, axis=0))
        wrong += bool(distance > half_pitch_px(scene, index))
    return wrong


def half_pitch_px(scene: Truth, index: int) -> float:
    y = square_centre_y(index)
    ends = np.array([[0, y - PITCH_M / 2, 0], [0, y + PITCH_M / 2, 0]])
    px, _ = project(scene.lens, scene.bar_camera, ends)
    return float(np.linalg.norm(px[1] - px[0])) / 2


def visible_squares(scene: Truth, margin: float = HALF_SIDE_M) -> np.ndarray:
    """Squares whose four corners lie in the picture (they may still be covered)."""
    px, seen = project(scene.lens, scene.bar_camera, square_corners())
    return (inside(scene.lens, px, 2.0) & seen).all(1)
