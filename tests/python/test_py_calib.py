# SPDX-License-Identifier: Apache-2.0
import json
import pathlib
import re

import numpy as np
import pytest
from PIL import Image

import opms
from opms import calib, expect, grid

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DATA = ROOT / "tests" / "data" / "grid"
PICTURES = sorted(DATA.glob("*.png"))
# The head stood here in the first picture (tests/data/README.md: 350 mm ahead of the centre node).
AHEAD_M = 0.35
LENS_NAMES = ("fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2")


def lens_numbers(lens):
    return np.array([getattr(lens, name) for name in LENS_NAMES])


@pytest.fixture(scope="module")
def nodes():
    detector = grid.Detector(1024, 768)
    found = [detector.detect(np.asarray(Image.open(path).convert("L"))) for path in PICTURES]
    return [f.nodes for f in found]


def add(calibrator, nodes):
    target_m = (nodes["label"] - grid.CENTRE) * grid.PITCH_M
    return calibrator.add(target_m, nodes["px"], nodes["sigma_px"])


@pytest.fixture
def calibrator(nodes):
    made = calib.Calibrator(1024, 768)
    assert [add(made, n) for n in nodes] == list(range(len(nodes)))
    return made


def test_pictures_with_truth_give_the_true_lens(calibrator):
    result = calibrator.solve()
    truth = opms.load_camera(DATA / "camera.yaml").lens
    off = lens_numbers(truth) - lens_numbers(result.lens)
    assert off @ np.linalg.solve(result.covariance, off) < 26.1  # 0.1 % of chi2 of 8
    assert abs(off[0]) < 0.005 * truth.fx_px
    assert result.pictures_used == len(PICTURES)
    assert 0.5 < result.chi2_dof < 2.0
    assert result.residual_rms_px < 0.1
    assert not result.warnings & (calib.Warning.LARGE_RESIDUAL | calib.Warning.MANY_OUTLIERS)
    assert result.cockle_scale_m == 0.0 and not result.cockle_m.any()


def test_every_picture_says_what_became_of_it(calibrator, nodes):
    assert calibrator.picture(0).use is calib.Use.NOT_SOLVED
    assert calibrator.picture(0).target_camera is None
    assert np.isnan(calibrator.residuals(0)[0]).all()
    calibrator.solve()
    for k, (path, own) in enumerate(zip(PICTURES, nodes)):
        picture = calibrator.picture(k)
        truth = json.loads(path.with_suffix(".json").read_text())
        assert picture.use is calib.Use.USED
        assert picture.points == len(own)
        t_error_m = picture.target_camera.transform.t_m - truth["t_bar_camera_m"]
        assert np.linalg.norm(t_error_m) < 0.002
        assert picture.covariance_with_lens.shape == (6, 8)
        residuals_px, weights = calibrator.residuals(k)
        assert residuals_px.shape == (len(own), 2) and weights.shape == (len(own),)
        counted = weights >= 0.25
        assert np.count_nonzero(~counted) == picture.outliers
        rms_px = np.sqrt(np.mean(np.sum(residuals_px[counted] ** 2, axis=1)))
        assert rms_px == pytest.approx(picture.residual_rms_px)


def test_pictures_are_switched_off_and_chosen(calibrator):
    with pytest.raises(opms.Error, match="solution"):
        calibrator.choose(3)
    calibrator.use(1, False)
    assert calibrator.solve().pictures_used == len(PICTURES) - 1
    assert calibrator.picture(1).use is calib.Use.SWITCHED_OFF
    calibrator.use(1, True)
    assert calibrator.solve().pictures_used == len(PICTURES)
    chosen = calibrator.choose(3)
    assert len(set(chosen)) == 3 and max(chosen) < len(PICTURES)
    assert sorted(calibrator.choose(10**6)) == list(range(len(PICTURES)))


def footprints():
    truth = json.loads(PICTURES[0].with_suffix(".json").read_text())
    x_m, y_m, _ = truth["t_ground_detector_m"]
    R = np.array(truth["R_ground_detector"])
    return [calib.Footprint(picture=0, x_m=x_m, y_m=y_m, yaw_rad=np.arctan2(R[1, 0], R[0, 0]),
                            sigma_m=0.0005, sigma_rad=0.002)]  # fmt: skip


def test_the_footprint_gives_the_camera_on_its_detector(calibrator):
    calibrator.solve()
    camera = calibrator.camera(footprints())
    truth = opms.load_camera(DATA / "camera.yaml").detector_camera
    assert np.abs(camera.detector_camera.t_m - truth.t_m).max() < 0.003
    assert np.abs(camera.detector_camera.R - truth.R).max() < 0.01
    assert camera.covariance_detector_camera.shape == (6, 6)
    camera.check()
    for bad in ([], [calib.Footprint(picture=99)]):
        with pytest.raises(opms.Error):
            calibrator.camera(bad)
    with pytest.raises(TypeError):
        calib.Footprint(x_mm=350)
    assert calib.Footprint(x_m=AHEAD_M) == calib.Footprint(x_m=AHEAD_M, picture=0)


def test_what_one_more_picture_would_do_is_foreseen(calibrator, nodes):
    calibrator.use(len(PICTURES) - 1, False)
    before = calibrator.solve()
    added = json.loads(PICTURES[-1].with_suffix(".json").read_text())
    pose = opms.Transform(np.array(added["R_bar_camera"]), np.array(added["t_bar_camera_m"]))
    target_m = (nodes[-1]["label"] - grid.CENTRE) * grid.PITCH_M
    foresight = calibrator.foresee(pose, target_m)
    assert foresight.points == len(target_m)
    assert 0.0 < foresight.gain < 8.0
    foreseen = np.diag(foresight.camera.covariance_intrinsics)
    assert np.all(foreseen < np.diag(before.covariance))
    calibrator.use(len(PICTURES) - 1, True)
    ratio = np.diag(calibrator.solve().covariance) / foreseen
    assert np.all((ratio > 0.4) & (ratio < 2.5))


