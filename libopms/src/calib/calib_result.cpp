// SPDX-License-Identifier: Apache-2.0
// From pictures to a calibration: start, joint solution, which pictures do not belong, covariance,
// and what the pictures leave open.
#include <opms/calib.h>
#include <opms/lens.h>

#include <algorithm>
#include <cmath>

#include "base/fail.h"
#include "calib/calib_correlation.h"
#include "calib/calib_covariance.h"
#include "calib/calib_solve.h"
#include "calib/calib_start.h"
#include "calib/normal_equations.h"
#include "calib/plane_view.h"
#include "calib/pose_alone.h"

#define STAGE "calib"

using namespace opms::calib;

namespace
{

constexpr int ITERATIONS = 60;
constexpr int ROUNDS = 6;                  // of leaving out pictures that do not fit
constexpr double FIT_LEAST = 0.5;          // inliers a picture must have
constexpr uint32_t PICTURES_LEAST = 3;
constexpr int CELLS = 8;                   // of the picture, each way, for the coverage
constexpr double PARALLEL_RAD = 0.09;      // normals within 5 degrees
constexpr double PARALLEL_FOCAL = 3e-4;    // as well known as this, f is fixed in spite of it
constexpr double COVERAGE_LEAST = 0.6;
constexpr double FOCAL_OPEN = 0.01, CENTRE_OPEN = 0.02;
constexpr double RESIDUAL_LARGE = 9.0;     // chi2 per degree of freedom
constexpr double OUTLIERS_MANY = 0.05;

uint32_t count_in_use(const opms_calibrator &calibrator)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        count += in_use(calibrator.pictures[k]) ? 1 : 0;
    }
    return count;
}

/* Half the target's size: the unit of the cockle's terms. */
double half_size(const opms_calibrator &calibrator)
{
    double size = 0.0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        for (uint32_t i = 0; i < picture.count; ++i) {
            size = std::max({size, std::fabs(picture.points[i].target_m[0]),
                             std::fabs(picture.points[i].target_m[1])});
        }
    }
    return size;
}

/* Every picture takes part until it shows that it does not fit. */
bool take_all(opms_calibrator &calibrator)
{
    const double focal = 0.5 * (calibrator.shape.lens.fx_px + calibrator.shape.lens.fy_px);
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        if (!picture.switched_on) {
            continue;
        }
        if (calibrator.solved && picture.use != OPMS_CALIB_USED) {
            pose_from_homography(focal, picture);
            solve_pose_alone(calibrator, picture);
        }
        picture.use = OPMS_CALIB_USED;
    }
    return count_in_use(calibrator) >= PICTURES_LEAST;
}

void write_residuals(opms_calibrator &calibrator, double scale)
{
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        if (in_use(picture)) {
            picture_residuals(picture, calibrator.shape, scale, calibrator.cockle_scale_m,
                              picture.residuals, picture.weights);
        }
    }
}

double inlier_part(const Picture &picture)
{
    uint32_t inliers = 0;
    for (uint32_t i = 0; i < picture.count; ++i) {
        inliers += picture.weights[i] >= INLIER_WEIGHT ? 1 : 0;
    }
    return (double)inliers / picture.count;
}

/* The worst of the pictures that do not fit, if any; the others may fit once it has gone. */
bool leave_out_worst(opms_calibrator &calibrator)
{
    Picture *worst = nullptr;
    double least = FIT_LEAST;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        if (in_use(picture) && inlier_part(picture) < least) {
            least = inlier_part(picture);
            worst = &picture;
        }
    }
    if (worst) {
        worst->use = OPMS_CALIB_NO_FIT;
    }
    return worst != nullptr;
}

