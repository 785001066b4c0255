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

template <int Size>
opms_status_t check_covariance(const double *values, const char *name, opms_error_t *err)
{
    const RowMajor<Size, Size> matrix = Eigen::Map<const RowMajor<Size, Size>>(values);
    for (int i = 0; i < Size * Size; ++i) {
        if (!std::isfinite(values[i])) {
            return opms_fail(err, OPMS_ERR_ARG, "pose", i, "camera->%s is not finite", name);
        }
    }
    Eigen::Matrix<double, Size, 1> unit;
    for (int i = 0; i < Size; ++i) {
        if (!(matrix(i, i) >= 0.0)) {
            return opms_fail(err, OPMS_ERR_ARG, "pose", i * Size + i,
                             "camera->%s has a negative variance", name);
        }
        unit[i] = matrix(i, i) > 0.0 ? 1.0 / std::sqrt(matrix(i, i)) : 0.0;
    }
    for (int i = 0; i < Size; ++i) {
        for (int j = 0; j < i; ++j) {
            const double unlike = std::fabs(matrix(i, j) - matrix(j, i));
            const double size = std::sqrt(matrix(i, i)) * std::sqrt(matrix(j, j));
            if (!(unlike <= SYMMETRY_TOLERANCE * size)) {
                return opms_fail(err, OPMS_ERR_ARG, "pose", i * Size + j,
                                 "camera->%s is not symmetric", name);
            }
            if (!(std::fabs(matrix(i, j)) <= size * (1.0 + SYMMETRY_TOLERANCE))) {
                return opms_fail(err, OPMS_ERR_ARG, "pose", i * Size + j,
                                 "camera->%s holds a correlation above 1", name);
            }
        }
    }
    RowMajor<Size, Size> correlation = unit.asDiagonal() * matrix * unit.asDiagonal();
    if (!has_no_negative_direction(correlation.data(), Size)) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1,
                         "camera->%s has a negative variance in some direction", name);
    }
    return OPMS_OK;
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
        OPMS_TRY(check_covariance<8>(camera.covariance_intrinsics, "covariance_intrinsics", err));
    }
    if (camera.has_detector_camera) {
        OPMS_TRY(check_transform(camera.detector_camera, "camera->detector_camera", err));
    }
    if (camera.has_covariance_detector_camera) {
        OPMS_TRY(check_covariance<6>(camera.covariance_detector_camera,
                                     "covariance_detector_camera", err));
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
