// SPDX-License-Identifier: Apache-2.0
// Is a lens that is stated with its covariance C the one that took these pictures?
//
// The poses are solved with the stated lens. With the poses eliminated, the points' gradient by the
// lens is G and their information I, both in stated sigmas. Where the lens is off by e, of
// covariance C, and the points' variance is v times the stated one, G has the covariance
//   v I + I C I,
// so G^T (v I + I C I)^-1 G is chi2 of 8. Directions that the pictures leave open have next to no
// gradient; a weak ridge keeps the matrix regular there and can only lower chi2. v comes from the
// residuals that are left when the lens is free, so that a wrong lens does not excuse itself.
#include <opms/calib.h>
#include <opms/lens.h>
#include <opms/pose.h>

#include <algorithm>
#include <cmath>

#include "algebra/spd.h"
#include "base/fail.h"
#include "calib/calib_correlation.h"
#include "calib/calib_covariance.h"
#include "calib/calib_sight.h"
#include "calib/calib_solve.h"
#include "calib/normal_equations.h"
#include "calib/plane_view.h"
#include "calib/pose_alone.h"

#define STAGE "calib"

using namespace opms::calib;
using opms::algebra::RowMajor;

namespace
{

using Vec8 = Eigen::Matrix<double, LENS, 1>;

constexpr int FREE_ROUNDS = 6;    // of moving the lens
constexpr int HALVINGS = 4;       // of a round's step
constexpr double SETTLED = 1e-2;  // promised fall of the cost, in sigma^2
// Noncentralities whose chi2 exceeds the limits 19 times of 20.
constexpr double SHOWN = 40.0, SHOWN_MOUNTING = 36.5;
constexpr double FIT_LEAST = 0.5; // inliers a picture must have

/* Information of a prior that no lens in use would feel. */
Mat8 ridge_of(const opms_lens_t &lens)
{
    const double focal = 0.2 * lens.fx_px, centre = 0.1 * lens.width_px;
    const double sigmas[LENS] = {focal, focal, centre, centre, 0.5, 0.5, 0.05, 0.05};
    Mat8 ridge = Mat8::Zero();
    for (int i = 0; i < LENS; ++i) {
        ridge(i, i) = 1.0 / (sigmas[i] * sigmas[i]);
    }
    return ridge;
}

Mat8 lens_covariance(const opms_camera_t &camera)
{
    if (!camera.has_covariance_intrinsics) {
        return Mat8::Zero();
    }
    return Eigen::Map<const RowMajor<LENS, LENS>>(camera.covariance_intrinsics);
}

/* Poses of all pictures through the lens as it stands. */
void solve_poses(opms_calibrator &calibrator)
{
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        if (in_use(calibrator.pictures[k])) {
            solve_pose_alone(calibrator, calibrator.pictures[k]);
        }
    }
}

void write_residuals(opms_calibrator &calibrator, double scale)
{
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        if (in_use(picture)) {
            picture_residuals(picture, calibrator.shape, scale, 0.0, picture.residuals,
                              picture.weights);
        }
    }
}

/* Take the stated lens, and the pictures that it can have taken. false where there is none. */
bool start(opms_calibrator &calibrator, const opms_lens_t &lens)
{
    calibrator.solved = false;
    calibrator.shape = {};
    calibrator.shape.lens = lens;
    calibrator.cockle_scale_m = 0.0;
    const double focal = 0.5 * (lens.fx_px + lens.fy_px);
    uint32_t used = 0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        if (!picture.switched_on) {
            continue;
        }
        picture.use = OPMS_CALIB_USED;
        pose_from_homography(focal, picture);
        solve_pose_alone(calibrator, picture);
        if (!std::isfinite(picture_cost(picture, calibrator.shape, picture.pose, 1.0, 0.0, 1))) {
            picture.use = OPMS_CALIB_NO_FIT;
        }
        used += picture.use == OPMS_CALIB_USED ? 1 : 0;
    }
    return used > 0;
}

/* A picture most of whose points are far from the rest, seen through the lens that suits all best,
 * is none of this target. @return how many are left. */
