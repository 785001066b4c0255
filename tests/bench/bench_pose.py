# SPDX-License-Identifier: Apache-2.0
"""Pose of a bar of tags from their corners: OpenCV's way, and with a common edge shift besides."""

from __future__ import annotations

import cv2
import numpy as np

from bench_geometry import Lens, Pose, exp_so3, project, square_corners

_OUTLIER_PX = 5.0


def solve_corners(lens: Lens, tags: dict[int, np.ndarray]) -> Pose | None:
    """SQPnP, then Levenberg-Marquardt on all corners; grossly wrong tags are left out once."""
    pose = solve_pnp(lens, tags)
    if pose is None:
        return None
    model = square_corners()
    kept = {k: c for k, c in tags.items()
            if np.abs(project(lens, pose, model[k])[0] - c).max() < _OUTLIER_PX}
    return solve_pnp(lens, kept) if len(kept) < len(tags) else pose


def solve_pnp(lens: Lens, tags: dict[int, np.ndarray]) -> Pose | None:
    if len(tags) < 2:
        return None
    objects, corners = stacked(tags)
    arguments = (objects, corners, lens.matrix, lens.distortion)
    try:
        ok, rotation, translation = cv2.solvePnP(*arguments, flags=cv2.SOLVEPNP_SQPNP)
        if not ok:
            return None
        rotation, translation = cv2.solvePnPRefineLM(*arguments, rotation, translation)
    except cv2.error:
        return None
    return Pose(cv2.Rodrigues(rotation)[0], translation.ravel()).inverse()


def stacked(tags: dict[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    model = square_corners()
    return (np.concatenate([model[k] for k in tags]),
            np.ascontiguousarray(np.concatenate([tags[k] for k in tags])))


def solve_with_shift(lens: Lens, tags: dict[int, np.ndarray], start: Pose) -> Pose:
    """The same corners with one more unknown: all edges moved outwards alike, in px.

    Shows how much of a peer's error is the bias that libopms takes out of its own edges."""
    objects, corners = stacked(tags)
    pose, shift = start, 0.0
    for _ in range(8):
        residual = corners - shifted_corners(lens, pose, objects, shift)
        J = np.empty((residual.size, 7))
        for i in range(7):
            step = np.zeros(7)
            step[i] = 1e-6 if i < 6 else 1e-4
            J[:, i] = ((shifted_corners(lens, *moved(pose, shift, step, objects))
                        - shifted_corners(lens, *moved(pose, shift, -step, objects)))
                       / (2 * step[i])).ravel()
        scale = np.linalg.norm(J, axis=0)
        delta = np.linalg.lstsq(J / scale, residual.ravel(), rcond=None)[0] / scale
        pose, _, shift = moved(pose, shift, delta, objects)
    return pose


def moved(pose: Pose, shift: float, delta: np.ndarray, objects: np.ndarray):
    return Pose(pose.R @ exp_so3(delta[:3]), pose.t + delta[3:6]), objects, shift + delta[6]


def shifted_corners(lens: Lens, pose: Pose, objects: np.ndarray, shift: float) -> np.ndarray:
    """Corners where both their edges have moved outwards by shift px."""
    px = project(lens, pose, objects)[0].reshape(-1, 4, 2)
    along = np.roll(px, -1, 1) - px
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    back = np.roll(along, 1, 1)
    sine = np.abs(along[..., 0] * back[..., 1] - along[..., 1] * back[..., 0])[..., None]
    return (px - shift * (along - back) / np.maximum(sine, 0.05)).reshape(-1, 2)
