# SPDX-License-Identifier: Apache-2.0
import pathlib

import numpy as np
import pytest
from PIL import Image

import opms
from opms import blur

DATA = pathlib.Path(__file__).resolve().parent.parent / "data"


@pytest.fixture(scope="module")
def scene():
    """A picture of the bar whose white is not saturated, and its squares."""
    locator = opms.Locator(opms.load_camera(DATA / "bar" / "camera.yaml"))
    for path in sorted((DATA / "bar").glob("*.png")):
        picture = np.asarray(Image.open(path).convert("L"))
        location = locator.locate(picture)
        if (location.state is opms.BarState.LOCATED
                and location.bar.white_fraction_saturated < 0.05):
            return picture, location.squares
    raise AssertionError("all pictures are saturated")


def smeared(picture, rows):
    """Moved by so many rows during the exposure."""
    return np.mean([np.roll(picture.astype(float), k, axis=0) for k in range(rows)], axis=0)


def test_a_sharp_picture_is_sharp(scene):
    sharp = blur.measure(*scene)
    assert sharp.verdict is blur.Verdict.SHARP
    assert sharp.squares > 10
    assert np.all(np.abs(sharp.blur_px - 0.55) < 0.1)  # what the renderer's pixels and lens make


def test_motion_that_is_put_into_a_picture_is_found_with_its_direction(scene):
    picture, squares = scene
    moved_squares = squares.copy()
    moved_squares["corners_px"][:, :, 1] += 2  # the middle of the way
    moved = blur.measure(np.uint8(smeared(picture, 5)), moved_squares)
    assert moved.verdict is blur.Verdict.MOTION
    assert abs(moved.motion_direction[1]) > 0.95
    assert abs(moved.motion_px - np.sqrt(5**2 - 1)) < 0.25 * 5


def test_no_squares_are_no_error(scene):
    nothing = blur.measure(scene[0], scene[1][:0])
    assert nothing.verdict is blur.Verdict.UNKNOWN
    assert nothing.squares == 0
    assert nothing.sharpest_square is None


def test_wrong_arguments_are_refused(scene):
    with pytest.raises(opms.Error, match="sharp_most_px"):
        blur.measure(*scene, sharp_most_px=0.0)
    with pytest.raises(TypeError):
        blur.measure(scene[0], np.zeros(3))