def test_a_lens_that_was_touched_is_told_from_one_that_was_not(calibrator, nodes):
    calibrator.solve()
    camera = calibrator.camera(footprints())
    lens, mountings = calibrator.check(camera, footprints())
    assert lens.chi2 < calib.CHI2_LENS and mountings[0].chi2 < calib.CHI2_MOUNTING
    assert np.abs(lens.change[:2]).max() < 0.002 * camera.lens.fx_px
    assert mountings[0].covariance.shape == (6, 6)
    numbers = {name: getattr(camera.lens, name) for name in LENS_NAMES}
    numbers["fx_px"] *= 1.02
    numbers["fy_px"] *= 1.02
    touched = opms.Camera(opms.Lens(width_px=1024, height_px=768, **numbers),
                          covariance_intrinsics=camera.covariance_intrinsics)  # fmt: skip
    lens, mountings = calibrator.check(touched)
    assert lens.chi2 > calib.CHI2_LENS and mountings == []
    assert lens.change[0] == pytest.approx(camera.lens.fx_px / 1.02 * -0.02, rel=0.2)
    with pytest.raises(opms.Error):
        calibrator.check(touched, footprints())  # no mounting to check


def test_the_camera_says_how_exact_a_position_will_be(calibrator):
    calibrator.solve()
    camera = calibrator.camera(footprints())
    R = np.eye(3)
    ahead = expect.pose(camera, opms.Transform(R, np.array([0.35, 0.0, 0.05])))
    assert ahead.state is opms.PoseState.FOUND and ahead.square_count >= 8
    sigma_m = np.sqrt(np.trace(ahead.covariance_image[3:, 3:]))
    assert 1e-5 < sigma_m < 1e-3
    assert np.trace(ahead.covariance_calibration[3:, 3:]) > 0.0
    noisy = expect.pose(camera, opms.Transform(R, np.array([0.35, 0.0, 0.05])), noise=6.0)
    assert np.allclose(noisy.covariance_image, 4.0 * ahead.covariance_image, rtol=1e-6)
    away = expect.pose(camera, opms.Transform(R, np.array([9.0, 0.0, 0.05])))
    assert away.state is not opms.PoseState.FOUND
    with pytest.raises(opms.Error):
        expect.pose(camera, opms.Transform(R, np.zeros(3)), blur_px=-1.0)


def test_bad_points_are_refused_and_nothing_is_added(nodes):
    calibrator = calib.Calibrator(1024, 768, pictures_max=3, points_max=400)
    i, j = np.mgrid[0:10, 0:10]
    target_m = np.column_stack([i.ravel(), j.ravel()]) * 0.01
    px = 100.0 + 2000.0 * target_m
    sigma_px = np.full(100, 0.1)
    for n, error in ((99, ValueError), (100, None)):
        if error:
            with pytest.raises(error, match="length"):
                calibrator.add(target_m, px[:n], sigma_px)
    for wrong in (np.nan, 0.0, -1.0):
        bad = sigma_px.copy()
        bad[7] = wrong
        with pytest.raises(opms.Error) as caught:
            calibrator.add(target_m, px, bad)
        assert caught.value.index == 7
    with pytest.raises(opms.Error) as caught:
        calibrator.add(*(np.tile(a, (5, 1)) for a in (target_m, px)), np.tile(sigma_px, 5))
    assert caught.value.status is opms.Status.ERR_CAPACITY
    with pytest.raises(opms.Error):
        calibrator.add(target_m[:3], px[:3], sigma_px[:3])
    with pytest.raises(TypeError):
        calibrator.add(target_m.T, px, sigma_px)
    assert calibrator.add(target_m, px, sigma_px) == 0
    for call in (calibrator.picture, calibrator.residuals, lambda k: calibrator.use(k, True)):
        with pytest.raises(opms.Error):
            call(1)
    with pytest.raises(opms.Error) as caught:
        calibrator.solve()
    assert caught.value.status is opms.Status.ERR_DOMAIN
    with pytest.raises(opms.Error):
        calib.Calibrator(0, 0)


def test_the_flags_and_uses_have_the_names_and_numbers_of_c():
    text = (ROOT / "libopms" / "include" / "opms" / "calib.h").read_text()
    bits = {n: 1 << int(b) for n, b in re.findall(r"OPMS_CALIB_(\w+) = 1U << (\d+)", text)}
    assert {item.name: int(item.value) for item in calib.Warning} == bits
    uses = {n: int(v) for n, v in re.findall(r"OPMS_CALIB_(\w+) = (\d+)(?!U)", text)}
    assert {item.name: int(item.value) for item in calib.Use} == uses
    text = (ROOT / "libopms" / "include" / "opms" / "grid.h").read_text()
    states = {n: int(v) for n, v in re.findall(r"OPMS_GRID_(\w+) = (\d+)", text)}
    assert {item.name: int(item.value) for item in grid.State} == states


def test_every_name_of_the_parts_is_documented():
    for part in (calib, expect, grid):
        assert part.__doc__
        for name in part.__all__:
            item = getattr(part, name)
            if isinstance(item, type) or callable(item):
                assert item.__doc__, name
            if isinstance(item, type):
                for member, value in vars(item).items():
                    if not member.startswith("_") and isinstance(value, property):
                        assert value.__doc__, f"{name}.{member}"
