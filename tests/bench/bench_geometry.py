# SPDX-License-Identifier: Apache-2.0
"""Rigid motions, the camera model and the bar's squares, written for the bench alone.

It shares no code with libopms, so that one checks the other. Conventions: docs/conventions.md;
`R_a_b`, `t_a_b` take coordinates in b to coordinates in a.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

SQUARES = 33
PITCH_M = 0.030
HALF_SIDE_M = 0.010
ORIGIN_SQUARE = 16
# (-X,-Y), (+X,-Y), (+X,+Y), (-X,+Y): the order of `corners_px`.
CORNER_SIGNS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)


@dataclass(frozen=True)
class Lens:
    """Pinhole with the four-parameter Seidel model; pixel (0, 0) is a centre."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    @property
    def matrix(self) -> np.ndarray:
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]])

    @property
    def distortion(self) -> np.ndarray:
        return np.array([self.k1, self.k2, self.p1, self.p2, 0.0])


@dataclass(frozen=True)
class Pose:
    """Takes coordinates in b to coordinates in a."""

    R: np.ndarray
    t: np.ndarray

    def inverse(self) -> "Pose":
        return Pose(self.R.T, -self.R.T @ self.t)

    def __matmul__(self, other: "Pose") -> "Pose":
        return Pose(self.R @ other.R, self.R @ other.t + self.t)


def hat(w: np.ndarray) -> np.ndarray:
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def exp_so3(w: np.ndarray) -> np.ndarray:
    angle = float(np.linalg.norm(w))
    if angle < 1e-12:
        return np.eye(3) + hat(w)
    axis = hat(w / angle)
    return np.eye(3) + np.sin(angle) * axis + (1 - np.cos(angle)) * axis @ axis


def log_so3(R: np.ndarray) -> np.ndarray:
    """Rotation vector, through the quaternion (Shepperd), so that it is exact at every angle."""
    m = np.r_[np.trace(R), np.diag(R)]
    k = int(np.argmax(m))
    if k == 0:
        q = np.array([1 + m[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    else:
        i, j, n = k - 1, k % 3, (k + 1) % 3
        q = np.empty(4)
        q[0] = R[n, j] - R[j, n]
        q[1 + i] = 1 + 2 * R[i, i] - m[0]
        q[1 + j] = R[j, i] + R[i, j]
        q[1 + n] = R[n, i] + R[i, n]
    q *= (-1 if q[0] < 0 else 1) / np.linalg.norm(q)
    norm = float(np.linalg.norm(q[1:]))
    return 2 * q[1:] if norm < 1e-12 else 2 * np.arctan2(norm, q[0]) * q[1:] / norm


def pose_error(truth: Pose, found: Pose) -> np.ndarray:
    """(w, d) with R_true = R Exp(w), t_true = t + d: what the stated covariance is about."""
    return np.r_[log_so3(found.R.T @ truth.R), truth.t - found.t]


def distort(lens: Lens, xy: np.ndarray) -> np.ndarray:
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    g = 1 + lens.k1 * r2 + lens.k2 * r2 * r2
    xd = x * g + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x)
    yd = y * g + lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y
    return np.stack([xd, yd], -1)


def radial_slope_positive(lens: Lens, xy: np.ndarray) -> np.ndarray:
    """False beyond the fold of the distortion, where the model mirrors rays back inwards."""
    r2 = (xy * xy).sum(-1)
    if lens.k1 >= 0 and lens.k2 >= 0:
        return np.ones(r2.shape, bool)
    roots = np.roots([5 * lens.k2, 3 * lens.k1, 1.0])
    real = [z.real for z in np.atleast_1d(roots) if abs(z.imag) < 1e-12 and z.real > 0]
    return r2 < (min(real) if real else np.inf)


def project(lens: Lens, bar_camera: Pose, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pixels of points of the bar frame, and whether the camera can see in that direction."""
    p = (points - bar_camera.t) @ bar_camera.R
    z = np.where(p[..., 2:] > 1e-6, p[..., 2:], 1e-6)
    xy = p[..., :2] / z
    with np.errstate(over="ignore", invalid="ignore"):
        px = distort(lens, xy) * (lens.fx, lens.fy) + (lens.cx, lens.cy)
    return px, (p[..., 2] > 1e-6) & radial_slope_positive(lens, xy)


def square_centre_y(index: np.ndarray | int) -> np.ndarray | float:
    return (index - ORIGIN_SQUARE) * PITCH_M


def square_corners() -> np.ndarray:
    """33 x 4 x 3 corners of all squares, in metres."""
    y = square_centre_y(np.arange(SQUARES))
    corners = np.zeros((SQUARES, 4, 3))
    corners[..., :2] = CORNER_SIGNS * HALF_SIDE_M
    corners[..., 1] += y[:, None]
    return corners


def inside(lens: Lens, px: np.ndarray, margin: float) -> np.ndarray:
    return ((px[..., 0] > margin) & (px[..., 0] < lens.width - 1 - margin)
            & (px[..., 1] > margin) & (px[..., 1] < lens.height - 1 - margin))


def rotate_lens(lens: Lens, angle_rad: float, centre: np.ndarray, new_centre: np.ndarray,
                size: tuple[int, int]) -> Lens:
    """The lens of a picture whose pixels were rotated: q' = A (q - centre) + new_centre.

    With fx = fy = f and A a rotation of the plane, turning the camera about its own axis turns
    ray directions by A too. r2 is unchanged, so the radial part commutes with A. The decentring
    part is (m . x) 2 x + r2 m with m = (p2, p1): a vector that turns with x if m turns as well.
    So A D(x; m) = D(A x; A m): the same model with (p2, p1) turned by A and the principal point
    moved. With fx != fy no such model exists.
    """
    if abs(lens.fx - lens.fy) > 1e-9 * lens.fx:
        raise ValueError("a rotated picture has this camera model only where fx = fy")
    A = rotation_2d(angle_rad)
    cx, cy = A @ (np.array([lens.cx, lens.cy]) - centre) + new_centre
    p2, p1 = A @ np.array([lens.p2, lens.p1])
    return replace(lens, width=size[0], height=size[1], cx=cx, cy=cy, p1=p1, p2=p2)


def rotation_2d(angle_rad: float) -> np.ndarray:
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, -s], [s, c]])
