/* SPDX-License-Identifier: Apache-2.0 */
#include <cmath>

#include "calibrate_check.hpp"
#include "text_table.hpp"

namespace {

constexpr double DEG = 180 / 3.14159265358979323846, MM_PER_M = 1e3;

double sigma(const double *covariance, int n, int i)
{
    return std::sqrt(covariance[i * n + i]);
}

std::string pictures_text(const CheckResult &result)
{
    std::vector<std::string> names;
    for (const CalibratePicture &picture : result.pictures) {
        names.push_back(picture.grid.image);
    }
    const std::size_t width = text_name_width(names);
    std::string text = "  " + text_padded("picture", width) + "  nodes  outliers  residual px\n";
    for (const CalibratePicture &picture : result.pictures) {
        text += "  " + text_padded(picture.grid.image, width);
        text += picture.used() && result.has_lens
                    ? text_format("  %5u  %8u  %11.3f\n", picture.solved.points,
                                  picture.solved.outliers, picture.solved.residual_rms_px)
                    : "  left out: " + picture.left_out + "\n";
    }
    return text;
}

std::string lens_text(const CheckResult &result)
{
    const opms_calib_lens_check_t &lens = result.lens;
    return text_format("lens: chi2 %.1f of 8 (limit %.1f), residual %.4f px RMS as stated, %.4f "
                       "with the lens free\n",
                       lens.chi2, OPMS_CALIB_CHI2_LENS, lens.residual_rms_px,
                       lens.residual_free_rms_px) +
           text_format("  would have shown: focal length off by %.2f %%, centre by %.1f px across, "
                       "%.1f px down\n",
                       100 * lens.shows_focal, lens.shows_centre_px[0], lens.shows_centre_px[1]) +
           text_format("  nodes taken to be %.2f times as uncertain as they were measured, as the "
                       "residuals show\n", lens.noise_factor) +
           (result.lens_assumed ? "  the file does not say how well the lens is known; 0.07 % was "
                                  "assumed\n" : "");
}

std::string alone_text(const opms_camera_t &camera, const opms_calib_result_t &alone)
{
    const opms_lens_t &stated = camera.lens, &found = alone.lens;
    const double old[8] = {stated.fx_px, stated.fy_px, stated.cx_px, stated.cy_px,
                           stated.k1,    stated.k2,    stated.p1,    stated.p2};
    const double now[8] = {found.fx_px, found.fy_px, found.cx_px, found.cy_px,
                           found.k1,    found.k2,    found.p1,    found.p2};
    const char *const names[8] = {"fx px", "fy px", "cx px", "cy px", "k1", "k2", "p1", "p2"};
    std::string text = "what the pictures say by themselves\n"
                       "            in the file       sigma         alone       sigma\n";
    for (int i = 0; i < 8; i++) {
        const int digits = i < 4 ? 3 : 6;
        text += text_format("  %-6s  %13.*f", names[i], digits, old[i]);
        text += camera.has_covariance_intrinsics
                    ? text_format("  %10.*f", digits, sigma(camera.covariance_intrinsics, 8, i))
                    : "           ?";
        text += text_format("  %12.*f  %10.*f\n", digits, now[i], digits,
                            sigma(alone.covariance, 8, i));
    }
    return text;
}

std::string mounting_text(const CheckMounting &mounting)
{
    const opms_calib_mounting_check_t &m = mounting.figures;
    const double turn = std::hypot(m.change[0], m.change[1], m.change[2]);
    const double shift = std::hypot(m.change[3], m.change[4], m.change[5]);
    return "mounting, " + mounting.image +
           text_format(": chi2 %.1f of 6 (limit %.1f), off by %.3f deg and %.2f mm\n", m.chi2,
                       OPMS_CALIB_CHI2_MOUNTING, DEG * turn, MM_PER_M * shift) +
           text_format("  would have shown: a turn about X, Y, Z by %.2f, %.2f, %.2f deg, a shift "
                       "by %.1f, %.1f, %.1f mm\n",
                       DEG * m.shows_turn_rad[0], DEG * m.shows_turn_rad[1],
                       DEG * m.shows_turn_rad[2], MM_PER_M * m.shows_shift_m[0],
                       MM_PER_M * m.shows_shift_m[1], MM_PER_M * m.shows_shift_m[2]);
}

std::string verdict_text(const std::string &path, const CheckResult &result)
{
    std::string words;
    switch (result.verdict) {
    case CheckVerdict::valid:
        words = "VALID";
        break;
    case CheckVerdict::lens_touched:
        words = "LENS TOUCHED";
        break;
    case CheckVerdict::camera_moved:
        words = "CAMERA MOVED";
        break;
    case CheckVerdict::cannot_tell:
        words = "CANNOT TELL";
        break;
    case CheckVerdict::bad_pictures:
        words = "NOT CHECKED";
        break;
    }
    return path + ": " + words + ": " + result.reason +
           (result.advice.empty() ? "" : ". " + result.advice);
}

}  // namespace

std::string check_text(const std::string &path, const opms_host::CameraFile &file,
                       const CheckResult &result)
{
    std::string text = pictures_text(result);
    if (result.has_lens) {
        text += lens_text(result);
        if (result.alone) {
            text += alone_text(file.camera, *result.alone);
        }
        for (const CheckMounting &mounting : result.mountings) {
            text += mounting_text(mounting);
        }
    }
    return text + verdict_text(path, result);
}