opms_status_t solve_all(opms_calibrator &calibrator, SolveEnd &end, opms_error_t *err)
{
    const bool with_cockle = calibrator.options.cockle_sigma_m > 0.0;
    if (!calibrator.solved) {
        calibrator.cockle_scale_m = 0.0;
    }
    if (!calibrator.solved && !start_solution(calibrator)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "no camera fits the pictures: is the target what it was said to be?");
    }
    calibrator.cockle_scale_m = with_cockle ? half_size(calibrator) : 0.0;
    for (int round = 0; round < ROUNDS; ++round) {
        const int before = end.iterations;
        end = solve_jointly(calibrator, {1, ITERATIONS, with_cockle});
        end.iterations += before;
        write_residuals(calibrator, end.scale);
        if (!leave_out_worst(calibrator)) {
            return OPMS_OK;
        }
        if (count_in_use(calibrator) < PICTURES_LEAST) {
            break;
        }
    }
    return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                     "fewer than %u pictures agree on one camera", PICTURES_LEAST);
}

/* Sums over all points that are used. */
struct Tally {
    uint32_t pictures, inliers, outliers;
    double px2, sigmas2;
};

Tally tally_of(const opms_calibrator &calibrator)
{
    Tally tally = {};
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        if (!in_use(picture)) {
            continue;
        }
        ++tally.pictures;
        for (uint32_t i = 0; i < picture.count; ++i) {
            if (!(picture.weights[i] >= INLIER_WEIGHT)) {
                ++tally.outliers;
                continue;
            }
            const double *r = picture.residuals + 2 * i;
            const double length2 = r[0] * r[0] + r[1] * r[1];
            const double sigma = picture.points[i].sigma_px;
            ++tally.inliers;
            tally.px2 += length2;
            tally.sigmas2 += length2 / (sigma * sigma);
        }
    }
    return tally;
}

double coverage_of(const opms_calibrator &calibrator)
{
    bool held[CELLS][CELLS] = {};
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        for (uint32_t i = 0; in_use(picture) && i < picture.count; ++i) {
            const double *px = picture.points[i].px;
            const int column = (int)std::floor((px[0] + 0.5) * CELLS / calibrator.options.width_px);
            const int row = (int)std::floor((px[1] + 0.5) * CELLS / calibrator.options.height_px);
            if (column >= 0 && column < CELLS && row >= 0 && row < CELLS) {
                held[row][column] = true;
            }
        }
    }
    int count = 0;
    for (const auto &row : held) {
        count += (int)std::count(row, row + CELLS, true);
    }
    return (double)count / (CELLS * CELLS);
}

/* Is the target's normal, as the camera sees it, nearly the same in all pictures? Such pictures
 * show one vanishing line, whatever the camera is turned about the normal. */
bool one_direction(const opms_calibrator &calibrator)
{
    double least = 1.0; // cosine
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        for (uint32_t l = 0; l < k && in_use(calibrator.pictures[k]); ++l) {
            if (in_use(calibrator.pictures[l])) {
                least = std::min(least, calibrator.pictures[k].pose.R.row(2).dot(
                                            calibrator.pictures[l].pose.R.row(2)));
            }
        }
    }
    return least > std::cos(PARALLEL_RAD);
}

uint32_t warnings_of(const opms_calibrator &calibrator, const opms_calib_result_t &result)
{
    const double width = calibrator.options.width_px;
    const auto sigma = [&](int i) { return std::sqrt(result.covariance[i * LENS + i]); };
    uint32_t warnings = 0;
    const auto warn = [&](bool is_so, uint32_t bit) { warnings |= is_so ? bit : 0; };
    warn(one_direction(calibrator) && (sigma(0) > PARALLEL_FOCAL * result.lens.fx_px ||
                                       sigma(1) > PARALLEL_FOCAL * result.lens.fy_px),
         OPMS_CALIB_ALL_PARALLEL);
    warn(result.pictures_used < 5, OPMS_CALIB_FEW_PICTURES);
    warn(result.coverage < COVERAGE_LEAST, OPMS_CALIB_POOR_COVERAGE);
    warn(sigma(0) > FOCAL_OPEN * result.lens.fx_px || sigma(1) > FOCAL_OPEN * result.lens.fy_px,
         OPMS_CALIB_FOCAL_OPEN);
    warn(sigma(2) > CENTRE_OPEN * width || sigma(3) > CENTRE_OPEN * width,
         OPMS_CALIB_CENTRE_OPEN);
    warn(result.chi2_dof > RESIDUAL_LARGE, OPMS_CALIB_LARGE_RESIDUAL);
    warn(result.outliers > OUTLIERS_MANY * (result.outliers + result.points_used),
         OPMS_CALIB_MANY_OUTLIERS);
    return warnings;
}

