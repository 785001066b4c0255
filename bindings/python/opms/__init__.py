# SPDX-License-Identifier: Apache-2.0
"""OPMS: from a picture of the marker bar to the detector's pose.

The names, units and conventions are those of the C library: SI units unless a name says otherwise;
``R_a_b`` and ``t_a_b`` take coordinates in b to coordinates in a; pixel (0, 0) is the centre of the
top left pixel, u to the right, v down; the camera looks along +z. Arrays are numpy arrays.
Every failure of the library is an :class:`opms.Error`.
"""

from opms import blur, calib, expect, grid, wire
from opms._opms import (
    BAR_ORIGIN,
    BAR_PITCH_M,
    BAR_SQUARE_M,
    BAR_SQUARES,
    EDGE_DTYPE,
    SQUARE_DTYPE,
    BarDetection,
    BarDetector,
    BarState,
    BarSummary,
    Camera,
    Covariance,
    Lens,
    Location,
    Locator,
    Pose,
    PoseResult,
    PoseState,
    Status,
    Transform,
    pose_detector,
    pose_solve,
    version,
)
from opms.camera_file import load_camera
from opms.errors import Error

__version__ = version()

__all__ = [
    "BAR_ORIGIN",
    "BAR_PITCH_M",
    "BAR_SQUARE_M",
    "BAR_SQUARES",
    "EDGE_DTYPE",
    "SQUARE_DTYPE",
    "BarDetection",
    "BarDetector",
    "BarState",
    "BarSummary",
    "Camera",
    "Covariance",
    "Error",
    "Lens",
    "Location",
    "Locator",
    "Pose",
    "PoseResult",
    "PoseState",
    "Status",
    "Transform",
    "__version__",
    "blur",
    "calib",
    "expect",
    "grid",
    "load_camera",
    "pose_detector",
    "pose_solve",
    "version",
    "wire",
]
