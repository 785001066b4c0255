/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms.expect: how exact a position will be. */
#include "py_handle.h"

namespace {

using namespace nb::literals;

opms_expectation_t expect_pose(const opms_camera_t &camera, const opms_transform_t &ground_detector,
                               double bar_tilt_rad, double contrast, double noise, double blur_px,
                               double min_square_px)
{
    opms_expect_options_t options;
    opms_expect_options_init(&options);
    options.bar_tilt_rad = bar_tilt_rad;
    options.contrast = contrast;
    options.noise = noise;
    options.blur_px = blur_px;
    options.min_square_px = min_square_px;
    opms_expectation_t expectation = {};
    py_call([&](opms_error_t *err) {
        return opms_expect_pose(&camera, &ground_detector, &options, &expectation, err);
    });
    return expectation;
}

} // namespace

void py_bind_expect(nb::module_ &module)
{
    using Expectation = opms_expectation_t;
    nb::class_<Expectation>(module, "Expectation",
                            R"(What is to be expected of the detector's pose at one place.

The covariances are those of the detector's (w, d) as in Pose.covariance; they are independent, and
their sum is that of the pose.)")
        .def_ro("state", &Expectation::state,
                "A PoseState; unless it is FOUND too little of the bar is in the picture.")
        .def_ro("square_count", &Expectation::square_count,
                "Squares of the bar that are whole in the picture.")
        .def_prop_ro(
            "covariance_image",
            [](Expectation &self) { return py_view<6, 6>(self, self.covariance_image); },
            "From the image noise alone, (6, 6), read only, in rad and m.")
        .def_prop_ro(
            "covariance_calibration",
            [](Expectation &self) { return py_view<6, 6>(self, self.covariance_calibration); },
            "From the calibration alone, (6, 6), read only; 0 where the camera holds none.");

    module.def("expect_pose", &expect_pose, "camera"_a, "ground_detector"_a, nb::kw_only(),
               "bar_tilt_rad"_a = 0.0, "contrast"_a = 150.0, "noise"_a = 3.0, "blur_px"_a = 0.75,
               "min_square_px"_a = 7.0,
               R"(Expected uncertainty of the detector's pose over a bar that lies in full view.

camera: with detector_camera; ground_detector: detector to ground, where the head is.
bar_tilt_rad: positive where the printed face is turned away from the operator. contrast: grey
levels from black to white; noise: standard deviation of the grey levels; blur_px: standard
deviation of the blur; min_square_px: squares with a shorter side do not count.
Raises Error (ERR_ARG, ERR_DOMAIN where the lens folds). Pure, any thread; releases the GIL.)");
}