double cockle_peak(const opms_calibrator &calibrator)
{
    double low = 0.0, high = 0.0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        for (uint32_t i = 0; in_use(picture) && i < picture.count; ++i) {
            const double height =
                target_height(calibrator.shape, calibrator.cockle_scale_m,
                              picture.points[i].target_m[0], picture.points[i].target_m[1]);
            low = std::min(low, height);
            high = std::max(high, height);
        }
    }
    return high - low;
}

opms_status_t write_result(opms_calibrator &calibrator, const SolveEnd &end,
                           opms_calib_result_t &result, opms_error_t *err)
{
    const bool with_cockle = calibrator.cockle_scale_m > 0.0;
    const Tally tally = tally_of(calibrator);
    const int unknowns = (int)(with_cockle ? SHARED : LENS) + 6 * (int)tally.pictures;
    const double freedom = std::max(1.0, 2.0 * tally.inliers - unknowns);
    result = {};
    result.lens = calibrator.shape.lens;
    result.pictures_used = tally.pictures;
    result.points_used = tally.inliers;
    result.outliers = tally.outliers;
    result.iterations = (uint32_t)end.iterations;
    result.residual_rms_px = std::sqrt(tally.px2 / std::max(1U, tally.inliers));
    result.chi2_dof = tally.sigmas2 / freedom / INLIER_VARIANCE;
    calibrator.variance = result.chi2_dof * residual_correlation(calibrator);
    if (!solve_covariance(calibrator, end.scale, calibrator.variance, with_cockle)) {
        return opms_fail(
            err, OPMS_ERR_DOMAIN, STAGE, -1,
            "the pictures leave the camera undetermined: tilt the camera between them");
    }
    using opms::algebra::RowMajor;
    Eigen::Map<RowMajor<LENS, LENS>>(result.covariance) =
        calibrator.covariance.topLeftCorner<LENS, LENS>();
    result.coverage = coverage_of(calibrator);
    std::copy(calibrator.shape.cockle, calibrator.shape.cockle + OPMS_CALIB_COCKLE_TERMS,
              result.cockle_m);
    result.cockle_scale_m = calibrator.cockle_scale_m;
    result.cockle_peak_m = cockle_peak(calibrator);
    result.warnings = warnings_of(calibrator, result);
    opms_error_t why;
    if (opms_lens_check(&result.lens, &why) != OPMS_OK) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "no camera fits the pictures: %s",
                         why.message);
    }
    return OPMS_OK;
}

opms_status_t try_to_solve(opms_calibrator &calibrator, opms_calib_result_t &solution,
                           opms_error_t *err)
{
    if (!take_all(calibrator)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "%u pictures: a calibration needs %u",
                         count_in_use(calibrator), PICTURES_LEAST);
    }
    SolveEnd end = {};
    OPMS_TRY(solve_all(calibrator, end, err));
    OPMS_TRY(write_result(calibrator, end, solution, err));
    if (!end.converged) {
        return opms_fail(err, OPMS_ERR_CONVERGE, STAGE, -1, "no solution after %d iterations",
                         end.iterations);
    }
    return OPMS_OK;
}

/* No picture has a place in a solution that there is not. */
void forget_solution(opms_calibrator &calibrator)
{
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        if (in_use(calibrator.pictures[k])) {
            calibrator.pictures[k].use = OPMS_CALIB_NOT_SOLVED;
        }
    }
}

} // namespace

opms_status_t opms_calibrator_solve(opms_calibrator_t *calibrator, opms_calib_result_t *result,
                                    opms_error_t *err)
{
    if (!calibrator || !result) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         calibrator ? "result" : "calibrator");
    }
    opms_calib_result_t solution;
    const opms_status_t status = try_to_solve(*calibrator, solution, err);
    calibrator->solved = status == OPMS_OK; // a wrong place is no place to start the next from
    if (calibrator->solved) {
        calibrator->result = solution;
        *result = solution;
    } else {
        forget_solution(*calibrator);
    }
    return status;
}
