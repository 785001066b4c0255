/* SPDX-License-Identifier: Apache-2.0 */
#include "calibrate_text.hpp"

#include <cmath>

#include "text_table.hpp"

namespace {

constexpr double DEG = 180 / 3.14159265358979323846;

constexpr CalibrateWarning WARNINGS[] = {
    {OPMS_CALIB_ALL_PARALLEL, "all_parallel",
     "The grid leans nearly the same way in all pictures, so an error of the focal length cannot "
     "be told from one of the heights. Turning the detector on the spot, or walking around the "
     "grid, does not help. Tilt the detector by 15 degrees or more to different sides and take "
     "more pictures."},
    {OPMS_CALIB_FEW_PICTURES, "few_pictures",
     "Fewer than 5 pictures were used. A dozen, at different heights and tilts, makes errors "
     "show."},
    {OPMS_CALIB_POOR_COVERAGE, "poor_coverage",
     "Much of the picture's border never held a node, so the lens is not measured there. Take "
     "pictures in which the grid reaches into each corner of the picture."},
    {OPMS_CALIB_FOCAL_OPEN, "focal_open",
     "The focal length is known no better than 1 %. Take more pictures with the detector tilted "
     "by 15 degrees or more to different sides, and some from closer."},
    {OPMS_CALIB_CENTRE_OPEN, "centre_open",
     "The principal point is known no better than 2 % of the picture's width. Take more pictures "
     "with the detector tilted, and turned about the vertical."},
    {OPMS_CALIB_LARGE_RESIDUAL, "large_residual",
     "The nodes lie further from the solution than they were measured well. Is the grid flat, was "
     "the detector still, and are all pictures of one camera whose focus was not touched?"},
    {OPMS_CALIB_MANY_OUTLIERS, "many_outliers",
     "More than 5 % of the nodes do not agree with the solution. Look at the pictures with the "
     "most outliers: reflections, something lying on the grid, folds, motion?"},
};

double sigma(const double *covariance, int n, int i)
{
    return std::sqrt(covariance[i * n + i]);
}

std::string lens_text(const opms_calib_result_t &calib)
{
    const opms_lens_t &lens = calib.lens;
    const double values[8] = {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px,
                              lens.k1,    lens.k2,    lens.p1,    lens.p2};
    const char *const names[8] = {"fx px", "fy px", "cx px", "cy px", "k1", "k2", "p1", "p2"};
    std::string text = "lens             value       sigma\n";
    for (int i = 0; i < 8; i++) {
        const int digits = i < 4 ? 3 : 6;
        text += text_format("  %-6s  %12.*f  %10.*f\n", names[i], digits, values[i], digits,
                            sigma(calib.covariance, 8, i));
    }
    return text;
}

std::string mounting_text(const opms_camera_t &camera)
{
    const opms_transform_t &mount = camera.detector_camera;
    const double *cov = camera.covariance_detector_camera;
    std::string text = "camera on the detector    X          Y          Z\n";
    text += text_format("  place mm       %10.2f %10.2f %10.2f\n", 1e3 * mount.t_m[0],
                        1e3 * mount.t_m[1], 1e3 * mount.t_m[2]);
    text += text_format("    sigma mm     %10.3f %10.3f %10.3f\n", 1e3 * sigma(cov, 6, 3),
                        1e3 * sigma(cov, 6, 4), 1e3 * sigma(cov, 6, 5));
    const char *const axes[3] = {"picture right", "picture down", "looking along"};
    for (int axis = 0; axis < 3; axis++) {
        text += text_format("  %-13s  %10.5f %10.5f %10.5f  turned about it: sigma %.4f deg\n",
                            axes[axis], mount.R[axis], mount.R[3 + axis], mount.R[6 + axis],
                            DEG * sigma(cov, 6, axis));
    }
    return text;
}

std::string expected_text(const ExpectedError &expected)
{
    if (expected.places_seen == 0) {
        return "expected position error: the bar is not in view over the working volume\n";
    }
    return text_format("expected position error, RMS over the working volume: %.2f mm, %.3f deg "
                       "(lens %.2f, placing on the footprint %.2f, noise of the picture %.2f mm)\n",
                       1e3 * expected.total().position_rms_m(),
                       DEG * expected.total().rotation_rms_rad(),
                       1e3 * expected.lens.position_rms_m(),
                       1e3 * expected.placing.position_rms_m(),
                       1e3 * expected.image.position_rms_m());
}

std::string picture_line(const CalibratePicture &picture, std::size_t width, bool has_solution)
{
    const std::string start = "  " + text_padded(picture.grid.image, width);
    if (!picture.left_out.empty()) {
        return start + "  left out: " + picture.left_out + "\n";
    }
    if (!has_solution) {
        return start + text_format("  %5zu\n", picture.grid.nodes.size());
    }
    return start + text_format("  %5u  %8u  %11.3f  %8.1f\n", picture.solved.points,
                               picture.solved.outliers, picture.solved.residual_rms_px,
                               DEG * picture.solved.tilt_rad);
}

std::string pictures_text(const CalibrateResult &result)
{
    std::vector<std::string> names;
    for (const CalibratePicture &picture : result.pictures) {
        names.push_back(picture.grid.image);
    }
    const std::size_t width = text_name_width(names);
    std::string text = "  " + text_padded("picture", width) +
                       (result.has_solution ? "  nodes  outliers  residual px  tilt deg\n"
                                            : "  nodes\n");
    for (const CalibratePicture &picture : result.pictures) {
        text += picture_line(picture, width, result.has_solution);
    }
    return text;
}

std::string summary_text(const opms_calib_result_t &calib)
{
    return text_format("%u pictures, %u nodes, %u outliers, residual %.4f px RMS (%.2f of the "
                       "stated sigmas), nodes in %.0f %% of the picture\n",
                       calib.pictures_used, calib.points_used, calib.outliers,
                       calib.residual_rms_px, std::sqrt(calib.chi2_dof), 100 * calib.coverage);
}

}  // namespace

std::vector<CalibrateWarning> calibrate_warnings(uint32_t bits)
{
    std::vector<CalibrateWarning> set;
    for (const CalibrateWarning &warning : WARNINGS) {
        if (bits & warning.bit) {
            set.push_back(warning);
        }
    }
    return set;
}

std::string calibrate_text(const CalibrateResult &result, const std::string &out)
{
    std::string text = pictures_text(result);
    if (result.has_solution) {
        text += summary_text(result.calib) + lens_text(result.calib);
        if (result.calib.cockle_scale_m > 0) {
            text += text_format("sheet: %.2f mm from its lowest to its highest node\n",
                                1e3 * result.calib.cockle_peak_m);
        }
        if (result.state == CalibrateState::calibrated) {
            text += mounting_text(result.camera) + expected_text(*result.expected);
        }
        for (const CalibrateWarning &warning : calibrate_warnings(result.calib.warnings)) {
            text += std::string("warning: ") + warning.advice + "\n";
        }
    }
    if (result.next) {
        text += "next: " + result.next_words + "\n";
    }
    return text + (out.empty() ? "no camera file was written: " + result.reason
                               : "written: " + out);
}
