# SPDX-License-Identifier: Apache-2.0
"""Camera files of OpenCV and Kalibr, turned into the form that ROS has them in.

The content says which it is. What the form cannot hold raises ValueError, whose text is for a
person.
"""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree

import yaml

_Document = dict[Any, Any]

_OLDER_KEYS = {
    "Camera_Matrix": "camera_matrix",
    "cameraMatrix": "camera_matrix",
    "Distortion_Coefficients": "distortion_coefficients",
    "distCoeffs": "distortion_coefficients",
    "image_Width": "image_width",
    "image_Height": "image_height",
}
_COEFFICIENTS = "k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y".split()


class _Loader(yaml.SafeLoader):
    """YAML's safe loader that knows OpenCV's tag for a matrix."""


def _construct_matrix(loader: _Loader, node: yaml.MappingNode) -> _Document:
    return loader.construct_mapping(node, deep=True)


_Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", _construct_matrix)


def camera_document(data: bytes) -> Any:
    """The document of a camera file in ROS's form. Raises ValueError and yaml.YAMLError."""
    if data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        return _from_opencv(_load_xml(data))
    # OpenCV's first line is no directive of YAML's.
    document = yaml.load(re.sub(rb"\A%YAML:1\.0", b"#", data), Loader=_Loader)  # noqa: S506
    if not isinstance(document, dict):
        return document
    cameras = [key for key in document if re.fullmatch(r"cam\d+", str(key))]
    if cameras:
        return _from_kalibr(document, cameras)
    matrix = document.get("camera_matrix")
    is_ros = isinstance(matrix, dict) and "dt" not in matrix
    has_older = any(key in document for key in _OLDER_KEYS)
    return document if is_ros or not (has_older or matrix) else _from_opencv(document)


def _from_opencv(document: _Document) -> _Document:
    ros = {_OLDER_KEYS.get(str(key), key): value for key, value in document.items()}
    if ros.get("fisheye_model", 0) not in (0, "0"):
        raise ValueError("fisheye_model is set: the fisheye model is not supported")
    distortion = ros.get("distortion_coefficients")
    if isinstance(distortion, dict):
        ros["distortion_coefficients"] = {"data": _held(distortion.get("data"))}
    ros["distortion_model"] = "plumb_bob"
    return ros


def _held(data: Any) -> Any:
    """The first four coefficients, where the others are 0."""
    if not isinstance(data, list) or len(data) not in (4, 5, 8, 12, 14):
        raise ValueError("distortion_coefficients must hold 4, 5, 8, 12 or 14 numbers")
    for name, value in zip(_COEFFICIENTS[4:], data[4:]):
        if float(value) != 0.0:
            raise ValueError(f"{name} = {value} is not supported; calibrate with {name} fixed to 0")
    return data[:4]


def _from_kalibr(document: _Document, cameras: list[Any]) -> _Document:
    if len(cameras) > 1:
        raise ValueError(
            f"holds {len(cameras)} cameras ({', '.join(map(str, cameras))}): take one of them out "
            "with 'opms camera convert --cam NAME'"
        )
    camera = document[cameras[0]]
    if not isinstance(camera, dict):
        raise ValueError(f"{cameras[0]} is no mapping")
    for key, known in (("camera_model", ("pinhole",)), ("distortion_model", ("radtan", "none"))):
        if camera.get(key) not in known:
            raise ValueError(f"{key} {camera.get(key)!r} is not supported; {known[0]} is")
    size = _list_of(camera, "resolution", 2)
    fx, fy, cx, cy = _list_of(camera, "intrinsics", 4)
    distortion = [0.0] * 4
    if camera["distortion_model"] == "radtan":
        distortion = _list_of(camera, "distortion_coeffs", 4)
    return {
        "image_width": size[0],
        "image_height": size[1],
        "camera_matrix": {"data": [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]},
        "distortion_model": "plumb_bob",
        "distortion_coefficients": {"data": distortion},
        "opms": camera.get("opms"),
    }


def _list_of(camera: _Document, key: str, count: int) -> list[Any]:
    values = camera.get(key)
    if not isinstance(values, list) or len(values) != count:
        raise ValueError(f"{key} must be a list of {count} numbers")
    return values


def _load_xml(data: bytes) -> _Document:
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise ValueError("XML with a document type is not read")
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as cause:
        raise ValueError(f"not an XML file: {cause}") from None
    if root.tag != "opencv_storage":
        raise ValueError(f"<{root.tag}> is not OpenCV's <opencv_storage>")
    value = _xml_value(root, 0)
    return value if isinstance(value, dict) else {}


def _xml_value(element: ElementTree.Element, depth: int) -> Any:
    if depth > 8:
        raise ValueError("nested too deeply for a camera file")
    children = [(child.tag, _xml_value(child, depth + 1)) for child in element]
    if children and all(tag == "_" for tag, _ in children):
        return [value for _, value in children]
    if children:
        return dict(children)
    text = (element.text or "").strip()
    if len(text) > 1 and text.startswith('"') and text.endswith('"'):
        return text[1:-1]
    words = [_xml_word(word) for word in text.split()]
    return words if len(words) > 1 else (words[0] if words else None)


def _xml_word(word: str) -> int | float | str:
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            continue
    return word
