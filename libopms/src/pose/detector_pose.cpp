// SPDX-License-Identifier: Apache-2.0
// With b = bar, c = camera, d = detector, g = ground, and v = R_dc^T t_dc:
//   R_gd = R_gb R_bc R_dc^T,   t_gd = R_gb (t_bc - R_bc v).
// Perturb R_bc by Exp(w) and t_bc by d. Exp(w) R_dc^T = R_dc^T Exp(R_dc w), and to first order
// Exp(w) v = v - [v]x w:
//   w_gd = R_dc w,   d_gd = R_gb R_bc [v]x w + R_gb d.
// Perturb R_dc by Exp(e) and t_dc by f. (R_dc Exp(e))^T = Exp(-e) R_dc^T:
//   w_gd = -R_dc e,  d_gd = -R_gb R_bc [v]x e - R_gd f.
// Let the intrinsics be truly k further on. The fit answers with J k (intrinsics_jacobian), and the
// image noise n adds to it; with m = (e, f), and V and M as above,
//   (w_gd, d_gd) = V (n + J k) + M m.
// n is independent of the rest. m and k are not where the mounting was found through this lens:
// their covariance X = E[m k^T] adds V J X^T M^T and its transpose.
#include <opms/pose.h>

#include "base/fail.h"
#include "pose/camera_check.h"
#include "pose/pose_algebra.h"

namespace
{

using namespace opms::pose;

opms_status_t check_arguments(const opms_pose_result_t *bar_camera, const opms_camera_t *camera,
                              double bar_tilt_rad, const opms_pose_t *ground_detector,
                              opms_error_t *err)
{
    const char *missing = !bar_camera        ? "bar_camera"
                          : !camera          ? "camera"
                          : !ground_detector ? "ground_detector"
                                             : nullptr;
    if (missing) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1, "%s is NULL", missing);
    }
    if (bar_camera->state != OPMS_POSE_FOUND) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1, "bar_camera holds no pose: its state is %d",
                         static_cast<int>(bar_camera->state));
    }
    if (!camera->has_detector_camera) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1,
                         "camera does not say where it sits on the detector");
    }
    const double quarter_turn = 1.5707963267948968;
    if (!(std::fabs(bar_tilt_rad) <= quarter_turn)) {
        return opms_fail(err, OPMS_ERR_ARG, "pose", -1, "bar_tilt_rad is %g, not -pi/2 to pi/2",
                         bar_tilt_rad);
    }
    OPMS_TRY(check_transform(bar_camera->bar_camera.transform, "bar_camera", err));
    return check_camera_mounting(*camera, err);
}

} // namespace

opms_status_t opms_pose_detector(const opms_pose_result_t *bar_camera, const opms_camera_t *camera,
                                 double bar_tilt_rad, opms_pose_t *ground_detector,
                                 uint32_t *includes, opms_error_t *err)
{
    OPMS_TRY(check_arguments(bar_camera, camera, bar_tilt_rad, ground_detector, err));
    const Mat3 R_gb = Eigen::AngleAxisd(-bar_tilt_rad, Vec3::UnitY()).toRotationMatrix();
    const Mat3 R_bc = rotation_of(bar_camera->bar_camera.transform);
    const Vec3 t_bc = translation_of(bar_camera->bar_camera.transform);
    const Mat3 R_dc = rotation_of(camera->detector_camera);
    const Vec3 v = R_dc.transpose() * translation_of(camera->detector_camera);
    const Mat3 R_gd = R_gb * R_bc * R_dc.transpose();
    const Mat3 lever = R_gb * R_bc * skew(v);

    Mat6 by_view = Mat6::Zero();
    by_view.topLeftCorner<3, 3>() = R_dc;
    by_view.bottomLeftCorner<3, 3>() = lever;
    by_view.bottomRightCorner<3, 3>() = R_gb;

    uint32_t parts = OPMS_COVARIANCE_IMAGE;
    Mat6 view = Eigen::Map<const RowMajor<6, 6>>(bar_camera->bar_camera.covariance);
    const Mat68 slope = Eigen::Map<const RowMajor<6, 8>>(bar_camera->intrinsics_jacobian);
    if (camera->has_covariance_intrinsics) {
        const Eigen::Matrix<double, 8, 8> intrinsics =
            Eigen::Map<const RowMajor<8, 8>>(camera->covariance_intrinsics);
        view += slope.lazyProduct(intrinsics).eval().lazyProduct(slope.transpose());
        parts |= OPMS_COVARIANCE_INTRINSICS;
    }
    Mat6 covariance = by_view * view * by_view.transpose();
    if (camera->has_covariance_detector_camera) {
        Mat6 by_mounting = Mat6::Zero();
        by_mounting.topLeftCorner<3, 3>() = -R_dc;
        by_mounting.bottomLeftCorner<3, 3>() = -lever;
        by_mounting.bottomRightCorner<3, 3>() = -R_gd;
        const Mat6 mounting = Eigen::Map<const RowMajor<6, 6>>(camera->covariance_detector_camera);
        covariance += by_mounting * mounting * by_mounting.transpose();
        if (camera->has_covariance_detector_camera_intrinsics) {
            const Mat68 shared =
                Eigen::Map<const RowMajor<6, 8>>(camera->covariance_detector_camera_intrinsics);
            const Mat6 together = slope.lazyProduct(shared.transpose());
            const Mat6 cross = by_view * together * by_mounting.transpose();
            covariance += cross + cross.transpose();
        }
        parts |= OPMS_COVARIANCE_DETECTOR_CAMERA;
    }
    Eigen::Map<RowMajor<3, 3>>(ground_detector->transform.R) = R_gd;
    Eigen::Map<Vec3>(ground_detector->transform.t_m) = R_gb * (t_bc - R_bc * v);
    Eigen::Map<RowMajor<6, 6>>(ground_detector->covariance) =
        0.5 * (covariance + covariance.transpose());
    if (includes) {
        *includes = parts;
    }
    return OPMS_OK;
}