uint32_t leave_out_strangers(opms_calibrator &calibrator)
{
    uint32_t used = 0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        if (!in_use(picture)) {
            continue;
        }
        const auto inliers = std::count_if(picture.weights, picture.weights + picture.count,
                                           [](double w) { return w >= INLIER_WEIGHT; });
        if ((double)inliers < FIT_LEAST * picture.count) {
            picture.use = OPMS_CALIB_NO_FIT;
        }
        used += picture.use == OPMS_CALIB_USED ? 1 : 0;
    }
    return used;
}

/* What the pictures say of the lens where it stands. */
struct Say {
    Vec8 gradient;
    Mat8 information;
};

bool listen(opms_calibrator &calibrator, double scale, double variance, Say &say)
{
    if (!solve_covariance(calibrator, scale, variance, false)) {
        return false;
    }
    say.gradient.setZero();
    say.information.setZero();
    PictureEquations equations;
    equations.size = LENS;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        if (!in_use(picture)) {
            continue;
        }
        sum_equations(picture, calibrator.shape, picture.pose, scale, 0.0, 1, Weights::Inliers,
                      equations);
        const Eigen::Map<const Vec8> by_lens(equations.shared_gradient);
        say.gradient += by_lens;
        for (int i = 0; i < LENS; ++i) {
            say.gradient[i] -= picture.slope.col(i).dot(equations.pose_gradient);
        }
        say.information += variance * picture.information;
    }
    return say.gradient.allFinite() && say.information.allFinite();
}

double cost_of(const opms_calibrator &calibrator, double scale)
{
    double cost = 0.0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        if (in_use(picture)) {
            cost += picture_cost(picture, calibrator.shape, picture.pose, scale, 0.0, 1);
        }
    }
    return cost;
}

/* Try a step of the lens, and shorter ones; false where none is better. */
bool move_lens(opms_calibrator &calibrator, Vec8 step, double scale)
{
    const Shape before = calibrator.shape;
    const double cost = cost_of(calibrator, scale);
    for (int i = 0; i < HALVINGS; ++i, step *= 0.5) {
        calibrator.shape = before;
        add_to(calibrator.shape.lens, step.data());
        if (opms_lens_check(&calibrator.shape.lens, nullptr) != OPMS_OK) {
            continue;
        }
        solve_poses(calibrator);
        if (cost_of(calibrator, scale) < cost) {
            return true;
        }
    }
    calibrator.shape = before;
    solve_poses(calibrator);
    return false;
}

Vec8 parameters(const opms_lens_t &lens)
{
    Vec8 values;
    values << lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, lens.k1, lens.k2, lens.p1, lens.p2;
    return values;
}

/* Let the lens follow the points as far as they pull. */
void free_lens(opms_calibrator &calibrator, const opms_lens_t &stated, const Mat8 &ridge)
{
    for (int round = 0; round < FREE_ROUNDS; ++round) {
        const double scale = residual_scale(calibrator, 1);
        Say say;
        Mat8 inverse;
        if (!listen(calibrator, scale, 1.0, say) ||
            !invert_lens_information(say.information + ridge, inverse)) {
            return;
        }
        const Vec8 moved = parameters(calibrator.shape.lens) - parameters(stated);
        const Vec8 pull = say.gradient + ridge.lazyProduct(moved);
        const Vec8 step = -inverse.lazyProduct(pull);
        if (-step.dot(pull) < SETTLED || !move_lens(calibrator, step, scale)) {
            return;
        }
    }
}

/* Sums over the inliers of all pictures in use. */
struct Sums {
    uint32_t pictures, points, outliers;
    double px2, sigmas2;
};

Sums sums_of(const opms_calibrator &calibrator)
{
    Sums sums = {};
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        if (!in_use(picture)) {
            continue;
        }
        ++sums.pictures;
        for (uint32_t i = 0; i < picture.count; ++i) {
            const double *r = picture.residuals + 2 * i;
            const double length2 = r[0] * r[0] + r[1] * r[1];
            const double sigma = picture.points[i].sigma_px;
            const bool inlier = picture.weights[i] >= INLIER_WEIGHT;
            sums.points += inlier ? 1 : 0;
            sums.outliers += inlier ? 0 : 1;
            sums.px2 += inlier ? length2 : 0.0;
            sums.sigmas2 += inlier ? length2 / (sigma * sigma) : 0.0;
        }
    }
    return sums;
}

double rms_of(const Sums &sums)
{
    return std::sqrt(sums.px2 / std::max(1U, sums.points));
}

