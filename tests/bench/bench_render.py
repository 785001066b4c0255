# SPDX-License-Identifier: Apache-2.0
"""Renders bars of every kind in the same scene, so that all detectors see equal pictures.

Per subpixel (4 x 4 a pixel) the printed pattern is averaged over the subpixel's box in the bar
plane, exactly, by an integral image; the Gaussian blur is applied on the subpixels and the pixel
is their mean. The ground is smooth noise; white noise and rounding come last.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np

from bench_geometry import SQUARES, Lens, Pose, distort, project
from bench_truth import Photometry, Truth, truth_to_json

SUBPIXELS = 4
BAR_X_M, BAR_Y_M = 0.030, 1.000
RIM_PX = 6  # drawn outside the picture, too, for the blur at its border
CELL_M = 0.00025  # divides every cell of hope33 and apriltag33; ArUco cells cover some in part
KINDS = ("hope33", "apriltag33", "aruco33")

HOPE33_CODES = (57, 8, 46, 36, 61, 19, 56, 62, 50, 1, 35, 28, 38, 10, 37, 58, 2, 6, 13, 54, 23,
                22, 53, 24, 33, 47, 55, 44, 14, 3, 17, 49, 5)
# bit -> centre (X, Y - Y_k) in mm of its 4.5 x 5 mm cell
HOPE33_CELLS = {5: (-11.25, 15), 4: (-6.75, 15), 3: (-2.25, 15),
                2: (2.25, -15), 1: (6.75, -15), 0: (11.25, -15)}


@dataclass(frozen=True)
class Light:
    """Grey levels of a scene, its blur with the pixel's own, and its noise."""

    white: float = 190.0
    black: float = 40.0
    ground: float = 110.0
    blur_px: float = 0.75
    noise: float = 3.0

    @property
    def photometry(self) -> Photometry:
        return Photometry(self.white - self.black, self.noise, self.blur_px)

    @property
    def optics_blur_px(self) -> float:
        """blur_px is that of the edges in the picture; the pixel's area makes up for a part."""
        return float(np.sqrt(max(self.blur_px**2 - 1 / 12, 0.0)))


def marker_bits(kind: str, index: int) -> np.ndarray:
    """Black border square of one tag, True where black, upright, one element a cell."""
    if kind == "apriltag33":
        name, cells = cv2.aruco.DICT_APRILTAG_36h11, 8
    else:
        name, cells = cv2.aruco.DICT_4X4_50, 6
    marker = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(name), index, cells)
    # OpenCV's AprilTag markers stand on their heads: libapriltag says which way is up.
    return marker[::-1, ::-1] < 128 if kind == "apriltag33" else marker < 128


def rectangle(pattern: np.ndarray, x_mm: float, y_mm: float, size_x: float, size_y: float) -> None:
    """Blacken a rectangle given by its centre in bar coordinates."""
    mm = CELL_M * 1e3
    x0, y0 = (x_mm + BAR_X_M * 500 - size_x / 2) / mm, (y_mm + BAR_Y_M * 500 - size_y / 2) / mm
    pattern[round(x0):round(x0 + size_x / mm), round(y0):round(y0 + size_y / mm)] = 1.0


@lru_cache(maxsize=None)
def pattern_of(kind: str) -> np.ndarray:
    """The pattern's black in cells of CELL_M: rows along X, columns along Y."""
    pattern = np.zeros((round(BAR_X_M / CELL_M), round(BAR_Y_M / CELL_M)))
    for k in range(SQUARES):
        y = (k - 16) * 30.0
        if kind == "hope33":
            rectangle(pattern, 0, y, 20, 20)
            for bit, (cx, dy) in HOPE33_CELLS.items():
                if HOPE33_CODES[k] >> bit & 1:
                    rectangle(pattern, cx, y + dy, 4.5, 5)
            continue
        bits = marker_bits(kind, k)
        cell = 20.0 / len(bits)
        for row, column in zip(*np.nonzero(bits)):
            rectangle_exact(pattern, -10 + row * cell, y - 10 + column * cell, cell)
    return pattern


@lru_cache(maxsize=None)
def integral_of(kind: str) -> np.ndarray:
    """Integral (in cells) of the pattern's black."""
    pattern = pattern_of(kind)
    integral = np.zeros((pattern.shape[0] + 1, pattern.shape[1] + 1))
    integral[1:, 1:] = pattern.cumsum(0).cumsum(1)
    return integral


