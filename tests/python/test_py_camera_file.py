# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import yaml

import opms


def document():
    """The HOPE camera file, as parsed."""
    return {
        "image_width": 1024,
        "image_height": 768,
        "camera_name": "hope",
        "camera_matrix": {
            "rows": 3,
            "cols": 3,
            "data": [585.0, 0.0, 517.3, 0.0, 586.0, 379.6, 0.0, 0.0, 1.0],
        },
        "distortion_model": "plumb_bob",
        "distortion_coefficients": {
            "rows": 1,
            "cols": 5,
            "data": [-0.118, 0.031, 0.0011, -0.0007, 0.0],
        },
        "opms": {
            "version": 1,
            "R_detector_camera": [0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0],
            "t_detector_camera_m": [-0.1, 0.0, 0.4],
        },
    }


@pytest.fixture
def write(tmp_path):
    def write_document(content):
        path = tmp_path / "camera.yaml"
        path.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
        return path

    return write_document


def failure_of(path):
    with pytest.raises(opms.Error) as failure:
        opms.load_camera(path)
    assert failure.value.status in (opms.Status.ERR_ARG, opms.Status.ERR_DOMAIN)
    assert str(path) in failure.value.message
    return failure.value.message


def test_a_camera_file_gives_lens_and_transform(write):
    camera = opms.load_camera(write(document()))
    lens = camera.lens
    assert (lens.width_px, lens.height_px) == (1024, 768)
    assert (lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px) == (585.0, 586.0, 517.3, 379.6)
    assert (lens.k1, lens.k2, lens.p1, lens.p2) == (-0.118, 0.031, 0.0011, -0.0007)
    assert np.array_equal(camera.detector_camera.t_m, [-0.1, 0.0, 0.4])
    assert camera.detector_camera.R[0, 1] == 1.0
    assert camera.covariance_intrinsics is None
    assert camera.covariance_detector_camera is None


def test_every_key_of_the_opms_mapping_is_optional(write):
    content = document()
    for extra in (None, {}, {"version": 1}):
        content["opms"] = extra
        assert opms.load_camera(str(write(content))).detector_camera is None
    del content["opms"]
    assert opms.load_camera(write(content)).detector_camera is None


def test_covariances_are_read_row_by_row(write):
    content = document()
    content["opms"]["covariance_intrinsics"] = np.diag(np.arange(1.0, 9.0)).ravel().tolist()
    content["opms"]["covariance_detector_camera"] = np.diag([1e-6] * 6).ravel().tolist()
    camera = opms.load_camera(write(content))
    assert np.array_equal(np.diag(camera.covariance_intrinsics), np.arange(1.0, 9.0))
    assert camera.covariance_detector_camera[5, 5] == 1e-6


def test_what_mounting_and_lens_share_is_read_with_both_and_left_out_alone(write):
    content = document()
    shared = np.zeros((6, 8))
    shared[5, 7] = 0.5
    key = "covariance_detector_camera_intrinsics"
    content["opms"][key] = shared.ravel().tolist()
    with pytest.warns(UserWarning, match="left out"):
        assert opms.load_camera(write(content)).covariance_detector_camera_intrinsics is None
    content["opms"]["covariance_intrinsics"] = np.eye(8).ravel().tolist()
    content["opms"]["covariance_detector_camera"] = np.eye(6).ravel().tolist()
    camera = opms.load_camera(write(content))
    assert np.array_equal(camera.covariance_detector_camera_intrinsics, shared)
    content["opms"][key][47] = 1.5
    assert "correlation above 1" in failure_of(write(content))


def test_numbers_in_exponent_form_without_a_point_are_numbers(write):
    text = yaml.safe_dump(document()).replace("-0.0007", "-7e-04")
    assert opms.load_camera(write(text)).lens.p2 == -0.0007


def test_another_distortion_model_is_refused_by_name(write):
    content = document()
    content["distortion_model"] = "equidistant"
    assert "equidistant" in failure_of(write(content))


def test_a_third_radial_coefficient_is_refused_by_name(write):
    content = document()
    content["distortion_coefficients"]["data"][4] = 0.01
    assert "k3" in failure_of(write(content))


