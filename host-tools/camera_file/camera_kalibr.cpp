/* SPDX-License-Identifier: Apache-2.0 */
/* Kalibr's camera chain: one mapping a camera, cam0, cam1, ... Here one camera is taken. What else
 * its mapping holds (T_cam_imu, rostopic, ...) is kept; `opms` may stand in it, too, where Kalibr
 * does not count it as a camera. */
#include <algorithm>
#include <cctype>

#include "camera_parts.hpp"
#include "yaml_text.hpp"

namespace opms_host {
namespace {

bool is_camera_name(const std::string &name)
{
    return name.size() > 3 && name.compare(0, 3, "cam") == 0 &&
           std::all_of(name.begin() + 3, name.end(),
                       [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool ours(const std::string &name)
{
    static const char *const keys[] = {"camera_model", "intrinsics",  "distortion_model",
                                       "distortion_coeffs", "resolution", "camera_name", "opms"};
    return std::any_of(std::begin(keys), std::end(keys),
                       [&](const char *key) { return name == key; });
}

std::vector<std::string> cameras_of(const FieldMap &root)
{
    std::vector<std::string> names;
    for (const auto &entry : root.entries()) {
        if (is_camera_name(entry.first)) {
            names.push_back(entry.first);
        }
    }
    return names;
}

std::string choose(const FieldMap &root, const std::string &which)
{
    const std::vector<std::string> names = cameras_of(root);
    std::string all;
    for (const std::string &name : names) {
        all += (all.empty() ? "" : ", ") + name.substr(0, 20);
    }
    if (!which.empty()) {
        if (std::find(names.begin(), names.end(), which) == names.end()) {
            throw FieldError("holds no camera '" + which + "', but " + all);
        }
        return which;
    }
    if (names.size() > 1) {
        throw FieldError("holds " + std::to_string(names.size()) + " cameras (" + all +
                         "): take one of them out with 'opms camera convert --cam NAME'");
    }
    return names.front();
}

void read_distortion(const FieldMap &cam, opms_lens_t &lens)
{
    const Field model = cam.get("distortion_model");
    const std::string name = model.text();
    if (name == "none") {
        return;
    }
    if (name != "radtan") {
        model.fail("is '" + name.substr(0, 40) +
                   "', which is not supported; calibrate with pinhole-radtan (k1 k2 p1 p2)");
    }
    camera_read_distortion(cam.get("distortion_coeffs"), cam.get("distortion_coeffs").numbers(4),
                           lens);
}

}  // namespace

bool camera_is_kalibr(const FieldMap &root)
{
    const std::vector<std::string> names = cameras_of(root);
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string &name) { return root.get(name).node.IsMap(); });
}

void camera_read_kalibr(const FieldMap &root, const std::string &which, CameraFile &file)
{
    const std::string name = choose(root, which);
    const FieldMap cam = root.map(name);
    const Field model = cam.get("camera_model");
    if (model.text() != "pinhole") {
        model.fail("is '" + model.text().substr(0, 40) +
                   "', which is not supported; calibrate with pinhole-radtan");
    }
    opms_lens_t &lens = file.camera.lens;
    const Field size = cam.get("resolution");
    const std::vector<double> resolution = size.numbers(2);
    for (const double side : resolution) {
        if (!(side >= 1 && side <= CAMERA_SIDE_MAX_PX) || side != static_cast<long>(side)) {
            size.fail("must hold two whole numbers from 1 to 16384");
        }
    }
    lens.width_px = static_cast<int32_t>(resolution[0]);
    lens.height_px = static_cast<int32_t>(resolution[1]);
    const Field intrinsics = cam.get("intrinsics");
    const std::vector<double> f = intrinsics.numbers(4);
    camera_read_matrix(intrinsics, {f[0], 0, f[2], 0, f[1], f[3], 0, 0, 1}, lens);
    read_distortion(cam, lens);
    file.name = cam.has("camera_name") ? cam.get("camera_name").text() : name;
    camera_read_opms(cam, file);
    camera_read_extras(root.get(name).node, ours, file.extras);
    for (const auto &entry : root.entries()) {
        if (entry.first != name) {
            file.notes.push_back(camera_one_line(
                entry.first.substr(0, 40) + " is another camera or no camera, and is left out"));
        }
    }
}

std::string camera_kalibr_text(const CameraFile &file)
{
    const opms_lens_t &lens = file.camera.lens;
    const double intrinsics[4] = {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px};
    const double distortion[4] = {lens.k1, lens.k2, lens.p1, lens.p2};
    std::string text = "cam0:\n  camera_model: pinhole\n  intrinsics: " +
                       yaml_numbers(intrinsics, 4) + "\n  distortion_model: radtan\n" +
                       "  distortion_coeffs: " + yaml_numbers(distortion, 4) +
                       "\n  resolution: [" + std::to_string(lens.width_px) + ", " +
                       std::to_string(lens.height_px) + "]\n";
    if (!file.name.empty()) {
        text += "  camera_name: " + yaml_quoted(file.name) + "\n";
    }
    for (const CameraExtra &extra : file.extras) {
        text += "  " + extra.key + ": " + extra.value + "\n";
    }
    return text + "  opms: " + yaml_flow(camera_opms_node(file)) + "\n";
}

}  // namespace opms_host
