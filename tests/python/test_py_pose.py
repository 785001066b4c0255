# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from conftest import exact_edges

import opms


def test_exact_edges_give_the_true_pose(lens, bar_camera):
    edges = exact_edges(lens, bar_camera)

    result, residuals_px = opms.pose_solve(lens, edges)

    assert result.state is opms.PoseState.FOUND
    pose = result.bar_camera
    assert np.abs(pose.transform.t_m - bar_camera.t_m).max() < 1e-6
    assert np.abs(pose.transform.R - bar_camera.R).max() < 1e-6
    assert residuals_px.shape == (len(edges),)
    assert np.abs(residuals_px).max() < 1e-3
    assert np.linalg.eigvalsh(pose.covariance).min() > 0.0
    assert result.intrinsics_jacobian.shape == (6, 8)


def test_the_detector_pose_is_the_chain_of_transforms(lens, camera, bar_camera):
    result, _ = opms.pose_solve(lens, exact_edges(lens, bar_camera))

    pose, includes = opms.pose_detector(result, camera)

    R_dc, t_dc = camera.detector_camera.R, camera.detector_camera.t_m
    R = bar_camera.R @ R_dc.T
    assert np.allclose(pose.transform.R, R, atol=1e-6)
    assert np.allclose(pose.transform.t_m, bar_camera.t_m - R @ t_dc, atol=1e-6)
    assert includes == opms.Covariance.IMAGE


def test_no_edges_are_no_error_but_a_state(lens):
    result, residuals_px = opms.pose_solve(lens, np.empty(0, opms.EDGE_DTYPE))
    assert result.state is opms.PoseState.NONE
    assert residuals_px is None


def test_a_bad_edge_is_named_by_its_index(lens, bar_camera):
    edges = exact_edges(lens, bar_camera)
    edges["sigma_px"][5] = 0.0
    with pytest.raises(opms.Error) as failure:
        opms.pose_solve(lens, edges)
    assert failure.value.status is opms.Status.ERR_ARG
    assert failure.value.index == 5


def test_strided_edges_are_the_same_edges(lens, bar_camera):
    edges = exact_edges(lens, bar_camera)
    spread = np.zeros(2 * len(edges), opms.EDGE_DTYPE)
    spread[::2] = edges
    first, _ = opms.pose_solve(lens, edges)
    second, _ = opms.pose_solve(lens, spread[::2])
    assert np.array_equal(first.bar_camera.transform.t_m, second.bar_camera.transform.t_m)


def test_edges_of_another_dtype_are_type_errors(lens):
    for edges in (np.zeros((8, 10)), np.zeros((2, 2), opms.EDGE_DTYPE), [1, 2, 3], None):
        with pytest.raises(TypeError):
            opms.pose_solve(lens, edges)


def test_a_locator_solves_given_edges(lens, camera, bar_camera):
    location = opms.Locator(camera).solve(exact_edges(lens, bar_camera))
    assert location.state is opms.BarState.LOCATED
    assert np.abs(location.pose.bar_camera.transform.t_m - bar_camera.t_m).max() < 1e-6
    assert location.ground_detector is not None
    assert opms.Covariance.IMAGE in location.covariance_includes


def test_views_outlive_the_objects_they_come_from(lens, bar_camera):
    R = opms.pose_solve(lens, exact_edges(lens, bar_camera))[0].bar_camera.transform.R
    assert np.allclose(R, bar_camera.R, atol=1e-6)
    with pytest.raises(ValueError):
        R[0, 0] = 0.0


def test_a_camera_needs_rotation_and_translation_together(lens):
    with pytest.raises(ValueError):
        opms.Camera(lens, R_detector_camera=np.eye(3))
    with pytest.raises(ValueError):
        opms.Camera(lens, covariance_detector_camera=np.eye(6))


def test_a_camera_whose_rotation_is_none_is_refused(lens):
    camera = opms.Camera(
        lens, R_detector_camera=2 * np.eye(3), t_detector_camera_m=np.zeros(3)
    )
    with pytest.raises(opms.Error):
        camera.check()
    with pytest.raises(opms.Error):
        opms.Locator(camera)