def test_half_a_transform_warns_and_gives_no_detector_pose(write):
    content = document()
    del content["opms"]["t_detector_camera_m"]
    path = write(content)
    with pytest.warns(UserWarning, match="need each other"):
        assert opms.load_camera(path).detector_camera is None


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda d: d.pop("camera_matrix"), "camera_matrix"),
        (lambda d: d.pop("distortion_coefficients"), "distortion_coefficients"),
        (lambda d: d.update(image_width=0), "image_width"),
        (lambda d: d.update(image_width=10.5), "image_width"),
        (lambda d: d.update(image_height=True), "image_height"),
        (lambda d: d["camera_matrix"]["data"].pop(), "camera_matrix"),
        (lambda d: d["camera_matrix"]["data"].__setitem__(1, 0.5), "camera_matrix"),
        (lambda d: d["camera_matrix"]["data"].__setitem__(0, float("nan")), "camera_matrix"),
        (lambda d: d["camera_matrix"]["data"].__setitem__(0, "wide"), "wide"),
        (lambda d: d["camera_matrix"]["data"].__setitem__(0, -585.0), "fx"),
        (lambda d: d["camera_matrix"].update(rows=4), "camera_matrix"),
        (lambda d: d["distortion_coefficients"].update(data=[0.0] * 8), "distortion"),
        (lambda d: d.update(opms=[1, 2]), "opms"),
        (lambda d: d["opms"].update(version=2), "version"),
        (lambda d: d["opms"].update(R_detector_camera=[1.0] * 8), "R_detector_camera"),
        (lambda d: d["opms"].update(R_detector_camera=[1.0] * 9), ""),
        (lambda d: d["opms"].update(covariance_intrinsics=[0.0] * 9), "covariance_intrinsics"),
    ],
)
def test_a_bad_key_is_named(write, change, named):
    content = document()
    change(content)
    assert named in failure_of(write(content))


@pytest.mark.parametrize(
    "text", ["", "just text", "[1, 2]", "a: [", "a: \x00", "- " * 5000, "!!python/object:os.x {}"]
)
def test_what_is_no_camera_file_is_an_error(write, text):
    failure_of(write(text))


def test_a_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        opms.load_camera(tmp_path / "none.yaml")


KALIBR = """\
cam0:
  camera_model: pinhole
  intrinsics: [585.0, 586.0, 517.3, 379.6]
  distortion_model: radtan
  distortion_coeffs: [-0.118, 0.031, 0.0011, -0.0007]
  resolution: [1024, 768]
  T_cam_imu: [[1, 0], [0, 1]]
"""
OPENCV = """\
%YAML:1.0
---
calibration_time: "Sat"
{older}idth: 1024
image_height: 768
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 585., 0., 517.3, 0., 5.86e+02,
       379.6, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: {count}
   dt: d
   data: [ -1.18e-01, 3.1e-02, 1.1e-03, -7.0e-04, {rest} ]
"""
XML = """\
<?xml version="1.0"?>
<opencv_storage>
<name>"a &lt; b"</name>
<image_width>1024</image_width><image_height>768</image_height>
<Camera_Matrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt>
  <data>585. 0. 517.3 0. 586. 379.6 0. 0. 1.</data></Camera_Matrix>
<Distortion_Coefficients type_id="opencv-matrix"><rows>5</rows><cols>1</cols><dt>d</dt>
  <data>-0.118 0.031 0.0011 -0.0007 0.</data></Distortion_Coefficients>
<opms><R_detector_camera>0 1 0 1 0 0 0 0 -1</R_detector_camera>
<t_detector_camera_m>-0.1 0. 0.4</t_detector_camera_m></opms>
</opencv_storage>
"""


def opencv(rest="0.", older="image_w"):
    return OPENCV.format(rest=rest, count=4 + rest.count(".") + rest.count("e"), older=older)


@pytest.mark.parametrize(
    "text", [KALIBR, opencv(), opencv("0., 0., 0., 0."), opencv(older="image_W"), XML]
)
def test_files_of_opencv_and_kalibr_are_read_by_their_content(write, text):
    lens = opms.load_camera(write(text)).lens
    assert (lens.width_px, lens.height_px) == (1024, 768)
    assert (lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px) == (585.0, 586.0, 517.3, 379.6)
    assert (lens.k1, lens.k2, lens.p1, lens.p2) == (-0.118, 0.031, 0.0011, -0.0007)


def test_the_mounting_is_read_from_any_of_them(write):
    kalibr = KALIBR + "  opms: {R_detector_camera: [0, 1, 0, 1, 0, 0, 0, 0, -1], "
    kalibr += "t_detector_camera_m: [-0.1, 0.0, 0.4]}\n"
    for text in (XML, kalibr):
        camera = opms.load_camera(write(text))
        assert np.array_equal(camera.detector_camera.t_m, [-0.1, 0.0, 0.4])


@pytest.mark.parametrize(
    ("text", "named"),
    [
        (opencv("1e-3"), "k3"),
        (opencv("0., 0., 0., 1e-3"), "k6"),
        (opencv() + "fisheye_model: 1\n", "fisheye"),
        (KALIBR.replace("radtan", "equidistant"), "equidistant"),
        (KALIBR.replace("pinhole", "omni"), "omni"),
        (KALIBR + KALIBR.replace("cam0", "cam1"), "cam0, cam1"),
        (KALIBR.replace("[1024, 768]", "[1024]"), "resolution"),
        (XML.replace("opencv_storage", "svg"), "opencv_storage"),
        (XML[:300], "not an XML file"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", "document type"),
    ],
)
def test_what_their_files_say_beyond_the_lens_is_refused_by_name(write, text, named):
    assert named in failure_of(write(text))
