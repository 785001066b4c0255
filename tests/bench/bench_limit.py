# SPDX-License-Identifier: Apache-2.0
"""The Cramer-Rao limit of a scene: what no detector that uses the squares' sides can beat.

A straight edge of contrast A grey levels, noise s and Gaussian blur b px gives, per px of its
length, an information of A^2 / (s^2 2 b sqrt(pi)) on its offset along its normal. That is summed
over the visible sides of all squares through the Jacobian of the pose (w, d), with a common
outward shift of all edges as a seventh unknown. The tenth of a side next to each corner is left
out: there the two edges' blurs overlap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench_geometry import (HALF_SIDE_M, SQUARES, Lens, Pose, exp_so3, hat, inside, project,
                            square_centre_y)
from bench_truth import Truth

STRETCHES = 9
USED_PART = 0.8
BORDER_PX = 4.0
_STEP = 1e-6


@dataclass(frozen=True)
class Stretches:
    """Points in the middle of short stretches of all sides, with their outward normals."""

    bar: np.ndarray      # N x 3, m
    outward: np.ndarray  # N x 3, unit, in the bar plane
    side_m: float


@dataclass(frozen=True)
class Limit:
    """Standard deviations that the limit allows; covariances are of (w, d)."""

    camera: np.ndarray
    detector: np.ndarray

    @property
    def position_mm(self) -> float:
        return float(np.sqrt(np.trace(self.detector[3:, 3:]))) * 1e3

    @property
    def angle_deg(self) -> float:
        return float(np.degrees(np.sqrt(np.trace(self.detector[:3, :3]))))

    @property
    def worst_angle_deg(self) -> float:
        return float(np.degrees(np.sqrt(np.diag(self.camera)[:3].max())))


def side_stretches(squares: int = SQUARES, half_side_m: float = HALF_SIDE_M) -> Stretches:
    along = (np.arange(STRETCHES) / (STRETCHES - 1) * 2 - 1) * USED_PART * half_side_m
    points, normals = [], []
    for k in range(squares):
        centre = np.array([0, square_centre_y(k), 0])
        for n in ((-1, 0, 0), (0, -1, 0), (1, 0, 0), (0, 1, 0)):
            n = np.array(n, float)
            points.append(centre + n * half_side_m + along[:, None] * np.array([n[1], n[0], 0]))
            normals.append(np.repeat(n[None], STRETCHES, 0))
    return Stretches(np.concatenate(points), np.concatenate(normals), 2 * half_side_m)


@dataclass(frozen=True)
class ImageEdges:
    """The stretches as a camera sees them."""

    px: np.ndarray       # N x 2
    normal: np.ndarray   # N x 2, unit, outward
    length_px: np.ndarray
    visible: np.ndarray


def image_edges(lens: Lens, bar_camera: Pose, stretches: Stretches) -> ImageEdges:
    along = np.stack([-stretches.outward[:, 1], stretches.outward[:, 0],
                      stretches.outward[:, 2]], 1)
    px, seen = project(lens, bar_camera, stretches.bar)
    ahead, _ = project(lens, bar_camera, stretches.bar + along * _STEP)
    behind, _ = project(lens, bar_camera, stretches.bar - along * _STEP)
    outer, _ = project(lens, bar_camera, stretches.bar + stretches.outward * _STEP)
    tangent = (ahead - behind) / (2 * _STEP)
    speed = np.maximum(np.linalg.norm(tangent, axis=1), 1e-12)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], 1) / speed[:, None]
    normal *= np.where(((outer - px) * normal).sum(1) < 0, -1.0, 1.0)[:, None]
    length = speed * stretches.side_m * USED_PART / STRETCHES
    # A bar seen from behind is no bar.
    facing = bar_camera.t[2] > 0
    return ImageEdges(px, normal, length, seen & inside(lens, px, BORDER_PX) & facing)


def pose_jacobian(lens: Lens, bar_camera: Pose, stretches: Stretches,
                  edges: ImageEdges) -> np.ndarray:
    """N x 7: the edge's shift along its normal for (w, d) and for the common edge shift."""
    J = np.ones((len(stretches.bar), 7))
    for i in range(6):
        delta = np.zeros(6)
        delta[i] = _STEP
        plus, _ = project(lens, moved(bar_camera, delta), stretches.bar)
        minus, _ = project(lens, moved(bar_camera, -delta), stretches.bar)
        J[:, i] = ((plus - minus) / (2 * _STEP) * edges.normal).sum(1)
    return J


def moved(pose: Pose, delta: np.ndarray) -> Pose:
    return Pose(pose.R @ exp_so3(delta[:3]), pose.t + delta[3:])


def edge_information(contrast, noise, blur_px):
    """Per px of length, on the offset along the normal."""
    return contrast**2 / (noise**2 * 2 * blur_px * np.sqrt(np.pi))


def to_detector(covariance: np.ndarray, truth: Truth) -> np.ndarray:
    """Covariance of the detector's pose in ground from that of the camera's pose in bar.

    R_ground_detector = R_ground_bar R Exp(w) R_camera_detector, so that the detector's w is
    R_detector_camera w; its d is R_ground_bar (d - R [t_camera_detector]x w)."""
    cd = truth.camera_detector
    G = np.zeros((6, 6))
    G[:3, :3] = cd.R.T
    G[3:, :3] = -truth.ground_bar.R @ truth.bar_camera.R @ hat(cd.t)
    G[3:, 3:] = truth.ground_bar.R
    return G @ covariance @ G.T


def scene_limit(truth: Truth, per_px: np.ndarray, visible: np.ndarray | None = None,
                stretches: Stretches | None = None) -> Limit | None:
    """Limit of one scene; None where the visible edges do not determine a pose.

    per_px is the information a px of edge holds, one number or one a stretch."""
    stretches = stretches or side_stretches()
    edges = image_edges(truth.lens, truth.bar_camera, stretches)
    used = edges.visible if visible is None else edges.visible & visible
    J = pose_jacobian(truth.lens, truth.bar_camera, stretches, edges)[used]
    weight = (edges.length_px * per_px)[used]
    information = (J * weight[:, None]).T @ J
    scale = np.sqrt(np.maximum(np.diag(information), 1e-30))
    normalised = information / np.outer(scale, scale)
    if used.sum() < 8 or np.linalg.cond(normalised) > 1e12:
        return None
    camera = (np.linalg.inv(normalised) / np.outer(scale, scale))[:6, :6]
    return Limit(camera, to_detector(camera, truth))
