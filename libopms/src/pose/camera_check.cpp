// SPDX-License-Identifier: Apache-2.0
#include "pose/camera_check.h"

#include <opms/lens.h>
#include <opms/pose.h>

#include "base/fail.h"
#include "pose/pose_algebra.h"

namespace opms::pose
{

namespace
{

constexpr double ROTATION_TOLERANCE = 1e-6;
constexpr double SYMMETRY_TOLERANCE = 1e-6;
constexpr int MOUNTING = 6, LENS = 8, ALL = MOUNTING + LENS;
constexpr int COVARIANCE_MOST = ALL;
constexpr double VARIANCE_TOLERANCE = -1e-6; // of a correlation matrix written with few digits

/* Is no eigenvalue below the tolerance? Cholesky's pivots of the matrix raised by it say so; an
 * eigenvalue solver would cost a hundred kilobytes of code. */
bool has_no_negative_direction(double *matrix, int size)
{
    for (int i = 0; i < size; ++i) {
        matrix[size * i + i] -= VARIANCE_TOLERANCE;
        for (int j = 0; j <= i; ++j) {
            double rest = matrix[size * i + j];
            for (int k = 0; k < j; ++k) {
                rest -= matrix[size * i + k] * matrix[size * j + k];
            }
            if (i == j && !(rest > 0.0)) {
                return false;
            }
            matrix[size * i + j] = i == j ? std::sqrt(rest) : rest / matrix[size * j + j];
        }
    }
    return true;
}

/* A symmetric size x size matrix, size at most COVARIANCE_MOST. */
opms_status_t check_covariance(const double *values, int size, const char *name, opms_error_t *err)
{
    double unit[COVARIANCE_MOST], correlation[COVARIANCE_MOST * COVARIANCE_MOST];
    for (int i = 0; i < size * size; ++i) {
        if (!std::isfinite(values[i])) {
            return opms_fail(err, OPMS_ERR_ARG, "pose", i, "camera->%s is not finite", name);
        }
    }
    for (int i = 0; i < size; ++i) {
        const double variance = values[size * i + i];
        if (!(variance >= 0.0)) {
            return opms_fail(err, OPMS_ERR_ARG, "pose", i * size + i,
                             "camera->%s has a negative variance", name);
        }
        unit[i] = std::sqrt(variance);
        correlation[size * i + i] = variance > 0.0 ? 1.0 : 0.0;
        for (int j = 0; j < i; ++j) {
            const double here = values[size * i + j], there = values[size * j + i];
            const double most = unit[i] * unit[j];
            if (!(std::fabs(here - there) <= SYMMETRY_TOLERANCE * most)) {
                return opms_fail(err, OPMS_ERR_ARG, "pose", i * size + j,
                                 "camera->%s is not symmetric", name);
            }
            if (!(std::fabs(here) <= most * (1.0 + SYMMETRY_TOLERANCE))) {
                return opms_fail(err, OPMS_ERR_ARG, "pose", i * size + j,
                                 "camera->%s holds a correlation above 1", name);
            }
            correlation[size * i + j] = correlation[size * j + i] = most > 0.0 ? here / most : 0.0;
        }
    }
    if (!has_no_negative_direction(correlation, size)) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1,
                         "camera->%s has a negative variance in some direction", name);
    }
    return OPMS_OK;
}

/* Mounting and lens as one 14 x 14 matrix: each block may be sound and the whole not. */
opms_status_t check_joint_covariance(const opms_camera_t &camera, opms_error_t *err)
{
    const char *const name = "covariance_detector_camera_intrinsics";
    if (!camera.has_covariance_intrinsics || !camera.has_covariance_detector_camera) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1, "camera->%s stands without %s", name,
                         camera.has_covariance_intrinsics ? "covariance_detector_camera"
                                                          : "covariance_intrinsics");
    }
    double joint[ALL * ALL];
    const double *const shared = camera.covariance_detector_camera_intrinsics;
    for (int i = 0; i < ALL; ++i) {
        for (int j = 0; j < ALL; ++j) {
            const int a = i - MOUNTING, b = j - MOUNTING; // within the lens
            joint[ALL * i + j] =
                a >= 0 && b >= 0 ? camera.covariance_intrinsics[LENS * a + b]
                : a >= 0         ? shared[LENS * j + a]
                : b >= 0         ? shared[LENS * i + b]
                                 : camera.covariance_detector_camera[MOUNTING * i + j];
        }
    }
    return check_covariance(joint, ALL,
                            "covariance_detector_camera_intrinsics, joined with the covariances "
                            "of mounting and lens,", err);
}

} // namespace

opms_status_t check_transform(const opms_transform_t &transform, const char *name,
                              opms_error_t *err)
{
    const Mat3 R = rotation_of(transform);
    if (!R.allFinite() || !translation_of(transform).allFinite()) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1, "%s is not finite", name);
    }
    const double off = (R * R.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff();
    if (!(off <= ROTATION_TOLERANCE)) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1, "%s.R is not orthonormal: off by %g", name,
                         off);
    }
    if (!(R.determinant() > 0.0)) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1, "%s.R is a left-handed rotation", name);
    }
    return OPMS_OK;
}

opms_status_t check_camera_mounting(const opms_camera_t &camera, opms_error_t *err)
{
    if (camera.has_covariance_intrinsics) {
        OPMS_TRY(
            check_covariance(camera.covariance_intrinsics, LENS, "covariance_intrinsics", err));
    }
    if (camera.has_detector_camera) {
        OPMS_TRY(check_transform(camera.detector_camera, "camera->detector_camera", err));
    }
    if (camera.has_covariance_detector_camera) {
        OPMS_TRY(check_covariance(camera.covariance_detector_camera, MOUNTING,
                                  "covariance_detector_camera", err));
    }
    if (camera.has_covariance_detector_camera_intrinsics) {
        OPMS_TRY(check_joint_covariance(camera, err));
    }
    return OPMS_OK;
}

} // namespace opms::pose

opms_status_t opms_camera_check(const opms_camera_t *camera, opms_error_t *err)
{
    if (!camera) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1, "camera is NULL");
    }
    OPMS_TRY(opms_lens_check(&camera->lens, err));
    return opms::pose::check_camera_mounting(*camera, err);
}