/* Variance of the points over the stated one, as the lens left free shows it; never below 1. */
double variance_of(const opms_calibrator &calibrator, const Sums &sums)
{
    const double freedom = std::max(1.0, 2.0 * sums.points - 6.0 * sums.pictures - LENS);
    return std::max(1.0, sums.sigmas2 / freedom / INLIER_VARIANCE *
                             residual_correlation(calibrator));
}

/* The poses of the stated lens, kept while the lens is let free. */
void swap_poses(opms_calibrator &calibrator, bool put_back)
{
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        (put_back ? picture.pose : picture.trial) = put_back ? picture.trial : picture.pose;
    }
}

/* How far a change would stand out: in what is expected where there is none. */
double distance(const Vec8 &change, const Say &say, const Mat8 &inverse)
{
    const Vec8 gradient = say.information.lazyProduct(change);
    return gradient.dot(inverse.lazyProduct(gradient));
}

void write_shown(const opms_lens_t &lens, const Say &say, const Mat8 &inverse,
                 opms_calib_lens_check_t &result)
{
    const auto smallest = [&](const Vec8 &unit) {
        const double seen = distance(unit, say, inverse);
        return seen > 0.0 ? std::sqrt(SHOWN / seen) : HUGE_VAL;
    };
    Vec8 focal = Vec8::Zero();
    focal[0] = lens.fx_px;
    focal[1] = lens.fy_px;
    result.shows_focal = smallest(focal);
    result.shows_centre_px[0] = smallest(Vec8::Unit(2));
    result.shows_centre_px[1] = smallest(Vec8::Unit(3));
}

opms_status_t judge_lens(opms_calibrator &calibrator, const opms_camera_t &camera,
                         double &variance, opms_calib_lens_check_t &result, opms_error_t *err)
{
    const Mat8 ridge = ridge_of(camera.lens);
    swap_poses(calibrator, false);
    free_lens(calibrator, camera.lens, ridge);
    double scale = residual_scale(calibrator, 1);
    write_residuals(calibrator, scale);
    if (leave_out_strangers(calibrator) == 0) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "no picture is a view of the target through a lens like this");
    }
    const Sums free = sums_of(calibrator);
    variance = variance_of(calibrator, free);
    result.residual_free_rms_px = rms_of(free);
    result.noise_factor = std::sqrt(variance);

    swap_poses(calibrator, true);
    calibrator.shape.lens = camera.lens;
    scale = residual_scale(calibrator, 1);
    write_residuals(calibrator, scale);
    const Sums stated = sums_of(calibrator);
    result.pictures_used = stated.pictures;
    result.points_used = stated.points;
    result.outliers = stated.outliers;
    result.residual_rms_px = rms_of(stated);

    Say say;
    Mat8 answer, inverse;
    const bool heard = listen(calibrator, scale, variance, say);
    const Mat8 expected = variance * (say.information + ridge) +
                          say.information.lazyProduct(
                              lens_covariance(camera).lazyProduct(say.information).eval());
    if (!heard || !invert_lens_information(say.information + ridge, answer) ||
        !invert_lens_information(0.5 * (expected + expected.transpose()), inverse)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "the points leave the poses open");
    }
    const Vec8 change = -answer.lazyProduct(say.gradient);
    std::copy(change.data(), change.data() + LENS, result.change);
    result.chi2 = say.gradient.dot(inverse.lazyProduct(say.gradient));
    write_shown(camera.lens, say, inverse, result);
    calibrator.covariance.setZero();
    calibrator.covariance.topLeftCorner<LENS, LENS>() = lens_covariance(camera);
    return OPMS_OK;
}

/* The pose's error is n - slope k where the lens is truly k further on, and the mounting's own is
 * shared with k: both go into the difference of two mountings. */
