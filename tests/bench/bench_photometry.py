# SPDX-License-Identifier: Apache-2.0
"""Contrast, noise and blur of a picture whose truth is known, and which edges can be seen.

Where the renderer states them they are taken from there. Else they are measured along the true
edges: contrast for each stretch (an occluded stretch has little), blur by fitting a blurred step
to the raw pixels near the edges, noise from the second differences inside squares and margins.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from bench_geometry import Lens
from bench_limit import ImageEdges, Stretches, edge_information, image_edges, side_stretches
from bench_truth import Photometry, Truth

# White that is surely beside a square: 5 mm along X; 2.5 mm to the code cells along Y.
_MARGIN_X_M, _MARGIN_Y_M = 0.005, 0.0025
_LEAST_CONTRAST = 0.45   # of the median; less is occluded, shadowed or lost
_REACH_PX = 3.0
_SAMPLES = 25

_ndtr = np.vectorize(lambda z: 0.5 * math.erfc(-z / math.sqrt(2)), otypes=[float])


@dataclass(frozen=True)
class Measured:
    photometry: Photometry
    per_px: np.ndarray   # information a px of each stretch
    visible: np.ndarray
    saturated: float     # part of the white beside the edges at the top grey level


def measure(truth: Truth, image: np.ndarray) -> Measured:
    stretches = side_stretches()
    edges = image_edges(truth.lens, truth.bar_camera, stretches)
    if truth.photometry is not None:
        p = truth.photometry
        per_px = np.full(len(edges.px), edge_information(p.contrast, p.noise, p.blur_px))
        return Measured(p, per_px, edges.visible, 0.0)
    grey = image.astype(np.float32)
    reach = margin_px(truth.lens, truth, stretches, edges)
    black = sample(grey, edges.px - edges.normal * _REACH_PX)
    white = sample(grey, edges.px + edges.normal * (0.7 * reach)[:, None])
    contrast = np.where(edges.visible, white - black, 0.0)
    typical = float(np.median(contrast[edges.visible])) if edges.visible.any() else 0.0
    visible = edges.visible & (contrast > _LEAST_CONTRAST * typical)
    blur = edge_blur(grey, edges, visible, black, contrast, reach)
    noise = pixel_noise(grey, edges, visible, reach)
    per_px = edge_information(np.maximum(contrast, 0.0), noise, blur)
    top = float(grey.max())
    saturated = float(np.mean(white[visible] >= top - 0.5)) if top >= 250 and visible.any() else 0
    return Measured(Photometry(typical, noise, blur), per_px, visible, saturated)


def margin_px(lens: Lens, truth: Truth, stretches: Stretches, edges: ImageEdges) -> np.ndarray:
    """How far outside the edge the paper is white for certain, at most _REACH_PX."""
    along_x = np.abs(stretches.outward[:, 0]) > 0.5
    width = np.where(along_x, _MARGIN_X_M, _MARGIN_Y_M)
    outer = Stretches(stretches.bar + stretches.outward * width[:, None], stretches.outward,
                      stretches.side_m)
    far = image_edges(lens, truth.bar_camera, outer).px
    return np.clip(((far - edges.px) * edges.normal).sum(1), 0.3, _REACH_PX)


def sample(grey: np.ndarray, px: np.ndarray) -> np.ndarray:
    p = np.atleast_3d(px).astype(np.float32).reshape(-1, 1, 2)
    values = cv2.remap(grey, p, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return values.reshape(px.shape[:-1])


def edge_blur(grey, edges: ImageEdges, visible, black, contrast, reach) -> float:
    """Width of the erf that fits the pixels nearest to the edges, at their own places."""
    offsets = np.linspace(-_REACH_PX, _REACH_PX, _SAMPLES)
    px = np.rint(edges.px[:, None] + edges.normal[:, None] * offsets[None, :, None])
    distance = ((px - edges.px[:, None]) * edges.normal[:, None]).sum(2)
    value = grey[np.clip(px[..., 1], 0, grey.shape[0] - 1).astype(int),
                 np.clip(px[..., 0], 0, grey.shape[1] - 1).astype(int)]
    with np.errstate(divide="ignore", invalid="ignore"):
        level = (value - black[:, None]) / contrast[:, None]
    near = visible[:, None] & (distance > -_REACH_PX) & (distance < 0.8 * reach[:, None])
    d, y = distance[near], level[near]
    if len(d) < 100:
        return 1.0
    best = min(((fit_cost(d, y, shift, blur), blur) for blur in np.arange(0.3, 2.51, 0.05)
                for shift in np.arange(-0.6, 0.61, 0.1)))
    return float(best[1])


def fit_cost(d: np.ndarray, y: np.ndarray, shift: float, blur: float) -> float:
    grid = np.linspace(-6, 6, 481)
    model = np.interp((d - shift) / blur, grid, _NDTR_GRID)
    return float(np.mean(np.minimum((y - model) ** 2, 0.04)))


_NDTR_GRID = _ndtr(np.linspace(-6, 6, 481))


def pixel_noise(grey, edges: ImageEdges, visible, reach) -> float:
    """Noise at an edge: half way between that of the black and that of the white beside it.

    A second difference along the edge does not see the slow change of light, nor the edge."""
    tangent = np.stack([-edges.normal[:, 1], edges.normal[:, 0]], 1)
    steps = np.where(np.abs(tangent[:, :1]) > np.abs(tangent[:, 1:]),
                     [[1.0, 0.0]], [[0.0, 1.0]])
    variances = []
    for offset in (np.full(len(reach), -_REACH_PX), reach):
        far_enough = visible & (np.abs(offset) >= 2.2)
        if far_enough.sum() < 30:
            continue
        at = np.rint(edges.px + edges.normal * offset[:, None])[far_enough]
        step = steps[far_enough]
        second = (sample(grey, at - step) - 2 * sample(grey, at) + sample(grey, at + step))
        if offset[0] > 0 and np.mean(sample(grey, at) >= 254.5) > 0.1:
            continue  # saturated white has no noise left to measure
        variances.append(robust_variance(second) / 6)
    # Rounding to whole grey levels alone is 1/12.
    return float(np.sqrt(max(np.mean(variances), 1 / 12))) if variances else 1.0


def robust_variance(values: np.ndarray) -> float:
    """Variance about 0 without the tails; the median alone is too coarse on whole grey levels."""
    spread = 1.4826 * float(np.median(np.abs(values))) + 0.5
    kept = values[np.abs(values) < 3 * spread]
    return float(np.mean(kept**2)) if len(kept) else spread**2
