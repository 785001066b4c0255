# SPDX-License-Identifier: Apache-2.0
"""The scenes of the bench: where the camera is, with the truth that goes with it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench_geometry import Lens, Pose, exp_so3
from bench_truth import Truth

HOPE_LENS = Lens(1024, 768, 585.0, 585.0, 517.3, 379.6, -0.118, 0.031, 0.0011, -0.0007)
TELE_LENS = Lens(1024, 768, 900.0, 900.0, 511.5, 383.5, -0.12, 0.02)
_LOOK = np.radians(25.0)
HOPE_DETECTOR_CAMERA = Pose(np.array([[-np.cos(_LOOK), 0, -np.sin(_LOOK)], [0, 1, 0],
                                      [np.sin(_LOOK), 0, -np.cos(_LOOK)]]),
                            np.array([-0.10, 0.0, 0.40]))
TILT_DEG = 19.3


@dataclass(frozen=True)
class Scene:
    name: str
    title: str
    truths: tuple[Truth, ...]


def axis_rotation(axis: int, angle_rad: float) -> np.ndarray:
    return exp_so3(np.eye(3)[axis] * angle_rad)


def hope_truth(image: Path, head: Pose, tilt_deg: float) -> Truth:
    """The HOPE camera with the head's pose given in ground."""
    ground_bar = Pose(axis_rotation(1, -np.radians(tilt_deg)), np.zeros(3))
    bar_camera = ground_bar.inverse() @ head @ HOPE_DETECTOR_CAMERA
    return Truth(image, HOPE_LENS, bar_camera, ground_bar, HOPE_DETECTOR_CAMERA, head, tilt_deg,
                 None)


def random_head(rng: np.random.Generator, tilt_rad: float = np.radians(3)) -> Pose:
    """Anywhere in the working volume, nearly level."""
    angles = rng.uniform(-tilt_rad, tilt_rad, 3)
    R = axis_rotation(2, angles[2]) @ axis_rotation(1, angles[1]) @ axis_rotation(0, angles[0])
    return Pose(R, rng.uniform((0.15, -0.5, 0.0), (0.55, 0.5, 0.115)))


def tele_truth(image: Path, rng: np.random.Generator) -> Truth:
    """f = 900 px, 40 to 60 cm from the bar, 25 degrees off its normal: tags of 30 to 45 px."""
    pitch = np.radians(25 + rng.uniform(-6, 6))
    yaw, roll = np.radians(rng.uniform(-8, 8)), np.radians(rng.uniform(-10, 10))
    print_bar = np.array([[0, 1.0, 0], [1, 0, 0], [0, 0, -1]])  # print: right, down, away
    R = (axis_rotation(2, roll) @ axis_rotation(0, -pitch) @ axis_rotation(1, yaw)) @ print_bar
    aim = np.array([rng.uniform(-0.05, 0.05), rng.uniform(-0.4, 0.4), 0])
    camera_bar = Pose(R, np.array([0, 0, rng.uniform(0.4, 0.6)]) - R @ aim)
    return Truth(image, TELE_LENS, camera_bar.inverse(), Pose(np.eye(3), np.zeros(3)), None, None,
                 0.0, None)


def make_scenes(folder: Path, count: int, seed: int) -> list[Scene]:
    rng = np.random.default_rng(seed)
    tele = tuple(tele_truth(folder / f"tele_{i:04d}.png", rng) for i in range(count))
    hope = tuple(hope_truth(folder / f"hope_{i:04d}.png", random_head(rng), TILT_DEG)
                 for i in range(count))
    return [Scene("tele", "f = 900 px, 40 to 60 cm, tags of 30 to 45 px", tele),
            Scene("hope", "HOPE camera, whole working volume, bar tilted 19.3 degrees", hope)]


def sweep(folder: Path, count: int, step_m: float) -> Scene:
    """A swing of the HOPE head along the bar, one picture every step_m."""
    ys = -0.3 + (np.arange(count) * step_m) % 0.6
    truths = tuple(hope_truth(folder / f"sweep_{i:04d}.png",
                              Pose(axis_rotation(2, 0.1 * y), np.array([0.35, y, 0.05])),
                              TILT_DEG)
                   for i, y in enumerate(ys))
    return Scene("sweep", "HOPE camera swung along the bar", truths)
