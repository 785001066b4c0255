/* SPDX-License-Identifier: Apache-2.0 */
#include "expected_volume.hpp"

#include <algorithm>
#include <cmath>

namespace {

PoseVariance diagonal_of(const double *covariance)
{
    PoseVariance variance;
    for (int i = 0; i < 3; i++) {
        variance.rotation_rad2[i] = covariance[7 * i];
        variance.position_m2[i] = covariance[7 * (i + 3)];
    }
    return variance;
}

/** What @p whole has more than @p part. */
PoseVariance rest_of(const PoseVariance &whole, const PoseVariance &part)
{
    PoseVariance rest;
    for (int i = 0; i < 3; i++) {
        rest.position_m2[i] = std::max(0.0, whole.position_m2[i] - part.position_m2[i]);
        rest.rotation_rad2[i] = std::max(0.0, whole.rotation_rad2[i] - part.rotation_rad2[i]);
    }
    return rest;
}

/** Running mean. */
void mix_in(PoseVariance &mean, const PoseVariance &one, uint32_t count)
{
    for (int i = 0; i < 3; i++) {
        mean.position_m2[i] += (one.position_m2[i] - mean.position_m2[i]) / count;
        mean.rotation_rad2[i] += (one.rotation_rad2[i] - mean.rotation_rad2[i]) / count;
    }
}

/** Pose of a level head, and the light's defaults. */
bool expect(const opms_camera_t &camera, const double *place_m, double bar_tilt_rad,
            opms_expectation_t &expectation)
{
    const opms_transform_t head = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                   {place_m[0], place_m[1], place_m[2]}};
    opms_expect_options_t options;
    opms_expect_options_init(&options);
    options.bar_tilt_rad = bar_tilt_rad;
    return opms_expect_pose(&camera, &head, &options, &expectation, nullptr) == OPMS_OK &&
           expectation.state == OPMS_POSE_FOUND;
}

}  // namespace

double PoseVariance::position_rms_m() const
{
    return std::sqrt(position_m2[0] + position_m2[1] + position_m2[2]);
}

double PoseVariance::rotation_rms_rad() const
{
    return std::sqrt(rotation_rad2[0] + rotation_rad2[1] + rotation_rad2[2]);
}

PoseVariance operator+(const PoseVariance &a, const PoseVariance &b)
{
    PoseVariance sum = a;
    for (int i = 0; i < 3; i++) {
        sum.position_m2[i] += b.position_m2[i];
        sum.rotation_rad2[i] += b.rotation_rad2[i];
    }
    return sum;
}

double ExpectedBox::place_m(int axis, int step) const
{
    return low_m[axis] + (high_m[axis] - low_m[axis]) * (step + 0.5) / steps[axis];
}

ExpectedBox expected_working_volume()
{
    return {{0.15, -0.5, 0.0}, {0.55, 0.5, 0.115}, {4, 5, 2}, 0};
}

ExpectedError expected_over(const opms_camera_t &camera, const opms_camera_t &placed,
                            const ExpectedBox &box)
{
    ExpectedError error;
    for (int i = 0; i < box.steps[0] * box.steps[1] * box.steps[2]; i++) {
        const double place_m[3] = {box.place_m(0, i % box.steps[0]),
                                   box.place_m(1, i / box.steps[0] % box.steps[1]),
                                   box.place_m(2, i / box.steps[0] / box.steps[1])};
        opms_expectation_t whole, part;
        error.places++;
        if (!expect(camera, place_m, box.bar_tilt_rad, whole)) {
            continue;
        }
        if (&placed == &camera) {
            part = whole;
        } else if (!expect(placed, place_m, box.bar_tilt_rad, part)) {
            continue;
        }
        error.places_seen++;
        const PoseVariance lens = diagonal_of(part.covariance_calibration);
        mix_in(error.image, diagonal_of(whole.covariance_image), error.places_seen);
        mix_in(error.lens, lens, error.places_seen);
        mix_in(error.placing, rest_of(diagonal_of(whole.covariance_calibration), lens),
               error.places_seen);
    }
    return error;
}
