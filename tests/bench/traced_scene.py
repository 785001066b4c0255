# SPDX-License-Identifier: Apache-2.0
"""What the path tracer sees: the bar on its beam, soil, grass, the detector's head, sun and sky.

To be imported after Mitsuba's variant is set. World coordinates are those of `ground`, in m.
"""

from __future__ import annotations

import cv2
import mitsuba as mi
import numpy as np

from bench_geometry import Pose
from bench_render import BAR_X_M, BAR_Y_M, pattern_of
from bench_scenes import axis_rotation

WHITE, BLACK = 0.85, 0.04  # part of the light that print throws back
BEAM_M = 0.008
SOIL_CELLS, SOIL_SIZE_M = 1024, 3.2
HEAD_RADIUS_M, HEAD_HEIGHT_M, ARM_RADIUS_M = 0.1, 0.03, 0.015
BLADES_FROM, BLADES_TO = 200, 2200
GRASS_M = ((-0.5, -0.9), (0.9, 0.9))  # corners of where it grows, X and Y

Transform = mi.ScalarTransform4f


def placed(pose: Pose) -> Transform:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = pose.R, pose.t
    return Transform(matrix)


def diffuse(reflectance, twosided: bool = False) -> dict:
    plain = {"type": "diffuse", "reflectance": reflectance}
    return {"type": "twosided", "inner": plain} if twosided else plain


def texture(levels: np.ndarray, **options) -> dict:
    bitmap = mi.Bitmap(np.ascontiguousarray(levels[:, :, None], np.float32))
    return {"type": "bitmap", "bitmap": bitmap, "raw": True, **options}


def bar(ground_bar: Pose) -> dict:
    """The print is a texture whose cells divide the pattern's exactly, taken without a filter."""
    levels = WHITE + (BLACK - WHITE) * pattern_of("hope33")
    # A rectangle spans -1..1; the texture's columns run along its first axis, its rows against
    # the second.
    print_of = np.array([[0, -BAR_X_M / 2, 0, 0], [BAR_Y_M / 2, 0, 0, 0],
                         [0, 0, 1, 0], [0, 0, 0, 1.0]])
    half = [BAR_X_M / 2, BAR_Y_M / 2, BEAM_M / 2]
    below = Transform().translate([0, 0, -BEAM_M / 2 - 5e-5])
    face = texture(levels[::-1], filter_type="nearest", wrap_mode="clamp")
    return {
        "print": {"type": "rectangle", "to_world": placed(ground_bar) @ Transform(print_of),
                  "bsdf": diffuse(face)},
        "beam": {"type": "cube", "bsdf": diffuse(WHITE),
                 "to_world": placed(ground_bar) @ below @ Transform().scale(half)}}


def soil(rng: np.random.Generator, height_m: float) -> dict:
    levels = np.zeros((SOIL_CELLS, SOIL_CELLS), np.float32)
    for size in (1, 2, 4, 9, 30):
        noise = rng.standard_normal(levels.shape, np.float32)
        noise = cv2.GaussianBlur(noise, (0, 0), size)
        levels += rng.uniform(0.3, 1.0) * noise / noise.std()
    levels = 1 + rng.uniform(0.1, 0.4) * levels / levels.std()
    levels = np.clip(rng.uniform(0.1, 0.4) * levels, 0.02, 0.9)
    half = SOIL_SIZE_M / 2
    return {"soil": {"type": "rectangle", "bsdf": diffuse(texture(levels)),
                     "to_world": Transform().translate([0.2, 0, height_m])
                     @ Transform().scale([half, half, 1])}}


