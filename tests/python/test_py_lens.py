# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

import opms


def test_projecting_the_rays_of_pixels_gives_the_pixels_back(lens):
    u, v = np.meshgrid(np.linspace(0, 1023, 17), np.linspace(0, 767, 13))
    px = np.column_stack([u.ravel(), v.ravel()])

    rays = lens.unproject(px)
    again = lens.project(np.column_stack([rays, np.ones(len(rays))]))

    assert rays.shape == (17 * 13, 2)
    assert np.abs(again - px).max() < 1e-6


def test_the_model_is_the_documented_one(lens):
    x, y = 0.3, -0.2
    r2 = x * x + y * y
    radial = 1 + lens.k1 * r2 + lens.k2 * r2 * r2
    xd = x * radial + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x)
    yd = y * radial + lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y

    px = lens.project(np.array([[2 * x, 2 * y, 2.0]]))

    expected = [lens.fx_px * xd + lens.cx_px, lens.fy_px * yd + lens.cy_px]
    assert np.allclose(px[0], expected, rtol=0, atol=1e-10)


def test_gradients_agree_with_differences(lens):
    point = np.array([0.2, -0.1, 0.7])
    step = 1e-6

    px, jac, jac_intrinsics = lens.project_gradients(point[None])
    shifted = point + step * np.concatenate([np.eye(3), -np.eye(3)])
    moved = lens.project(shifted)
    numeric = (moved[:3] - moved[3:]).T / (2 * step)
    rays, ray_jac = lens.unproject_gradients(px)

    assert jac.shape == (1, 2, 3) and jac_intrinsics.shape == (1, 2, 8)
    assert np.allclose(jac[0], numeric, atol=1e-4)
    assert np.allclose(jac_intrinsics[0, :, 2:4], np.eye(2))
    assert np.allclose(rays[0], point[:2] / point[2], atol=1e-12)
    assert np.allclose(ray_jac[0] @ jac[0, :, :2] * point[2], np.eye(2), atol=1e-9)


def test_no_points_give_no_pixels(lens):
    assert lens.project(np.empty((0, 3))).shape == (0, 2)
    assert lens.unproject(np.empty((0, 2))).shape == (0, 2)


def test_a_point_behind_the_camera_raises_with_its_index(lens):
    points = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    with pytest.raises(opms.Error) as failure:
        lens.project(points)
    assert failure.value.status is opms.Status.ERR_DOMAIN
    assert failure.value.index == 2
    assert failure.value.stage == "lens"
    assert "OPMS_ERR_DOMAIN" in str(failure.value)


def test_arrays_of_another_shape_are_type_errors(lens):
    for points in (np.zeros((4, 2)), np.zeros(3), "text"):
        with pytest.raises(TypeError):
            lens.project(points)


def test_a_lens_with_a_bad_parameter_is_named():
    lens = opms.Lens(width_px=640, height_px=480, fx_px=-1.0, fy_px=500, cx_px=320, cy_px=240)
    with pytest.raises(opms.Error, match="fx") as failure:
        lens.check()
    assert failure.value.status is opms.Status.ERR_ARG


def test_a_lens_is_a_value_that_prints_itself(lens):
    assert eval(repr(lens), {"Lens": opms.Lens}).k1 == lens.k1
    with pytest.raises(AttributeError):
        lens.k1 = 0.0
