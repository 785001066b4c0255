# SPDX-License-Identifier: Apache-2.0
"""The detectors that libopms is measured against, each behind the same small face.

A peer that is not installed is reported as such and left out. Times are those of the detector's
own native call from the decoded pixels in hand; making Python objects of the result is not
counted. All run on one thread.
"""

from __future__ import annotations

import ctypes
import importlib.metadata
import time
import warnings
from dataclasses import dataclass
from typing import Callable

import numpy as np

from bench_geometry import SQUARES

# Corners by tag in the order of `corners_px`: (-X,-Y), (+X,-Y), (+X,+Y), (-X,+Y).
Detection = dict[int, np.ndarray]
Detect = Callable[[np.ndarray], tuple[Detection, float]]
# Print's top left, top right, bottom right, bottom left -> bar's order (top is -X, left is -Y).
_FROM_CLOCKWISE = [0, 3, 2, 1]
# AprilTag begins at the bottom left and goes to the bottom right; Napa begins at the bottom right.
_FROM_APRILTAG = [3, 0, 1, 2]
_FROM_NAPA = [2, 1, 0, 3]


@dataclass(frozen=True)
class Peer:
    name: str
    kind: str
    detect: Detect | None
    missing: str = ""


def version_of(package: str) -> str:
    return importlib.metadata.version(package)


def opencv_aruco(refinement: str) -> Peer:
    label = {"NONE": "no refinement", "SUBPIX": "CORNER_REFINE_SUBPIX"}[refinement]
    try:
        import cv2
        cv2.setNumThreads(1)
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = getattr(cv2.aruco, f"CORNER_REFINE_{refinement}")
        dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
        detector = cv2.aruco.ArucoDetector(dictionary, parameters)
    except (ImportError, AttributeError) as error:
        return Peer(f"OpenCV ArUco, {label}", "aruco33", None, str(error))

    def detect(image: np.ndarray) -> tuple[Detection, float]:
        start = time.perf_counter()
        corners, ids, _ = detector.detectMarkers(image)
        seconds = time.perf_counter() - start
        found = {} if ids is None else {
            int(i): c.reshape(4, 2)[_FROM_CLOCKWISE].astype(float)
            for i, c in zip(ids.ravel(), corners) if i < SQUARES}
        return found, seconds

    return Peer(f"OpenCV {cv2.__version__} ArUco, {label}", "aruco33", detect)


def apriltag(decimate: float) -> Peer:
    size = "full size" if decimate == 1 else "half size"
    try:
        import pyapriltags
        from pyapriltags import apriltags as binding
        release = ".".join(version_of("pyapriltags").split(".")[:3])
        detector = pyapriltags.Detector(families="tag36h11", nthreads=1, quad_decimate=decimate)
    except (ImportError, OSError, RuntimeError) as error:
        return Peer(f"AprilTag 3, {size}", "apriltag33", None, str(error))
    library, handle = detector.libc, detector.tag_detector_ptr
    # The binding cuts its 0.25 to a whole number.
    handle.contents.decode_sharpening = 0.25

    def detect(image: np.ndarray) -> tuple[Detection, float]:
        picture = detector._convert_image(image)
        start = time.perf_counter()
        found = library.apriltag_detector_detect(handle, picture)
        seconds = time.perf_counter() - start
        result, tag = {}, ctypes.POINTER(binding._ApriltagDetection)()
        for i in range(found.contents.size):
            binding.zarray_get(found, i, ctypes.byref(tag))
            corners = np.array([tuple(p) for p in tag.contents.p]) - 0.5
            if tag.contents.id < SQUARES:
                result[int(tag.contents.id)] = corners[_FROM_APRILTAG].copy()
        library.apriltag_detections_destroy(found)
        library.image_u8_destroy(picture)
        return result, seconds

    return Peer(f"AprilTag {release}, {size}", "apriltag33", detect)


def napa(min_tag_px: int) -> Peer:
    try:
        from napa_vision import NapaDetector
        release = version_of("napa-vision")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of numpy, about the binding's view of its buffer
            detector = NapaDetector(min_tag_px=min_tag_px)
    except (ImportError, RuntimeError, MemoryError) as error:
        return Peer("Napa", "apriltag33", None, str(error))
    library, results = detector._library, detector._results

    def detect(image: np.ndarray) -> tuple[Detection, float]:
        arguments = (detector._handle, image.ctypes.data, image.shape[1], image.shape[0],
                     image.strides[0], ctypes.byref(detector._params), results, len(results))
        start = time.perf_counter()
        count = library.napa_detect(*arguments)
        seconds = time.perf_counter() - start
        return {int(r.id): np.array(r.corners[:], float).reshape(4, 2)[_FROM_NAPA]
                for r in results[:max(count, 0)] if r.id < SQUARES}, seconds

    return Peer(f"Napa {release}, tags from {min_tag_px} px", "apriltag33", detect)


def all_peers(with_napa: bool) -> list[Peer]:
    peers = [apriltag(1), apriltag(2), opencv_aruco("NONE"), opencv_aruco("SUBPIX")]
    if with_napa:
        peers += [napa(32), napa(16)]
    return peers
