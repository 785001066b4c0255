# SPDX-License-Identifier: Apache-2.0
"""Cameras and pictures that several tests use."""

import pathlib

import numpy as np
import pytest

import opms

DATA = pathlib.Path(__file__).resolve().parent.parent / "data" / "bar"
SIN25, COS25 = np.sin(np.radians(25.0)), np.cos(np.radians(25.0))


@pytest.fixture
def lens():
    """The HOPE camera's lens."""
    return opms.Lens(
        width_px=1024, height_px=768, fx_px=585.0, fy_px=585.0, cx_px=517.3, cy_px=379.6,
        k1=-0.118, k2=0.031, p1=0.0011, p2=-0.0007,
    )  # fmt: skip


@pytest.fixture
def camera(lens):
    """The HOPE camera on its detector."""
    return opms.Camera(
        lens,
        R_detector_camera=np.array([[-COS25, 0.0, -SIN25], [0.0, 1.0, 0.0], [SIN25, 0.0, -COS25]]),
        t_detector_camera_m=np.array([-0.10, 0.0, 0.40]),
    )


@pytest.fixture
def bar_camera():
    """A view of the middle of the bar: image right is ahead (-X), image down is +Y."""
    R = np.array([[-COS25, 0.0, -SIN25], [0.0, 1.0, 0.0], [SIN25, 0.0, -COS25]])
    return opms.Transform(R, np.array([0.25, 0.02, 0.45]))


@pytest.fixture
def grey():
    """A picture without a bar."""
    return np.full((768, 1024), 128, np.uint8)


def project_bar(lens, bar_camera, points_bar_m):
    """Pixels of points (N, 3) of the bar frame."""
    points_camera = (points_bar_m - bar_camera.t_m) @ bar_camera.R
    return lens.project(points_camera)


def exact_edges(lens, bar_camera, sigma_px=0.02):
    """Edges without noise: three stretches on each side of the squares 8 to 24."""
    rows = []
    for square in range(8, 25):
        y = (square - opms.BAR_ORIGIN) * opms.BAR_PITCH_M
        for side, outward in enumerate([(-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0)]):
            out = np.array(outward)
            along = np.array([-out[1], out[0]])
            for s in (-0.006, 0.0, 0.006):
                bar_m = np.array([0.0, y]) + 0.010 * out + s * along
                trio = np.array([bar_m, bar_m + 1e-5 * along, bar_m + 1e-5 * out])
                px = project_bar(lens, bar_camera, np.column_stack([trio, np.zeros(3)]))
                tangent = px[1] - px[0]
                normal = np.array([-tangent[1], tangent[0]]) / np.hypot(*tangent)
                normal *= np.sign(normal @ (px[2] - px[0]))
                rows.append((square, side, bar_m, px[0], normal, sigma_px, 1.0))
    return np.array(rows, dtype=opms.EDGE_DTYPE)
