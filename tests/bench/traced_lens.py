# SPDX-License-Identifier: Apache-2.0
"""The camera of the path tracer: the lens of docs/conventions.md, blurring, and moving while open.

To be imported after Mitsuba's variant is set: its types depend on it.
"""

from __future__ import annotations

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np

from bench_geometry import Lens, Pose

UNDISTORTING_STEPS = 30


class TracedLens(mi.Sensor):
    """A pinhole with Seidel distortion and a Gaussian blur, each ray at an instant of its own.

    Blur and instant are drawn for each ray. A filter of the film would do for the blur, but what
    it makes of few samples is noise that neighbouring pixels share, as no sensor has it."""

    def __init__(self, properties: mi.Properties) -> None:
        super().__init__(properties)
        self.view = _views[properties["view"]]

    def undistorted(self, xd: mi.Float, yd: mi.Float) -> tuple[mi.Float, mi.Float]:
        lens = self.view.lens
        x, y = mi.Float(xd), mi.Float(yd)
        for _ in range(UNDISTORTING_STEPS):
            r2 = x * x + y * y
            radial = 1 + lens.k1 * r2 + lens.k2 * r2 * r2
            dx = 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x)
            dy = lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y
            x, y = (xd - dx) / radial, (yd - dy) / radial
        return x, y

    def sample_ray_differential(self, time, wavelength, film, aperture, active=True):
        view, lens = self.view, self.view.lens
        off = view.blur_px * mi.warp.square_to_std_normal(aperture)
        # The film begins half a pixel before the centre of its first one.
        u, v = film.x * lens.width - 0.5 + off.x, film.y * lens.height - 0.5 + off.y
        x, y = self.undistorted((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy)
        ray = dr.zeros(mi.RayDifferential3f, dr.width(u))
        ray.o = mi.Point3f(*(t + way * (time - 0.5)
                             for t, way in zip(view.position_m, view.movement_m)))
        ray.d = dr.normalize(mi.Vector3f(*(r[0] * x + r[1] * y + r[2] for r in view.rotation)))
        ray.maxt = dr.largest(mi.Float)
        return ray, mi.Spectrum(1.0)

    def sample_ray(self, time, wavelength, film, aperture, active=True):
        ray, weight = self.sample_ray_differential(time, wavelength, film, aperture, active)
        return mi.Ray3f(ray), weight

    def needs_aperture_sample(self) -> bool:
        return True

    def bbox(self):
        return mi.BoundingBox3f()


@dataclass(frozen=True)
class View:
    """In plain numbers, as Dr.Jit wants them."""

    lens: Lens
    rotation: list
    position_m: list
    movement_m: list
    blur_px: float


# Properties hold plain values only: a sensor finds its view here.
_views: dict[str, View] = {}
mi.register_sensor("opms_traced_lens", TracedLens)


def lens_sensor(lens: Lens, world_camera: Pose, movement_m: np.ndarray, blur_px: float) -> dict:
    """Entry of a Mitsuba scene. The pose is that of mid-exposure, `movement_m` the way of the
    camera in the world while it is open, `blur_px` what the pixel's own area adds to."""
    _views["current"] = View(lens, world_camera.R.tolist(), world_camera.t.tolist(),
                             movement_m.tolist(), blur_px)
    return {"type": "opms_traced_lens", "view": "current",
            "shutter_open": 0.0, "shutter_close": 1.0,
            "film": {"type": "hdrfilm", "width": lens.width, "height": lens.height,
                     "pixel_format": "luminance", "component_format": "float32",
                     "rfilter": {"type": "box"}},
            "sampler": {"type": "multijitter"}}
