/* SPDX-License-Identifier: Apache-2.0 */
#include "camera_show.hpp"

#include <cmath>

#include <opms/lens.h>

#include "text_table.hpp"

namespace {

using opms_host::CameraFile;
using opms_host::CameraFormat;

constexpr double DEG = 180 / 3.14159265358979323846, MM_PER_M = 1e3;

double angle_between_deg(const opms_lens_t &lens, double u1, double v1, double u2, double v2)
{
    const double from[2] = {u1, v1}, to[2] = {u2, v2};
    double a[2], b[2];
    if (opms_lens_unproject(&lens, from, a, nullptr, nullptr) != OPMS_OK ||
        opms_lens_unproject(&lens, to, b, nullptr, nullptr) != OPMS_OK) {
        return 0;
    }
    const double dot = a[0] * b[0] + a[1] * b[1] + 1;
    const double lengths = std::hypot(a[0], a[1], 1.0) * std::hypot(b[0], b[1], 1.0);
    return DEG * std::acos(std::fmin(1.0, dot / lengths));
}

std::string with_sigma(const char *name, double value, int digits, const double *covariance, int i)
{
    std::string line = text_format("  %-6s  %12.*f", name, digits, value);
    return line + (covariance != nullptr
                       ? text_format("  %10.*f\n", digits, std::sqrt(covariance[9 * i]))
                       : "           ?\n");
}

std::string lens_text(const opms_camera_t &camera)
{
    const opms_lens_t &lens = camera.lens;
    const double *const covariance =
        camera.has_covariance_intrinsics ? camera.covariance_intrinsics : nullptr;
    const double values[8] = {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px,
                              lens.k1,    lens.k2,    lens.p1,    lens.p2};
    const char *const names[8] = {"fx px", "fy px", "cx px", "cy px", "k1", "k2", "p1", "p2"};
    std::string text = "lens             value       sigma\n";
    for (int i = 0; i < 8; i++) {
        text += with_sigma(names[i], values[i], i < 4 ? 3 : 6, covariance, i);
    }
    const CameraView view = camera_view(lens);
    return text + text_format("  in sight: %.1f deg across, %.1f down, %.1f corner to corner\n",
                              view.across_deg, view.down_deg, view.diagonal_deg);
}

std::string mounting_text(const opms_camera_t &camera)
{
    if (!camera.has_detector_camera) {
        return std::string();
    }
    const opms_transform_t &mount = camera.detector_camera;
    std::string text = "camera on the detector    X          Y          Z\n";
    text += text_format("  place mm       %10.2f %10.2f %10.2f\n", MM_PER_M * mount.t_m[0],
                        MM_PER_M * mount.t_m[1], MM_PER_M * mount.t_m[2]);
    const bool known = camera.has_covariance_detector_camera != 0;
    const auto sigma = [&](int i) {
        return std::sqrt(camera.covariance_detector_camera[7 * i]);
    };
    if (known) {
        text += text_format("    sigma mm     %10.3f %10.3f %10.3f\n", MM_PER_M * sigma(3),
                            MM_PER_M * sigma(4), MM_PER_M * sigma(5));
    }
    const char *const axes[3] = {"picture right", "picture down", "looking along"};
    for (int axis = 0; axis < 3; axis++) {
        text += text_format("  %-13s  %10.5f %10.5f %10.5f", axes[axis], mount.R[axis],
                            mount.R[3 + axis], mount.R[6 + axis]);
        text += known ? text_format("  turned about it: sigma %.4f deg\n", DEG * sigma(axis))
                      : std::string("\n");
    }
    return text;
}

std::string history_text(const CameraFile &file)
{
    std::string text;
    text += file.date ? "calibrated " + *file.date + "\n" : "";
    text += file.grid ? "  grid " + *file.grid + "\n" : "";
    text += file.residual_rms_px ? text_format("  residual %.4f px RMS\n", *file.residual_rms_px)
                                 : std::string();
    if (file.footprint) {
        text += text_format("  footprint %.1f,%.1f mm, %.2f deg\n", MM_PER_M * file.footprint->x_m,
                            MM_PER_M * file.footprint->y_m, DEG * file.footprint->yaw_rad);
    }
    return text;
}

std::string extras_text(const CameraFile &file)
{
    std::string names;
    for (const opms_host::CameraExtra &extra : file.extras) {
        names += (names.empty() ? "" : ", ") + extra.name.substr(0, 40);
    }
    for (const opms_host::CameraExtra &extra : file.opms_extras) {
        names += (names.empty() ? "opms." : ", opms.") + extra.name.substr(0, 40);
    }
    return names.empty() ? names : "also in the file: " + names + "\n";
}

}  // namespace

const char *camera_format_name(CameraFormat format)
{
    switch (format) {
    case CameraFormat::opencv_yaml:
        return "opencv-yaml";
    case CameraFormat::opencv_xml:
        return "opencv-xml";
    case CameraFormat::kalibr:
        return "kalibr";
    case CameraFormat::ros:
        break;
    }
    return "ros";
}

std::vector<CameraGap> camera_gaps(const opms_camera_t &camera)
{
    std::vector<CameraGap> gaps;
    if (!camera.has_detector_camera) {
        gaps.push_back({"R_detector_camera, t_detector_camera_m",
                        "poses of the detector cannot be told, only of the camera"});
    }
    if (!camera.has_covariance_intrinsics) {
        gaps.push_back({"covariance_intrinsics",
                        "stated uncertainties will not allow for an error of the lens"});
    }
    if (camera.has_detector_camera && !camera.has_covariance_detector_camera) {
        gaps.push_back({"covariance_detector_camera",
                        "stated uncertainties will not allow for an error of the mounting"});
    }
    if (camera.has_covariance_intrinsics && camera.has_covariance_detector_camera &&
        !camera.has_covariance_detector_camera_intrinsics) {
        gaps.push_back({"covariance_detector_camera_intrinsics",
                        "stated uncertainties of the detector will be too large; calibrate again "
                        "to have it"});
    }
    return gaps;
}

CameraView camera_view(const opms_lens_t &lens)
{
    const double right = lens.width_px - 0.5, bottom = lens.height_px - 0.5;
    const double u = 0.5 * (lens.width_px - 1), v = 0.5 * (lens.height_px - 1);
    CameraView view;
    view.across_deg = angle_between_deg(lens, -0.5, v, right, v);
    view.down_deg = angle_between_deg(lens, u, -0.5, u, bottom);
    view.diagonal_deg = angle_between_deg(lens, -0.5, -0.5, right, bottom);
    return view;
}

std::string camera_show_text(const std::string &path, const CameraFile &file)
{
    const opms_lens_t &lens = file.camera.lens;
    std::string text = path + ": " + camera_format_name(file.format) +
                       text_format(", pictures of %d x %d px", static_cast<int>(lens.width_px),
                                   static_cast<int>(lens.height_px)) +
                       (file.name.empty() ? "" : ", camera '" + file.name + "'") + "\n";
    text += lens_text(file.camera) + mounting_text(file.camera) + history_text(file) +
            extras_text(file);
    for (const CameraGap &gap : camera_gaps(file.camera)) {
        text += std::string("missing: ") + gap.key + ": " + gap.meaning + "\n";
    }
    text.pop_back();
    return text;
}
