# SPDX-License-Identifier: Apache-2.0
"""Reads a camera file: a ROS ``camera_info`` YAML with one more mapping, ``opms``; or one of OpenCV
or Kalibr."""

from __future__ import annotations

import math
import os
import warnings
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt
import yaml

from opms._opms import Camera, Lens, Status
from opms.camera_formats import camera_document
from opms.errors import Error

_FloatArray = npt.NDArray[np.float64]


def load_camera(path: str | os.PathLike[str]) -> Camera:
    """Read a camera file.

    What OpenCV's FileStorage (YAML, XML) and Kalibr write is read, too: the content says which it
    is.
    The distortion model must be ``plumb_bob`` with k3 = 0. Of the mapping ``opms`` these keys are
    used, each optional: ``R_detector_camera`` (9 numbers, row-major) with ``t_detector_camera_m``
    (3), ``covariance_intrinsics`` (64), ``covariance_detector_camera`` (36) and, where both of
    these are there, ``covariance_detector_camera_intrinsics`` (48).

    Args:
        path: The YAML file.

    Returns:
        The checked camera.

    Warns:
        UserWarning: Only one of ``R_detector_camera`` and ``t_detector_camera_m`` is there.

    Raises:
        OSError: The file cannot be read.
        Error: It is no camera file, or one that cannot be used; the message names the file and key.
    """
    with open(path, "rb") as stream:
        data = stream.read()
    reader = _Reader(os.fspath(path))
    try:
        document = camera_document(data)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as cause:
        reader.fail(f"not a YAML file: {' '.join(str(cause).split())}")
    except ValueError as cause:
        reader.fail(" ".join(str(cause).split()))
    if not isinstance(document, dict):
        reader.fail("holds no mapping")
    return reader.camera(document)


class _Reader:
    """Turns the parsed document of one file into a camera; failures name the file."""

    def __init__(self, name: str) -> None:
        self._name = name

    def fail(self, reason: str) -> NoReturn:
        raise Error(Status.ERR_ARG, f"{self._name}: {reason}", stage="camera_file") from None

    def _warn(self, reason: str) -> None:
        warnings.warn(f"{self._name}: {reason}", stacklevel=4)

    def camera(self, document: dict[Any, Any]) -> Camera:
        extra = document.get("opms")
        if extra is None:
            extra = {}
        if not isinstance(extra, dict):
            self.fail("opms is no mapping")
        version = extra.get("version", 1)
        if version != 1 or isinstance(version, bool):
            self.fail(f"opms.version {version!r} is not known; this program reads version 1")

        rotation = self._optional(extra, "R_detector_camera", (3, 3))
        translation = self._optional(extra, "t_detector_camera_m", (3,))
        covariance = self._optional(extra, "covariance_detector_camera", (6, 6))
        if rotation is None or translation is None:
            if rotation is not None or translation is not None or covariance is not None:
                self._warn(
                    "opms.R_detector_camera and opms.t_detector_camera_m need each other: "
                    "there will be no detector pose"
                )
            rotation = translation = covariance = None
        intrinsics = self._optional(extra, "covariance_intrinsics", (8, 8))
        shared = self._optional(extra, "covariance_detector_camera_intrinsics", (6, 8))
        if shared is not None and (covariance is None or intrinsics is None):
            self._warn(
                "opms.covariance_detector_camera_intrinsics needs covariance_detector_camera and "
                "covariance_intrinsics: it is left out"
            )
            shared = None
        camera = Camera(
            self._lens(document),
            R_detector_camera=rotation,
            t_detector_camera_m=translation,
            covariance_intrinsics=intrinsics,
            covariance_detector_camera=covariance,
            covariance_detector_camera_intrinsics=shared,
        )
        try:
            camera.check()
        except Error as error:
            message = f"{self._name}: {error.message}"
            raise Error(error.status, message, error.index, error.stage) from None
        return camera

    def _lens(self, document: dict[Any, Any]) -> Lens:
        model = document.get("distortion_model")
        if model != "plumb_bob":
            self.fail(f"distortion_model {model!r} is not supported; only plumb_bob is")
        matrix = self._matrix(document, "camera_matrix", 3, 3)
        if np.any(matrix.flat[[1, 3, 6, 7]] != 0.0) or matrix[2, 2] != 1.0:
            self.fail("camera_matrix is not of the form fx 0 cx, 0 fy cy, 0 0 1")
        k1, k2, p1, p2, k3 = self._distortion(document)
        if k3 != 0.0:
            self.fail(f"k3 = {k3:g} is not supported; calibrate with k3 fixed to 0")
        return Lens(
            width_px=self._whole(document, "image_width"),
            height_px=self._whole(document, "image_height"),
            fx_px=matrix[0, 0],
            fy_px=matrix[1, 1],
            cx_px=matrix[0, 2],
            cy_px=matrix[1, 2],
            k1=k1,
            k2=k2,
            p1=p1,
            p2=p2,
        )

    def _distortion(self, document: dict[Any, Any]) -> list[float]:
        node = self._mapping(document, "distortion_coefficients")
        data = node.get("data")
        count = len(data) if isinstance(data, list) else 0
        if count not in (4, 5):
            self.fail("distortion_coefficients.data must hold k1 k2 p1 p2 k3")
        values = self._numbers(data, "distortion_coefficients.data", (count,)).tolist()
        return values if count == 5 else [*values, 0.0]

    def _whole(self, document: dict[Any, Any], key: str) -> int:
        value = document.get(key)
        if not isinstance(value, int) or isinstance(value, bool) or not 0 < value <= 16384:
            self.fail(f"{key} must be a whole number from 1 to 16384")
        return value

    def _mapping(self, document: dict[Any, Any], key: str) -> dict[Any, Any]:
        node = document.get(key)
        if not isinstance(node, dict):
            self.fail(f"{key} is missing or no mapping")
        return node

    def _matrix(self, document: dict[Any, Any], key: str, rows: int, cols: int) -> _FloatArray:
        node = self._mapping(document, key)
        if node.get("rows", rows) != rows or node.get("cols", cols) != cols:
            self.fail(f"{key} must have {rows} rows and {cols} columns")
        return self._numbers(node.get("data"), f"{key}.data", (rows, cols))

    def _optional(
        self, extra: dict[Any, Any], key: str, shape: tuple[int, ...]
    ) -> _FloatArray | None:
        value = extra.get(key)
        return None if value is None else self._numbers(value, f"opms.{key}", shape)

    def _numbers(self, value: Any, name: str, shape: tuple[int, ...]) -> _FloatArray:
        count = math.prod(shape)
        if not isinstance(value, list) or len(value) != count:
            self.fail(f"{name} must be a list of {count} numbers")
        return np.array([self._number(item, name) for item in value]).reshape(shape)

    def _number(self, item: Any, name: str) -> float:
        # YAML 1.1 as PyYAML reads it takes "1e-05", which other writers emit, for a string.
        if isinstance(item, (int, float, str)) and not isinstance(item, bool):
            try:
                number = float(item)
            except (ValueError, OverflowError):
                number = math.nan
            if math.isfinite(number):
                return number
        self.fail(f"{name} holds {item!r}, which is no finite number")