def blade(rng: np.random.Generator, height_m: float) -> np.ndarray:
    """Two pairs of points and a tip: a blade bends once, downwards."""
    (x0, y0), (x1, y1) = GRASS_M
    foot = np.array([rng.uniform(x0, x1), rng.uniform(y0, y1), height_m])
    length, width = rng.uniform(0.01, 0.08), rng.uniform(0.0006, 0.002)
    heading, rise = rng.uniform(0, 2 * np.pi), np.radians(rng.uniform(10, 80))
    points = [foot]
    for turn, fall in ((0.0, 0.0), (0.2, np.radians(rng.uniform(0, 70)))):
        out = np.array([np.cos(heading + turn), np.sin(heading + turn), 0]) * np.cos(rise - fall)
        points.append(points[-1] + (out + [0, 0, np.sin(rise - fall)]) * length / 2)
    side = np.array([-np.sin(heading), np.cos(heading), 0]) * width
    foot, bend, tip = points
    return np.array([foot - side, foot + side, bend - 0.8 * side, bend + 0.8 * side, tip])


def grass(rng: np.random.Generator, height_m: float) -> dict:
    blades = rng.integers(BLADES_FROM, BLADES_TO)
    points = np.concatenate([blade(rng, height_m) for _ in range(blades)])
    faces = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4]])
    faces = np.concatenate([faces + 5 * i for i in range(blades)])
    look = mi.Properties()
    look["bsdf"] = mi.load_dict(diffuse(float(rng.uniform(0.03, 0.25)), twosided=True))
    mesh = mi.Mesh("grass", len(points), len(faces), props=look)
    values = mi.traverse(mesh)
    values["vertex_positions"] = points.ravel().astype(np.float32)
    values["faces"] = faces.ravel().astype(np.uint32)
    values.update()
    return {"grass": mesh}


def head(ground_detector: Pose) -> dict:
    """A disc, its rim and the arm that the camera is on."""
    def at(*point) -> list:
        return (ground_detector.R @ np.array(point) + ground_detector.t).tolist()

    top = Pose(ground_detector.R, np.array(at(0, 0, HEAD_HEIGHT_M)))
    dark = diffuse(0.06, twosided=True)
    return {
        "head": {"type": "disk", "bsdf": dark,
                 "to_world": placed(top) @ Transform().scale([HEAD_RADIUS_M, HEAD_RADIUS_M, 1])},
        "rim": {"type": "cylinder", "p0": at(0, 0, 0), "p1": at(0, 0, HEAD_HEIGHT_M),
                "radius": HEAD_RADIUS_M, "bsdf": dark},
        "arm": {"type": "cylinder", "p0": at(0, 0, HEAD_HEIGHT_M), "p1": at(0.35, 0, 0.6),
                "radius": ARM_RADIUS_M, "bsdf": diffuse(0.1, twosided=True)}}


def light(rng: np.random.Generator, bar_normal: np.ndarray) -> tuple[dict, float]:
    """Sun and sky, and what the bar's white sends back where the sun is not in its way."""
    towards = np.array([*rng.uniform(-1, 1, 2), -rng.uniform(0.5, 2.0)])
    towards /= np.linalg.norm(towards)
    sky, sun = rng.uniform(0.15, 0.8), rng.uniform(0.3, 3.0)
    upon = np.pi * sky + sun * max(0.0, float(-bar_normal @ towards))
    lights = {"sky": {"type": "constant", "radiance": float(sky)},
              "sun": {"type": "directional", "direction": towards.tolist(),
                      "irradiance": float(sun)}}
    return lights, WHITE / np.pi * upon


def field(rng: np.random.Generator, ground_bar: Pose, ground_detector: Pose,
          tilt_rad: float) -> tuple[dict, float]:
    """Entries of a Mitsuba scene, all but the sensor, and the radiance of the bar's white."""
    # The beam's lower edge stays above the soil.
    height_m = -(BEAM_M + 0.004 + BAR_X_M / 2 * np.sin(tilt_rad))
    lights, white = light(rng, ground_bar.R[:, 2])
    return {**bar(ground_bar), **soil(rng, height_m), **grass(rng, height_m),
            **head(ground_detector), **lights}, white
