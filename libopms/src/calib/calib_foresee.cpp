// SPDX-License-Identifier: Apache-2.0
// The information of a picture does not depend on what noise does to its points, so it is known
// before the picture is taken: the equations are summed up at the points' calculated places, the
// pose is eliminated, and the rest is added to what the other pictures say.
#include <opms/calib.h>
#include <opms/lens.h>

#include <algorithm>
#include <cmath>

#include "algebra/spd.h"
#include "base/fail.h"
#include "calib/calib_covariance.h"

#define STAGE "calib"

using namespace opms::calib;

namespace
{

constexpr uint32_t CHUNK = 128; // points that are summed up at a time, on the stack
constexpr uint32_t POINTS_LEAST = 4;

/* Standard deviation whose information is the mean of that of the points used. */
double usual_sigma_px(const opms_calibrator &calibrator)
{
    double information = 0.0;
    uint32_t count = 0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        for (uint32_t i = 0; in_use(picture) && i < picture.count; ++i, ++count) {
            information += 1.0 / (picture.points[i].sigma_px * picture.points[i].sigma_px);
        }
    }
    return std::sqrt(std::max(1U, count) / information);
}

bool in_picture(const opms_lens_t &lens, const double *px)
{
    return px[0] >= 0.0 && px[1] >= 0.0 && px[0] <= lens.width_px - 1 &&
           px[1] <= lens.height_px - 1;
}

/* Where the lens has a point of the target; false where it is not in the picture. */
bool look(const opms_calibrator &calibrator, const Rigid &pose, opms_calib_point_t &point)
{
    const Vec3 target(point.target_m[0], point.target_m[1],
                      target_height(calibrator.shape, calibrator.cockle_scale_m, point.target_m[0],
                                    point.target_m[1]));
    const Vec3 camera = pose.R.transpose() * (target - pose.t);
    return opms_lens_project(&calibrator.result.lens, camera.data(), point.px, nullptr, nullptr,
                             nullptr) == OPMS_OK &&
           in_picture(calibrator.result.lens, point.px);
}

void add_to(PictureEquations &sum, const PictureEquations &part)
{
    const int size = sum.size;
    for (int i = 0; i < size * size; ++i) {
        sum.shared[i] += part.shared[i];
    }
    for (int i = 0; i < 6 * size; ++i) {
        sum.coupling[i] += part.coupling[i];
    }
    sum.pose += part.pose;
}

/* Equations of the whole view; returns how many points it has. */
uint32_t sum_view(const opms_calibrator &calibrator, const opms_calib_view_t &view,
                  PictureEquations &sum)
{
    opms_calib_point_t points[CHUNK];
    Picture part = {};
    part.points = points;
    part.pose = {opms::algebra::rotation_of(view.target_camera),
                 opms::algebra::translation_of(view.target_camera)};
    const double sigma_px = view.sigma_px > 0.0 ? view.sigma_px : usual_sigma_px(calibrator);
    uint32_t seen = 0;
    for (uint32_t i = 0; i < view.count; ++i) {
        opms_calib_point_t &point = points[part.count];
        point = {{view.target_m[2 * i], view.target_m[2 * i + 1]}, {0.0, 0.0}, sigma_px};
        part.count += look(calibrator, part.pose, point) ? 1 : 0;
        if (part.count > 0 && (part.count == CHUNK || i + 1 == view.count)) {
            PictureEquations equations;
            equations.size = sum.size;
            sum_equations(part, calibrator.shape, part.pose, 1.0, calibrator.cockle_scale_m, 1,
                          Weights::Inliers, equations);
            add_to(sum, equations);
            seen += part.count;
            part.count = 0;
        }
    }
    return seen;
}

/* The shared unknowns' covariance with the view; false where nothing would change. */
bool covariance_with(const opms_calibrator &calibrator, const opms_calib_view_t &view,
                     uint32_t &points, MatShared &covariance)
{
    PictureEquations sum = {};
    sum.size = calibrator.cockle_scale_m > 0.0 ? SHARED : LENS;
    sum.pose.setZero();
    points = sum_view(calibrator, view, sum);
    double total[SHARED * SHARED];
    const int size = sum.size;
    for (int i = 0; i < size * size; ++i) {
        total[i] = calibrator.covariance(i / size, i % size);
    }
    Picture taken = {};
    if (points < POINTS_LEAST || !spd_invert(total, size, COVARIANCE_PIVOT_LEAST) ||
        !add_information(taken, sum, calibrator.variance, total) ||
        !spd_invert(total, size, COVARIANCE_PIVOT_LEAST)) {
        return false;
    }
    for (int i = 0; i < size * size; ++i) {
        covariance(i / size, i % size) = total[i];
    }
    return true;
}

opms_status_t check_view(const opms_calib_view_t &view, opms_error_t *err)
{
    if (!view.target_m || view.count == 0 || (view.footprint_count > 0 && !view.footprints)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "view has no %s",
                         view.target_m && view.count > 0 ? "footprints" : "points");
    }
    if (!(view.sigma_px >= 0.0) || !(view.sigma_px < 1e6)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "view's sigma_px is %g", view.sigma_px);
    }
    const Mat3 R = opms::algebra::rotation_of(view.target_camera);
    if (!opms::algebra::translation_of(view.target_camera).allFinite() ||
        !((R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff() < 1e-6)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "view's target_camera is no pose");
    }
    for (uint32_t i = 0; i < view.count; ++i) {
        if (!std::isfinite(view.target_m[2 * i]) || !std::isfinite(view.target_m[2 * i + 1])) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i,
                             "view's point %u is not finite", i);
        }
    }
    return OPMS_OK;
}

} // namespace

opms_status_t opms_calibrator_foresee(const opms_calibrator_t *calibrator,
                                      const opms_calib_view_t *view,
                                      opms_calib_foresight_t *foresight, opms_error_t *err)
{
    if (!calibrator || !view || !foresight) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "calibrator, view or foresight is NULL");
    }
    if (!calibrator->solved) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "there is no solution yet");
    }
    OPMS_TRY(check_view(*view, err));
    // The pictures and what they say stay; only how sure the shared unknowns are is another.
    opms_calibrator then = *calibrator;
    *foresight = {};
    if (covariance_with(*calibrator, *view, foresight->points, then.covariance)) {
        for (int i = 0; i < LENS; ++i) {
            foresight->gain += 1.0 - then.covariance(i, i) / calibrator->covariance(i, i);
            for (int j = 0; j < LENS; ++j) {
                then.result.covariance[i * LENS + j] = then.covariance(i, j);
            }
        }
    }
    opms_camera_t &camera = foresight->camera;
    if (view->footprint_count > 0) {
        return opms_calibrator_camera(&then, view->footprints, view->footprint_count, &camera,
                                      err);
    }
    camera.lens = then.result.lens;
    std::copy(then.result.covariance, then.result.covariance + LENS * LENS,
              camera.covariance_intrinsics);
    camera.has_covariance_intrinsics = 1;
    return OPMS_OK;
}
