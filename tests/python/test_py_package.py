# SPDX-License-Identifier: Apache-2.0
import importlib.metadata
import pathlib
import pickle
import re
import subprocess
import sys

import pytest

import opms

PACKAGE = pathlib.Path(opms.__file__).parent
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
HEADERS = ROOT / "libopms" / "include" / "opms"

USE_ALL = """
import numpy as np, opms
lens = opms.Lens(width_px=64, height_px=48, fx_px=60, fy_px=60, cx_px=31, cy_px=23)
camera = opms.Camera(lens, R_detector_camera=np.eye(3), t_detector_camera_m=np.zeros(3))
kept = [lens.project_gradients(np.ones((3, 3))), lens.unproject_gradients(np.ones((3, 2)))]
picture = np.zeros((48, 64), np.uint8)
hint = opms.Transform(np.eye(3), np.ones(3))
kept.append(opms.BarDetector(lens).detect(picture, roi=(0, 0, 10, 10)))
location = opms.Locator(camera).locate(picture, hint=hint)
kept += [location, location.squares, location.bar.blur_px, camera.detector_camera.R]
kept.append(opms.pose_solve(lens, location.edges))
from opms import calib, expect, grid
kept.append(grid.Detector(64, 48).detect(picture).nodes)
calibrator = calib.Calibrator(64, 48)
i = np.mgrid[0:5, 0:5].reshape(2, -1).T.astype(float)
calibrator.add(i, 10 + 5 * i, np.ones(25))
kept += [calibrator.residuals(0), calibrator.picture(0), calib.Footprint(x_m=1.0)]
kept.append(expect.pose(camera, hint))
for call in (
    calibrator.solve,
    lambda: lens.project(-np.ones((1, 3))),
    lambda: opms.Locator(camera).locate(None),
):
    try:
        call()
    except (opms.Error, TypeError):
        pass
"""


def test_the_version_is_that_of_the_header():
    text = (HEADERS / "version.h").read_text()
    numbers = re.findall(r"^#define OPMS_VERSION_\w+ (\d+)$", text, re.MULTILINE)
    assert opms.__version__ == ".".join(numbers)
    assert importlib.metadata.version("opms") == opms.__version__


def test_the_checked_in_stub_is_the_generated_one(tmp_path):
    generated = tmp_path / "_opms.pyi"
    subprocess.run(
        [sys.executable, "-m", "nanobind.stubgen", "-q", "-m", "opms._opms", "-o", generated],
        check=True,
    )
    checked_in = ROOT / "bindings" / "python" / "opms" / "_opms.pyi"
    assert generated.read_text() == checked_in.read_text(), (
        f"regenerate: python -m nanobind.stubgen -m opms._opms -o {checked_in}"
    )


def test_the_package_says_that_it_is_typed():
    assert (PACKAGE / "py.typed").exists()
    assert (PACKAGE / "_opms.pyi").exists()


def test_everything_public_is_documented():
    for name in opms.__all__:
        item = getattr(opms, name)
        if isinstance(item, type) or callable(item):
            assert item.__doc__, name
        if isinstance(item, type) and item.__module__ == "opms._opms":
            for member, value in vars(item).items():
                if not member.startswith("_") and isinstance(value, property):
                    assert value.__doc__, f"{name}.{member}"


def c_enum(header, prefix):
    text = (HEADERS / header).read_text()
    return {n: int(v) for n, v in re.findall(rf"{prefix}(\w+) = (-?\d+)", text)}


def test_enums_have_the_names_and_numbers_of_c():
    for python, header, prefix in (
        (opms.Status, "status.h", "OPMS_(?!BAR)"),
        (opms.BarState, "bar.h", "OPMS_BAR_"),
        (opms.PoseState, "pose.h", "OPMS_POSE_"),
        (opms.Covariance, "pose.h", "OPMS_COVARIANCE_"),
    ):
        assert {item.name: int(item.value) for item in python} == c_enum(header, prefix)


def test_an_error_says_all_and_can_be_pickled():
    error = opms.Error(opms.Status.ERR_ARG, "k1 is not finite", 3, "lens")
    again = pickle.loads(pickle.dumps(error))
    for e in (error, again):
        assert (e.status, e.message, e.index, e.stage) == (
            opms.Status.ERR_ARG, "k1 is not finite", 3, "lens",
        )  # fmt: skip
        assert str(e) == "lens: k1 is not finite (element 3) [OPMS_ERR_ARG]"


def test_nothing_leaks():
    done = subprocess.run(
        [sys.executable, "-c", USE_ALL], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "leaked" not in done.stderr, done.stderr


def test_the_code_of_the_readme_runs_as_it_stands(monkeypatch, capsys):
    text = (ROOT / "bindings" / "python" / "README.md").read_text(encoding="utf-8")
    monkeypatch.chdir(ROOT)
    exec("\n".join(re.findall(r"```python\n(.*?)```", text, re.DOTALL)), {})
    printed = capsys.readouterr().out
    focal_px = float(re.search(r"focal lengths, px: (\S+)", printed)[1])
    assert abs(focal_px - 585.0) < 0.5
    assert "camera in the bar's frame, m:" in printed


def test_memory_does_not_grow_with_use(camera, grey):
    resource = pytest.importorskip("resource")
    locator = opms.Locator(camera)

    def peak_kib():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    for _ in range(5):
        locator.locate(grey)
    before = peak_kib()
    for _ in range(100):
        locator.locate(grey)
    assert peak_kib() - before < 2048
