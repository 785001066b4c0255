# SPDX-License-Identifier: Apache-2.0
import json
import sys
import threading
import tracemalloc

import numpy as np
import pytest
from conftest import DATA
from PIL import Image

import opms

PICTURES = sorted(DATA.glob("*.png"))


def read(path):
    return np.asarray(Image.open(path).convert("L"))


def test_a_grey_picture_shows_no_bar(camera, grey):
    location = opms.Locator(camera).locate(grey)
    assert location.state is opms.BarState.ABSENT
    assert location.pose is None and location.ground_detector is None
    assert location.residuals_px is None
    assert len(location.squares) == 0 and location.squares.dtype == opms.SQUARE_DTYPE
    assert len(location.edges) == 0 and location.edges.dtype == opms.EDGE_DTYPE


def test_a_detector_finds_nothing_in_grey(lens, grey):
    detection = opms.BarDetector(lens, min_square_px=8).detect(grey)
    assert detection.summary.state is opms.BarState.ABSENT
    assert detection.summary.square_count == 0
    assert detection.summary.blur_px.shape == (2,)


def test_a_picture_of_another_size_is_an_error(camera):
    with pytest.raises(opms.Error) as failure:
        opms.Locator(camera).locate(np.zeros((10, 10), np.uint8))
    assert failure.value.status is opms.Status.ERR_ARG


@pytest.mark.parametrize(
    "picture",
    [
        np.zeros((768, 1024), np.float32),
        np.zeros((768, 1024), np.int16),
        np.zeros((768, 1024, 3), np.uint8),
        [[0, 1], [2, 3]],
        None,
    ],
    ids=["float", "signed", "colour", "list", "none"],
)
def test_what_is_no_grey_picture_is_a_type_error(camera, picture):
    with pytest.raises(TypeError):
        opms.Locator(camera).locate(picture)


def test_rows_whose_pixels_are_apart_are_refused_not_copied(camera):
    with pytest.raises(ValueError, match="ascontiguousarray"):
        opms.Locator(camera).locate(np.zeros((768, 2048), np.uint8)[:, ::2])
    with pytest.raises(ValueError, match="ascontiguousarray"):
        opms.Locator(camera).locate(np.zeros((1024, 768), np.uint8).T)


def test_rows_that_run_backwards_are_refused(camera, grey):
    with pytest.raises(opms.Error):
        opms.Locator(camera).locate(grey[::-1])


def test_any_row_stride_and_depth_is_read_in_place(camera):
    locator = opms.Locator(camera)
    for dtype in (np.uint8, np.uint16):
        for picture in (
            np.full((768, 1100), 128, dtype)[:, 50:1074],
            np.full((1536, 1024), 128, dtype)[::2],
        ):
            picture.flags.writeable = False
            tracemalloc.start()
            location = locator.locate(picture, white_level=255)
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            assert location.state is opms.BarState.ABSENT
            assert peak < picture.nbytes / 4


def test_a_bad_option_is_an_error(lens):
    with pytest.raises(opms.Error):
        opms.BarDetector(lens, min_square_px=1000)


def test_a_bad_region_is_refused(camera, grey):
    locator = opms.Locator(camera)
    with pytest.raises(TypeError):
        locator.locate(grey, roi=(1, 2, 3))
    assert locator.locate(grey, roi=(100, 100, 200, 200)).state is opms.BarState.ABSENT


def rotation_error_rad(R, R_true):
    return np.arccos(np.clip((np.trace(R @ R_true.T) - 1.0) / 2.0, -1.0, 1.0))


@pytest.mark.parametrize("path", PICTURES, ids=lambda path: path.stem)
def test_a_picture_with_truth_gives_the_true_pose(path):
    truth = json.loads(path.with_suffix(".json").read_text())
    camera = opms.load_camera(path.parent / "camera.yaml")
    locator = opms.Locator(camera, bar_tilt_rad=np.radians(truth["bar_tilt_deg"]))

    location = locator.locate(read(path))

    assert location.state is opms.BarState.LOCATED
    pose = location.pose.bar_camera
    t_error_m = np.linalg.norm(pose.transform.t_m - truth["t_bar_camera_m"])
    angle_rad = rotation_error_rad(pose.transform.R, np.array(truth["R_bar_camera"]))
    assert t_error_m < 0.003
    assert angle_rad < np.radians(0.3)
    detector_error_m = location.ground_detector.transform.t_m - truth["t_ground_detector_m"]
    assert np.linalg.norm(detector_error_m) < 0.003
    assert np.all(np.diff(location.squares["index"]) > 0)
    assert len(location.residuals_px) == len(location.edges) == location.bar.edge_count


def test_depth_stride_and_hint_do_not_change_the_pose():
    camera = opms.load_camera(DATA / "camera.yaml")
    picture = read(DATA / "bar_01005.png")
    first = opms.Locator(camera).locate(picture)
    pose = first.pose.bar_camera.transform
    wide = np.zeros((picture.shape[0], picture.shape[1] + 37), np.uint16)
    wide[:, 11:-26] = picture
    deep = opms.Locator(camera).locate(wide[:, 11:-26], white_level=255)
    hinted = opms.Locator(camera).locate(picture, hint=pose)
    for other, tolerance_m in ((deep, 1e-9), (hinted, 2e-4)):
        assert other.state is opms.BarState.LOCATED
        assert np.abs(other.pose.bar_camera.transform.t_m - pose.t_m).max() < tolerance_m
    assert hinted.followed and not deep.followed


def picture_for_threads(camera, grey):
    if PICTURES:
        return opms.load_camera(DATA / "camera.yaml"), read(PICTURES[0])
    return camera, grey


def run_threads(count, work):
    failures = []

    def guarded():
        try:
            work()
        except BaseException as failure:  # noqa: BLE001 - handed to the main thread
            failures.append(failure)

    threads = [threading.Thread(target=guarded) for _ in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures, failures


def test_two_locators_in_two_threads_give_the_same_results(camera, grey):
    camera, picture = picture_for_threads(camera, grey)
    expected = opms.Locator(camera).locate(picture)

    def work():
        locator = opms.Locator(camera)
        for _ in range(10):
            found = locator.locate(picture)
            assert found.state is expected.state
            assert np.array_equal(found.edges, expected.edges)

    run_threads(2, work)


def test_one_locator_in_many_threads_takes_turns(camera, grey):
    camera, picture = picture_for_threads(camera, grey)
    locator = opms.Locator(camera)
    expected = locator.locate(picture)

    def work():
        for _ in range(5):
            assert np.array_equal(locator.locate(picture).edges, expected.edges)

    run_threads(4, work)


@pytest.fixture
def no_forced_switches():
    """The interpreter takes the GIL from nobody; a thread has to give it away."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(60.0)
    yield
    sys.setswitchinterval(interval)


def test_other_threads_run_while_a_picture_is_located(camera, grey, no_forced_switches):
    camera, picture = picture_for_threads(camera, grey)
    locator = opms.Locator(camera)
    turns = []

    def locate():
        for _ in range(200):
            locator.locate(picture)
        turns.append("located")

    thread = threading.Thread(target=locate)
    thread.start()
    turns.append("main")
    thread.join()
    assert turns == ["main", "located"]
