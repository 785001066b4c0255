// SPDX-License-Identifier: Apache-2.0
// The handle: its memory, its pictures, and what is asked of a solution.
#include <opms/calib.h>

#include <cmath>
#include <cstring>
#include <new>

#include "base/fail.h"
#include "base/memory.h"
#include "calib/calib_covariance.h"
#include "calib/normal_equations.h"
#include "calib/plane_view.h"

#define STAGE "calib"

using namespace opms::calib;

namespace
{

opms_status_t check_options(const opms_calib_options_t &options, opms_error_t *err)
{
    if (options.struct_size != sizeof options) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "options->struct_size is %u: fill in by opms_calib_options_init()",
                         options.struct_size);
    }
    if (options.width_px < 16 || options.width_px > 16384 || options.height_px < 16 ||
        options.height_px > 16384) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "pictures of %d x %d, not 16 to 16384 px",
                         options.width_px, options.height_px);
    }
    if (options.pictures_max < 3 || options.pictures_max > OPMS_CALIB_PICTURES_MAX) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "pictures_max is %u, not 3 to %d",
                         options.pictures_max, OPMS_CALIB_PICTURES_MAX);
    }
    if (options.points_max < 4 || options.points_max > OPMS_CALIB_POINTS_MAX) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "points_max is %u, not 4 to %d",
                         options.points_max, OPMS_CALIB_POINTS_MAX);
    }
    if (!(options.cockle_sigma_m >= 0.0) || options.cockle_sigma_m > 1.0) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "cockle_sigma_m is %g, not 0 to 1 m",
                         options.cockle_sigma_m);
    }
    return opms_check_allocator(&options.allocator, STAGE, err);
}

/* One block: handle, pictures, then points, residuals and weights of each. Doubles throughout, so
 * that every part is aligned. */
struct Layout {
    size_t pictures, points, each, total;

    explicit Layout(const opms_calib_options_t &options)
    {
        const size_t unit = alignof(std::max_align_t);
        const auto up = [unit](size_t size) { return (size + unit - 1) / unit * unit; };
        pictures = up(sizeof(opms_calibrator));
        points = pictures + up(options.pictures_max * sizeof(Picture));
        each = up(options.points_max * (sizeof(opms_calib_point_t) + 3 * sizeof(double)));
        total = points + options.pictures_max * each;
    }
};

void lay_out(opms_calibrator &calibrator, char *memory, const Layout &layout)
{
    calibrator.pictures = reinterpret_cast<Picture *>(memory + layout.pictures);
    const size_t most = calibrator.options.points_max;
    for (uint32_t k = 0; k < calibrator.options.pictures_max; ++k) {
        Picture *picture = new (&calibrator.pictures[k]) Picture();
        char *const own = memory + layout.points + k * layout.each;
        picture->points = reinterpret_cast<opms_calib_point_t *>(own);
        picture->residuals = reinterpret_cast<double *>(own + most * sizeof(opms_calib_point_t));
        picture->weights = picture->residuals + 2 * most;
    }
}

opms_status_t check_points(const opms_calib_point_t *points, uint32_t count, opms_error_t *err)
{
    for (uint32_t i = 0; i < count; ++i) {
        const opms_calib_point_t &point = points[i];
        if (!std::isfinite(point.target_m[0]) || !std::isfinite(point.target_m[1]) ||
            !std::isfinite(point.px[0]) || !std::isfinite(point.px[1]) ||
            std::fabs(point.px[0]) > 1e6 || std::fabs(point.px[1]) > 1e6 ||
            std::fabs(point.target_m[0]) > 1e6 || std::fabs(point.target_m[1]) > 1e6) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i,
                             "point %u: target_m or px is not finite or absurd", i);
        }
        if (!(point.sigma_px > 1e-9) || !(point.sigma_px < 1e6)) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i,
                             "point %u: sigma_px is %g, not 1e-9 to 1e6", i, point.sigma_px);
        }
    }
    return OPMS_OK;
}

opms_status_t check_picture(const opms_calibrator_t *calibrator, uint32_t picture,
                            opms_error_t *err)
{
    if (!calibrator) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "calibrator is NULL");
    }
    if (picture >= calibrator->picture_count) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)picture, "picture %u of %u", picture,
                         calibrator->picture_count);
    }
    return OPMS_OK;
}