opms_status_t judge_mounting(const opms_calibrator &calibrator, const opms_camera_t &camera,
                             const opms_footprint_t &footprint,
                             opms_calib_mounting_check_t &result, opms_error_t *err)
{
    const Picture &picture = calibrator.pictures[footprint.picture];
    const Sight sight = sight_of(picture, footprint);
    Rigid stated;
    stated.R = opms::algebra::rotation_of(camera.detector_camera);
    stated.t = opms::algebra::translation_of(camera.detector_camera);
    const Vec6 change = rigid_difference(stated, sight.detector_camera);
    Mat6 covariance = placing_covariance(picture, footprint, sight);
    const Eigen::Matrix<double, 6, LENS> by_lens =
        -sight.by_pose.lazyProduct(picture.slope.leftCols<LENS>());
    covariance += by_lens.lazyProduct(
        lens_covariance(camera).lazyProduct(by_lens.transpose()).eval());
    if (camera.has_covariance_detector_camera) {
        covariance += Eigen::Map<const RowMajor<6, 6>>(camera.covariance_detector_camera);
    }
    if (camera.has_covariance_detector_camera_intrinsics) {
        const Eigen::Map<const RowMajor<6, LENS>> shared(
            camera.covariance_detector_camera_intrinsics);
        const Mat6 cross = shared.lazyProduct(by_lens.transpose());
        covariance -= cross + cross.transpose();
    }
    covariance = (0.5 * (covariance + covariance.transpose())).eval();
    Mat6 inverse = covariance;
    if (!spd_invert(inverse.data(), 6, SPD_PIVOT_LEAST)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "a mounting's covariance is singular");
    }
    Eigen::Map<RowMajor<3, 3>>(result.detector_camera.R) = sight.detector_camera.R;
    Eigen::Map<Vec3>(result.detector_camera.t_m) = sight.detector_camera.t;
    Eigen::Map<Vec6>(result.change) = change;
    Eigen::Map<RowMajor<6, 6>>(result.covariance) = covariance;
    result.chi2 = change.dot(inverse.lazyProduct(change));
    for (int axis = 0; axis < 3; ++axis) {
        // A turn about the detector's axis, by the camera's own: w = R_dc^T axis.
        const Vec3 turn = stated.R.row(axis);
        const Mat3 by_turn = inverse.topLeftCorner<3, 3>();
        result.shows_turn_rad[axis] = std::sqrt(SHOWN_MOUNTING / turn.dot(by_turn * turn));
        result.shows_shift_m[axis] = std::sqrt(SHOWN_MOUNTING / inverse(3 + axis, 3 + axis));
    }
    return OPMS_OK;
}

opms_status_t check_arguments(const opms_calibrator_t *calibrator, const opms_camera_t *camera,
                              const opms_footprint_t *footprints, uint32_t count,
                              const opms_calib_lens_check_t *lens,
                              const opms_calib_mounting_check_t *mountings, opms_error_t *err)
{
    if (!calibrator || !camera || !lens || (count > 0 && (!footprints || !mountings))) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "calibrator, camera, footprints, lens or mountings is NULL");
    }
    OPMS_TRY(opms_camera_check(camera, err));
    if (camera->lens.width_px != calibrator->options.width_px ||
        camera->lens.height_px != calibrator->options.height_px) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "the camera's pictures are %d x %d px, these are %d x %d",
                         camera->lens.width_px, camera->lens.height_px,
                         calibrator->options.width_px, calibrator->options.height_px);
    }
    if (count > 0 && !camera->has_detector_camera) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "camera does not say where it sits on the detector");
    }
    for (uint32_t i = 0; i < count; ++i) {
        OPMS_TRY(check_placing(footprints[i], i, err));
        if (footprints[i].picture >= calibrator->picture_count) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i,
                             "footprint %u: there is no picture %u", i, footprints[i].picture);
        }
    }
    return OPMS_OK;
}

} // namespace

opms_status_t opms_calibrator_check(opms_calibrator_t *calibrator, const opms_camera_t *camera,
                                    const opms_footprint_t *footprints, uint32_t count,
                                    opms_calib_lens_check_t *lens,
                                    opms_calib_mounting_check_t *mountings, opms_error_t *err)
{
    OPMS_TRY(check_arguments(calibrator, camera, footprints, count, lens, mountings, err));
    if (!start(*calibrator, camera->lens)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "no picture is a view of the target through a lens like this");
    }
    opms_calib_lens_check_t result = {};
    double variance = 1.0;
    OPMS_TRY(judge_lens(*calibrator, *camera, variance, result, err));
    for (uint32_t i = 0; i < count; ++i) {
        if (!in_use(calibrator->pictures[footprints[i].picture])) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i,
                             "footprint %u: picture %u is no view of the target", i,
                             footprints[i].picture);
        }
        OPMS_TRY(judge_mounting(*calibrator, *camera, footprints[i], mountings[i], err));
    }
    *lens = result;
    return OPMS_OK;
}
