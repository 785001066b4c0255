/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What opms.calib takes and gives besides numbers. */
#include "py_convert.h"
#include "py_fields.h"

namespace {

/** The OPMS_CALIB_ bits of a result as Python's opms.calib.Warning. */
enum PyCalibWarning : uint32_t {};

void bind_enums(nb::module_ &module)
{
    const auto bit = [](uint32_t value) { return static_cast<PyCalibWarning>(value); };
    nb::enum_<PyCalibWarning>(module, "CalibWarning", nb::is_flag(),
                              "What the pictures do not fix well enough.")
        .value("ALL_PARALLEL", bit(OPMS_CALIB_ALL_PARALLEL),
               "The target's normal has nearly one direction in all pictures.")
        .value("FEW_PICTURES", bit(OPMS_CALIB_FEW_PICTURES), "Fewer than 5.")
        .value("POOR_COVERAGE", bit(OPMS_CALIB_POOR_COVERAGE),
               "Much of the picture's border never held a point.")
        .value("FOCAL_OPEN", bit(OPMS_CALIB_FOCAL_OPEN), "Focal length no better than 1 %.")
        .value("CENTRE_OPEN", bit(OPMS_CALIB_CENTRE_OPEN),
               "Principal point no better than 2 % of the width.")
        .value("LARGE_RESIDUAL", bit(OPMS_CALIB_LARGE_RESIDUAL),
               "Residuals far beyond the stated sigmas.")
        .value("MANY_OUTLIERS", bit(OPMS_CALIB_MANY_OUTLIERS),
               "More than 5 % of the points do not agree.");

    nb::enum_<opms_calib_use_t>(module, "CalibUse", nb::is_arithmetic(),
                                "What became of one picture.")
        .value("USED", OPMS_CALIB_USED)
        .value("NOT_SOLVED", OPMS_CALIB_NOT_SOLVED,
               "No solution since it was added, or the last one failed.")
        .value("NO_PLANE", OPMS_CALIB_NO_PLANE, "Its points are no view of a plane.")
        .value("NO_FIT", OPMS_CALIB_NO_FIT, "A plane, but not seen by this camera.")
        .value("SWITCHED_OFF", OPMS_CALIB_SWITCHED_OFF, "By Calibrator.use().");
}

void bind_footprint(nb::module_ &module)
{
    py_bind_fields<opms_footprint_t>(
        module, "Footprint", "Where the detector's head stood on the target in one picture.",
        py_field("picture", &opms_footprint_t::picture, "Index of the picture."),
        py_field("x_m", &opms_footprint_t::x_m, "Head centre in the target's frame, X."),
        py_field("y_m", &opms_footprint_t::y_m, "Head centre in the target's frame, Y."),
        py_field("yaw_rad", &opms_footprint_t::yaw_rad, "Turn of the head about Z."),
        py_field("sigma_m", &opms_footprint_t::sigma_m,
                 "Standard deviation of the placing along X and along Y, >= 0."),
        py_field("sigma_rad", &opms_footprint_t::sigma_rad,
                 "Standard deviation of the yaw, >= 0."));
}

void bind_result(nb::module_ &module)
{
    using Result = opms_calib_result_t;
    nb::class_<Result>(module, "CalibResult", "A calibration.")
        .def_ro("lens", &Result::lens, "The lens.")
        .def_prop_ro(
            "covariance", [](Result &self) { return py_view<8, 8>(self, self.covariance); },
            "Covariance of fx fy cx cy k1 k2 p1 p2 in px and 1, (8, 8), read only.")
        .def_ro("pictures_used", &Result::pictures_used, "Pictures that fit.")
        .def_ro("points_used", &Result::points_used, "Points with a weight of one quarter or more.")
        .def_ro("outliers", &Result::outliers, "The other points of the pictures used.")
        .def_prop_ro(
            "warnings", [](const Result &self) { return PyCalibWarning(self.warnings); },
            "What the pictures do not fix well enough, an opms.calib.Warning.")
        .def_ro("iterations", &Result::iterations, "Steps of the solution.")
        .def_ro("residual_rms_px", &Result::residual_rms_px,
                "RMS length of the residuals (u, v) of the points used.")
        .def_ro("chi2_dof", &Result::chi2_dof,
                "Mean square of the residuals over the stated sigmas.")
        .def_ro("coverage", &Result::coverage,
                "Part of 8 x 8 cells of the picture that held points.")
        .def_prop_ro(
            "cockle_m",
            [](Result &self) { return py_view<OPMS_CALIB_COCKLE_TERMS>(self, self.cockle_m); },
            R"(Heights of the target, (12,), read only, in metres.

Of the terms (X/s)^i (Y/s)^j with 2 <= i + j <= 4, where s is cockle_scale_m; 0 where none was
estimated.)")
        .def_ro("cockle_scale_m", &Result::cockle_scale_m,
                "Half the target's size, 0 where no cockle was estimated.")
        .def_ro("cockle_peak_m", &Result::cockle_peak_m,
                "Largest less smallest height over the target's points.");
}

void bind_picture(nb::module_ &module)
{
    using Picture = opms_calib_picture_t;
    nb::class_<Picture>(module, "CalibPicture", "One picture of a calibration.")
        .def_ro("use", &Picture::use, "A CalibUse; unless it is USED what follows is 0.")
        .def_ro("points", &Picture::points, "Points it was given.")
        .def_ro("outliers", &Picture::outliers, "Those with a weight below one quarter.")
        .def_prop_ro(
            "target_camera",
            [](Picture &self) {
                return self.use == OPMS_CALIB_USED ? &self.target_camera : nullptr;
            },
            nb::rv_policy::reference_internal, nb::sig("def target_camera(self) -> Pose | None"),
            "Camera to target, covariance with the lens's uncertainty; None unless USED.")
        .def_prop_ro(
            "covariance_with_lens",
            [](Picture &self) { return py_view<6, 8>(self, self.covariance_with_lens); },
            "Covariance of the pose's (w, d) and the lens's eight parameters, (6, 8), read only.")
        .def_ro("residual_rms_px", &Picture::residual_rms_px,
                "RMS length of the residuals of its points used.")
        .def_ro("tilt_rad", &Picture::tilt_rad,
                "Between the optical axis and the target's normal.")
        .def_ro("gain", &Picture::gain,
                R"(Part of the lens's information that would be lost without this picture.

Summed over its eight parameters; 1 is all of one parameter's.)");
}

void bind_foresight(nb::module_ &module)
{
    using Foresight = opms_calib_foresight_t;
    nb::class_<Foresight>(module, "CalibForesight", "What a further picture would do.")
        .def_ro("points", &Foresight::points, "Points of the target in the picture.")
        .def_ro("gain", &Foresight::gain,
                "Part of the lens's variances that would be gone, over its parameters: 0 to 8.")
        .def_ro("camera", &Foresight::camera,
                "The camera with that picture: unmoved, its covariances smaller.");
}

void bind_lens_check(nb::module_ &module)
{
    using Check = opms_calib_lens_check_t;
    nb::class_<Check>(module, "CalibLensCheck",
                      "What new pictures say of a lens that was calibrated before.")
        .def_ro("pictures_used", &Check::pictures_used, "Pictures that fit.")
        .def_ro("points_used", &Check::points_used, "Points with a weight of one quarter or more.")
        .def_ro("outliers", &Check::outliers, "The other points of the pictures used.")
        .def_ro("residual_rms_px", &Check::residual_rms_px,
                "RMS length of the residuals, the lens as stated.")
        .def_ro("residual_free_rms_px", &Check::residual_free_rms_px,
                "The same with the lens free: what the points are good for.")
        .def_ro("noise_factor", &Check::noise_factor,
                "Standard deviation of the points over the stated one, never below 1.")
        .def_ro("chi2", &Check::chi2,
                "Of 8: above opms.calib.CHI2_LENS the stated lens is wrong.")
        .def_prop_ro(
            "change", [](Check &self) { return py_view<8>(self, self.change); },
            "Of fx fy cx cy k1 k2 p1 p2, (8,), read only: what would explain the points.")
        .def_ro("shows_focal", &Check::shows_focal,
                "Smallest relative change of fx and fy that would show 19 times of 20.")
        .def_prop_ro(
            "shows_centre_px", [](Check &self) { return py_view<2>(self, self.shows_centre_px); },
            "The same of cx and cy, (2,), read only.");
}

void bind_mounting_check(nb::module_ &module)
{
    using Check = opms_calib_mounting_check_t;
    nb::class_<Check>(module, "CalibMountingCheck",
                      "What a picture on a footprint says of a mounting that was found before.")
        .def_ro("detector_camera", &Check::detector_camera,
                "Camera to detector as this picture has it, through the stated lens.")
        .def_prop_ro(
            "change", [](Check &self) { return py_view<6>(self, self.change); },
            "(w, d) from the stated mounting to this one, (6,), read only, in rad and m.")
        .def_prop_ro(
            "covariance", [](Check &self) { return py_view<6, 6>(self, self.covariance); },
            "Of the change where nothing moved, (6, 6), read only; the placing included.")
        .def_ro("chi2", &Check::chi2,
                "Of 6: above opms.calib.CHI2_MOUNTING the camera has moved.")
        .def_prop_ro(
            "shows_turn_rad", [](Check &self) { return py_view<3>(self, self.shows_turn_rad); },
            "Smallest turns about the detector's axes that would show 19 times of 20, (3,).")
        .def_prop_ro(
            "shows_shift_m", [](Check &self) { return py_view<3>(self, self.shows_shift_m); },
            "Smallest shifts along the detector's axes that would, (3,).");
}

} // namespace

void py_bind_calib_results(nb::module_ &module)
{
    bind_enums(module);
    bind_footprint(module);
    bind_result(module);
    bind_picture(module);
    bind_foresight(module);
    bind_lens_check(module);
    bind_mounting_check(module);
    module.attr("CALIB_CHI2_LENS") = OPMS_CALIB_CHI2_LENS;
    module.attr("CALIB_CHI2_MOUNTING") = OPMS_CALIB_CHI2_MOUNTING;
}