/* The lens's variances summed, each relative to `reference`'s. */
double relative_spread(const Mat8 &covariance, const Mat8 &reference)
{
    return covariance.diagonal().cwiseQuotient(reference.diagonal()).sum();
}

/* What all pictures say of the lens, and its inverse. A cockle counts as known: what one picture
 * says of the lens alone is kept for that case only. */
bool lens_information(const opms_calibrator_t &calibrator, Mat8 &all, Mat8 &covariance)
{
    if (!(calibrator.cockle_scale_m > 0.0)) {
        covariance = calibrator.covariance.topLeftCorner<LENS, LENS>();
        return invert_lens_information(covariance, all);
    }
    all.setZero();
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        if (in_use(calibrator.pictures[k])) {
            all += calibrator.pictures[k].information;
        }
    }
    return invert_lens_information(all, covariance);
}

/* Part of the lens's information that would be lost without a picture. */
double gain_of(const opms_calibrator_t &calibrator, const Picture &picture)
{
    Mat8 all, now, without;
    if (!lens_information(calibrator, all, now) ||
        !invert_lens_information(all - picture.information, without)) {
        return LENS; // nothing would be left
    }
    return LENS - relative_spread(now, without);
}

double tilt_of(const Picture &picture)
{
    // The optical axis in the target's frame is the last column; its normal is Z, either way.
    return std::acos(std::fmin(1.0, std::fabs(picture.pose.R(2, 2))));
}

void write_pose(const opms_calibrator_t &calibrator, const Picture &picture,
                opms_calib_picture_t &result)
{
    using opms::algebra::RowMajor;
    Eigen::Map<RowMajor<3, 3>>(result.target_camera.transform.R) = picture.pose.R;
    Eigen::Map<Vec3>(result.target_camera.transform.t_m) = picture.pose.t;
    Eigen::Map<RowMajor<6, 6>>(result.target_camera.covariance) =
        full_pose_covariance(calibrator, picture);
    Eigen::Map<RowMajor<6, LENS>>(result.covariance_with_lens) =
        pose_lens_covariance(calibrator, picture);
}

} // namespace

void opms_calib_options_init(opms_calib_options_t *options)
{
    *options = {};
    options->struct_size = sizeof *options;
    options->pictures_max = 64;
    options->points_max = 1485;
}

opms_status_t opms_calibrator_create(const opms_calib_options_t *options,
                                     opms_calibrator_t **calibrator, opms_error_t *err)
{
    if (!options || !calibrator) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         options ? "calibrator" : "options");
    }
    OPMS_TRY(check_options(*options, err));
    const Layout layout(*options);
    char *const memory = static_cast<char *>(opms_take(&options->allocator, layout.total));
    if (!memory) {
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for %zu bytes",
                         layout.total);
    }
    opms_calibrator_t *const made = new (memory) opms_calibrator();
    made->options = *options;
    lay_out(*made, memory, layout);
    *calibrator = made;
    return OPMS_OK;
}

void opms_calibrator_destroy(opms_calibrator_t *calibrator)
{
    if (calibrator) {
        opms_give_back(&calibrator->options.allocator, calibrator);
    }
}

opms_status_t opms_calibrator_add(opms_calibrator_t *calibrator, const opms_calib_point_t *points,
                                  uint32_t count, uint32_t *picture, opms_error_t *err)
{
    if (!calibrator || !points) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         calibrator ? "points" : "calibrator");
    }
    if (count < 4) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "%u points: a view of a plane needs 4", count);
    }
    if (count > calibrator->options.points_max ||
        calibrator->picture_count == calibrator->options.pictures_max) {
        return opms_fail(err, OPMS_ERR_CAPACITY, STAGE, -1,
                         "%u points in picture %u: the options allow %u in %u pictures", count,
                         calibrator->picture_count, calibrator->options.points_max,
                         calibrator->options.pictures_max);
    }
    OPMS_TRY(check_points(points, count, err));
    Picture &added = calibrator->pictures[calibrator->picture_count];
    std::memcpy(added.points, points, count * sizeof *points);
    added.count = count;
    added.switched_on = true;
    added.use = OPMS_CALIB_NOT_SOLVED;
    if (!fit_homography(calibrator->options, added)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "the points are no view of a plane, or lie in one line");
    }
    if (picture) {
        *picture = calibrator->picture_count;
    }
    ++calibrator->picture_count;
    return OPMS_OK;
}

