// SPDX-License-Identifier: Apache-2.0
// Where the lens is not quite the model's, or the target not quite flat, residuals of one part of
// the picture (or of the target) are alike, in all pictures. Many points are then worth fewer:
// sums over such parts vary by a factor more than those of independent residuals (the design
// effect of sampling by clusters; Kish, Survey Sampling, 1965). Parts of two sizes are looked at,
// and the largest factor counts.
#include "calib/calib_correlation.h"

#include <algorithm>

#include "calib/normal_equations.h"

namespace opms::calib
{

namespace
{

constexpr int PARTS_MOST = 12;

/* Of what the parts are, and how many each way. */
struct Partition {
    bool of_target;
    int parts;
};

constexpr Partition PARTITIONS[] = {{false, 6}, {false, 12}, {true, 6}, {true, 12}};

/* Box around what is to be parted. */
struct Extent {
    double low[2], size[2];
};

Extent picture_extent(const opms_calibrator &calibrator)
{
    return {{-0.5, -0.5},
            {(double)calibrator.options.width_px, (double)calibrator.options.height_px}};
}

Extent target_extent(const opms_calibrator &calibrator)
{
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        for (uint32_t i = 0; in_use(picture) && i < picture.count; ++i) {
            for (int axis = 0; axis < 2; ++axis) {
                low[axis] = std::min(low[axis], picture.points[i].target_m[axis]);
                high[axis] = std::max(high[axis], picture.points[i].target_m[axis]);
            }
        }
    }
    return {{low[0], low[1]}, {high[0] - low[0], high[1] - low[1]}};
}

int part_of(const Extent &extent, const double *at, int parts)
{
    int index = 0;
    for (int axis = 0; axis < 2; ++axis) {
        const int part = (int)((at[axis] - extent.low[axis]) / extent.size[axis] * parts);
        index = index * parts + std::min(parts - 1, std::max(0, part));
    }
    return index;
}

double factor_of(const opms_calibrator &calibrator, const Extent &extent, Partition partition)
{
    double sums[PARTS_MOST * PARTS_MOST][2] = {};
    double of_points = 0.0, of_sums = 0.0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        for (uint32_t i = 0; in_use(picture) && i < picture.count; ++i) {
            const opms_calib_point_t &point = picture.points[i];
            if (!(picture.weights[i] >= INLIER_WEIGHT)) {
                continue;
            }
            double *sum = sums[part_of(extent, partition.of_target ? point.target_m : point.px,
                                       partition.parts)];
            for (int axis = 0; axis < 2; ++axis) {
                const double z = picture.residuals[2 * i + axis] / point.sigma_px;
                sum[axis] += z;
                of_points += z * z;
            }
        }
    }
    for (const auto &sum : sums) {
        of_sums += sum[0] * sum[0] + sum[1] * sum[1];
    }
    return of_points > 0.0 ? of_sums / of_points : 1.0;
}

} // namespace

double residual_correlation(const opms_calibrator &calibrator)
{
    const Extent picture = picture_extent(calibrator), target = target_extent(calibrator);
    double factor = 1.0;
    for (const Partition &partition : PARTITIONS) {
        factor = std::max(
            factor, factor_of(calibrator, partition.of_target ? target : picture, partition));
    }
    return factor;
}

} // namespace opms::calib