def rectangle_exact(pattern: np.ndarray, x_mm: float, y_mm: float, size: float) -> None:
    """A cell from its corner, its border cells of the pattern covered in part where needed."""
    mm = CELL_M * 1e3
    spans = []
    for start, count in ((x_mm + BAR_X_M * 500, pattern.shape[0]),
                         (y_mm + BAR_Y_M * 500, pattern.shape[1])):
        edges = np.arange(count)
        spans.append(np.clip(np.minimum(edges + 1, (start + size) / mm)
                             - np.maximum(edges, start / mm), 0, 1))
    rows, columns = (np.nonzero(s)[0] for s in spans)
    area = np.ix_(range(rows[0], rows[-1] + 1), range(columns[0], columns[-1] + 1))
    pattern[area] += np.outer(spans[0][rows], spans[1][columns])


@lru_cache(maxsize=4)
def pixel_rays(lens: Lens) -> np.ndarray:
    """Normalised coordinates of all pixel centres and of a rim around, by Newton's method."""
    rim = RIM_PX + 2
    u, v = np.meshgrid(np.arange(-rim, lens.width + rim), np.arange(-rim, lens.height + rim))
    target = np.stack([(u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy], -1)
    xy = target.copy()
    h = 1e-6
    for _ in range(12):
        residual = target - distort(lens, xy)
        dx = (distort(lens, xy + (h, 0)) - distort(lens, xy - (h, 0))) / (2 * h)
        dy = (distort(lens, xy + (0, h)) - distort(lens, xy - (0, h))) / (2 * h)
        det = dx[..., 0] * dy[..., 1] - dx[..., 1] * dy[..., 0]
        xy = xy + np.stack([
            (dy[..., 1] * residual[..., 0] - dy[..., 0] * residual[..., 1]) / det,
            (dx[..., 0] * residual[..., 1] - dx[..., 1] * residual[..., 0]) / det], -1)
    return xy


def box_average(integral: np.ndarray, x: np.ndarray, y: np.ndarray, half_x, half_y) -> tuple:
    """Black and covered part of boxes in the bar plane (cells); outside the bar is neither."""
    rows, columns = integral.shape[0] - 1, integral.shape[1] - 1
    x0, x1 = np.clip(x - half_x, 0, rows), np.clip(x + half_x, 0, rows)
    y0, y1 = np.clip(y - half_y, 0, columns), np.clip(y + half_y, 0, columns)
    area = 4 * half_x * half_y
    black = (lookup(integral, x1, y1) - lookup(integral, x0, y1)
             - lookup(integral, x1, y0) + lookup(integral, x0, y0)) / area
    return black, (x1 - x0) * (y1 - y0) / area


def lookup(integral: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    i = np.minimum(x.astype(int), integral.shape[0] - 2)
    j = np.minimum(y.astype(int), integral.shape[1] - 2)
    a, b = x - i, y - j
    return ((1 - a) * ((1 - b) * integral[i, j] + b * integral[i, j + 1])
            + a * ((1 - b) * integral[i + 1, j] + b * integral[i + 1, j + 1]))


def bar_window(lens: Lens, bar_camera: Pose) -> tuple[int, int, int, int] | None:
    """Pixels that the bar may touch, with room for the blur, rim included: x0, x1, y0, y1."""
    y = np.linspace(-BAR_Y_M / 2, BAR_Y_M / 2, 201)
    outline = np.concatenate([np.stack([np.full(201, s * BAR_X_M / 2), y, np.zeros(201)], 1)
                              for s in (-1, 1)])
    px, seen = project(lens, bar_camera, outline)
    near = seen & (np.abs(px - (lens.width / 2, lens.height / 2))
                   < (1.5 * lens.width, 1.5 * lens.height)).all(1)
    if not near.any():
        return None
    low, high = px[near].min(0) - 8, px[near].max(0) + 9
    x0, y0 = np.maximum(np.floor(low), -RIM_PX).astype(int)
    x1, y1 = np.minimum(np.ceil(high), (lens.width + RIM_PX, lens.height + RIM_PX)).astype(int)
    return (x0, x1, y0, y1) if x1 > x0 and y1 > y0 else None


def subpixel_rays(lens: Lens, window: tuple[int, int, int, int]) -> np.ndarray:
    """Rays of the subpixels; between pixel centres they are straight to 1e-4 px."""
    x0, x1, y0, y1 = window
    rays = pixel_rays(lens)[y0 + RIM_PX:y1 + RIM_PX + 4, x0 + RIM_PX:x1 + RIM_PX + 4]
    size = ((x1 - x0 + 4) * SUBPIXELS, (y1 - y0 + 4) * SUBPIXELS)
    fine = np.stack([cv2.resize(np.ascontiguousarray(rays[..., i]), size,
                                interpolation=cv2.INTER_LINEAR) for i in range(2)], -1)
    edge = 2 * SUBPIXELS
    return fine[edge - 1:-edge + 1, edge - 1:-edge + 1]  # one subpixel around


def bar_plane(rays: np.ndarray, bar_camera: Pose) -> tuple[np.ndarray, np.ndarray]:
    """Bar coordinates in cells where rays meet the bar's plane; behind the camera far away."""
    d = np.concatenate([rays, np.ones(rays.shape[:-1] + (1,))], -1) @ bar_camera.R.T
    s = -bar_camera.t[2] / np.where(np.abs(d[..., 2]) > 1e-9, d[..., 2], 1e-9)
    s = np.where(s > 0, s, 1e6)
    x = (bar_camera.t[0] + s * d[..., 0] + BAR_X_M / 2) / CELL_M
    y = (bar_camera.t[1] + s * d[..., 1] + BAR_Y_M / 2) / CELL_M
    return x, y


def render_clean(kind: str, lens: Lens, bar_camera: Pose, ground: np.ndarray,
                 light: Light) -> np.ndarray:
    """The picture before noise and rounding."""
    window = bar_window(lens, bar_camera)
    if window is None or bar_camera.t[2] <= 0:
        return ground.astype(np.float32)
    x0, x1, y0, y1 = window
    rimmed = np.pad(ground.astype(np.float32), RIM_PX, mode="edge")
    part = np.s_[y0 + RIM_PX:y1 + RIM_PX, x0 + RIM_PX:x1 + RIM_PX]
    x, y = bar_plane(subpixel_rays(lens, window), bar_camera)
    half_x = (np.abs(x[1:-1, 2:] - x[1:-1, :-2]) + np.abs(x[2:, 1:-1] - x[:-2, 1:-1])) / 4
    half_y = (np.abs(y[1:-1, 2:] - y[1:-1, :-2]) + np.abs(y[2:, 1:-1] - y[:-2, 1:-1])) / 4
    x, y = x[1:-1, 1:-1], y[1:-1, 1:-1]
    fine = np.repeat(np.repeat(rimmed[part], SUBPIXELS, 0), SUBPIXELS, 1)
    integral = integral_of(kind)
    rows, columns = integral.shape[0] - 1, integral.shape[1] - 1
    touched = ((x > -half_x) & (x < rows + half_x) & (y > -half_y) & (y < columns + half_y)
               & (half_x > 0) & (half_y > 0))
    black, covered = box_average(integral, x[touched], y[touched], half_x[touched],
                                 half_y[touched])
    fine[touched] = (light.white * covered - (light.white - light.black) * black
                     + fine[touched] * (1 - covered))
    if light.optics_blur_px > 0:
        fine = cv2.GaussianBlur(fine, (0, 0), light.optics_blur_px * SUBPIXELS)
    rimmed[part] = fine.reshape(y1 - y0, SUBPIXELS, x1 - x0, SUBPIXELS).mean((1, 3))
    return rimmed[RIM_PX:-RIM_PX, RIM_PX:-RIM_PX].copy()


def smooth_ground(lens: Lens, rng: np.random.Generator, light: Light) -> np.ndarray:
    """Soil without structure of its own size: smooth noise of several scales."""
    ground = np.full((lens.height, lens.width), light.ground, np.float32)
    for scale, amplitude in ((4, 6), (8, 8), (24, 9), (90, 10)):
        coarse = rng.standard_normal((lens.height // scale + 3, lens.width // scale + 3))
        ground += amplitude * cv2.resize(coarse.astype(np.float32), (lens.width, lens.height),
                                         interpolation=cv2.INTER_CUBIC)
    return ground


def digitise(clean: np.ndarray, noise: float, rng: np.random.Generator) -> np.ndarray:
    noisy = clean + noise * rng.standard_normal(clean.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def write_scene(truth: Truth, picture: np.ndarray, light: Light) -> None:
    """NAME.png and NAME.json; truth.image says where."""
    cv2.imwrite(str(truth.image), picture)
    stated = {"render": {"contrast": light.photometry.contrast, "noise": light.noise,
                         "blur_px": light.blur_px}}
    Path(truth.image).with_suffix(".json").write_text(
        json.dumps(truth_to_json(truth, stated), indent=1))