opms_status_t opms_calibrator_use(opms_calibrator_t *calibrator, uint32_t picture, uint32_t used,
                                  opms_error_t *err)
{
    OPMS_TRY(check_picture(calibrator, picture, err));
    calibrator->pictures[picture].switched_on = used != 0;
    if (!used) {
        calibrator->pictures[picture].use = OPMS_CALIB_SWITCHED_OFF;
    } else if (calibrator->pictures[picture].use == OPMS_CALIB_SWITCHED_OFF) {
        calibrator->pictures[picture].use = OPMS_CALIB_NOT_SOLVED;
    }
    return OPMS_OK;
}

opms_status_t opms_calibrator_picture(const opms_calibrator_t *calibrator, uint32_t picture,
                                      opms_calib_picture_t *result, opms_error_t *err)
{
    OPMS_TRY(check_picture(calibrator, picture, err));
    if (!result) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "result is NULL");
    }
    const Picture &of = calibrator->pictures[picture];
    *result = {};
    result->use = of.use;
    result->points = of.count;
    if (of.use != OPMS_CALIB_USED) {
        return OPMS_OK;
    }
    double sum = 0.0;
    for (uint32_t i = 0; i < of.count; ++i) {
        const bool inlier = of.weights[i] >= INLIER_WEIGHT;
        result->outliers += inlier ? 0 : 1;
        sum += inlier ? of.residuals[2 * i] * of.residuals[2 * i] +
                            of.residuals[2 * i + 1] * of.residuals[2 * i + 1]
                      : 0.0;
    }
    const uint32_t inliers = of.count - result->outliers;
    result->residual_rms_px = inliers > 0 ? std::sqrt(sum / inliers) : 0.0;
    result->tilt_rad = tilt_of(of);
    result->gain = gain_of(*calibrator, of);
    write_pose(*calibrator, of, *result);
    return OPMS_OK;
}

opms_status_t opms_calibrator_residuals(const opms_calibrator_t *calibrator, uint32_t picture,
                                        double *residuals, double *weights, opms_error_t *err)
{
    OPMS_TRY(check_picture(calibrator, picture, err));
    if (!residuals) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "residuals is NULL");
    }
    const Picture &of = calibrator->pictures[picture];
    const bool used = of.use == OPMS_CALIB_USED;
    for (uint32_t i = 0; i < of.count; ++i) {
        residuals[2 * i] = used ? of.residuals[2 * i] : NAN;
        residuals[2 * i + 1] = used ? of.residuals[2 * i + 1] : NAN;
        if (weights) {
            weights[i] = used ? of.weights[i] : 0.0;
        }
    }
    return OPMS_OK;
}

opms_status_t opms_calibrator_choose(const opms_calibrator_t *calibrator, uint32_t count,
                                     uint32_t *chosen, uint32_t *chosen_count, opms_error_t *err)
{
    if (!calibrator || !chosen || !chosen_count) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "calibrator, chosen or chosen_count is NULL");
    }
    if (!calibrator->solved) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "there is no solution yet");
    }
    const Mat8 reference = calibrator->covariance.topLeftCorner<LENS, LENS>();
    // So little to begin with that no picture by itself need fix everything.
    Mat8 sum = Mat8::Zero();
    sum.diagonal() = 1e-6 * reference.diagonal().cwiseInverse();
    bool taken[OPMS_CALIB_PICTURES_MAX] = {};
    *chosen_count = 0;
    while (*chosen_count < count) {
        uint32_t best = calibrator->picture_count;
        double best_spread = HUGE_VAL;
        for (uint32_t k = 0; k < calibrator->picture_count; ++k) {
            Mat8 covariance;
            if (taken[k] || !in_use(calibrator->pictures[k]) ||
                !invert_lens_information(sum + calibrator->pictures[k].information, covariance)) {
                continue;
            }
            const double spread = relative_spread(covariance, reference);
            if (spread < best_spread) {
                best_spread = spread;
                best = k;
            }
        }
        if (best == calibrator->picture_count) {
            break;
        }
        taken[best] = true;
        sum += calibrator->pictures[best].information;
        chosen[(*chosen_count)++] = best;
    }
    return OPMS_OK;
}
