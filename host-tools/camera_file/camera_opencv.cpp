/* SPDX-License-Identifier: Apache-2.0 */
/* What OpenCV's FileStorage holds after its calibration sample, whether it was YAML or XML; older
 * samples spell the keys with capitals. */
#include "camera_parts.hpp"

namespace opms_host {
namespace {

constexpr const char *MATRIX[] = {"camera_matrix", "Camera_Matrix", "cameraMatrix"};
constexpr const char *DISTORTION[] = {"distortion_coefficients", "Distortion_Coefficients",
                                      "distCoeffs"};
constexpr const char *WIDTH[] = {"image_width", "image_Width"};
constexpr const char *HEIGHT[] = {"image_height", "image_Height"};

/** The spelling that is there; the first where none is. */
template <std::size_t N>
std::string spelling(const FieldMap &root, const char *const (&names)[N])
{
    for (const char *name : names) {
        if (root.has(name)) {
            return name;
        }
    }
    return names[0];
}

template <std::size_t N>
bool among(const std::string &name, const char *const (&names)[N])
{
    for (const char *one : names) {
        if (name == one) {
            return true;
        }
    }
    return false;
}

bool ours(const std::string &name)
{
    return camera_root_key(name) || among(name, MATRIX) || among(name, DISTORTION) ||
           among(name, WIDTH) || among(name, HEIGHT);
}

std::vector<double> read_matrix(const FieldMap &root, const std::string &key)
{
    const FieldMap matrix = root.map(key);
    const std::string type = matrix.get("dt").text();
    if (type != "d" && type != "f") {
        matrix.get("dt").fail("is '" + type.substr(0, 20) + "', not d or f: one number an element");
    }
    const long rows = matrix.get("rows").integer(1, 16), cols = matrix.get("cols").integer(1, 16);
    const std::size_t count = static_cast<std::size_t>(rows * cols);
    const Field data = matrix.get("data");
    if (count == 1 && data.node.IsScalar()) {
        return {data.number()}; /* XML's list of one */
    }
    return data.numbers(count);
}

void refuse_other_models(const FieldMap &root)
{
    for (const char *key : {"fisheye_model", "fisheye"}) {
        if (root.has(key) && root.get(key).node.IsScalar() && root.get(key).node.Scalar() != "0") {
            root.get(key).fail("is set: the fisheye model is not supported; calibrate with k1 k2 "
                               "p1 p2");
        }
    }
    for (const char *key : {"distortion_model", "camera_model"}) {
        if (root.has(key) && root.get(key).text() != "plumb_bob" &&
            root.get(key).text() != "pinhole") {
            root.get(key).fail("is '" + root.get(key).text().substr(0, 40) +
                               "', which is not supported");
        }
    }
}

}  // namespace

bool camera_is_opencv(const FieldMap &root)
{
    const std::string key = spelling(root, MATRIX);
    if (!root.has(key) || !root.get(key).node.IsMap()) {
        return false;
    }
    const YAML::Node matrix = root.get(key).node;
    return key != MATRIX[0] || matrix["dt"].IsDefined();
}

void camera_read_opencv(const YAML::Node &document, const FieldMap &root, CameraFile &file)
{
    opms_lens_t &lens = file.camera.lens;
    refuse_other_models(root);
    lens.width_px =
        static_cast<int32_t>(root.get(spelling(root, WIDTH)).integer(1, CAMERA_SIDE_MAX_PX));
    lens.height_px =
        static_cast<int32_t>(root.get(spelling(root, HEIGHT)).integer(1, CAMERA_SIDE_MAX_PX));
    const std::string matrix = spelling(root, MATRIX), distortion = spelling(root, DISTORTION);
    const std::vector<double> k = read_matrix(root, matrix);
    const Field data = root.map(matrix).get("data");
    if (k.size() != 9) {
        data.fail("has " + std::to_string(k.size()) + " numbers, must have 9");
    }
    camera_read_matrix(data, k, lens);
    const std::vector<double> d = read_matrix(root, distortion);
    camera_read_distortion(root.map(distortion).get("data"), d, lens);
    if (root.has("camera_name")) {
        file.name = root.get("camera_name").text();
    }
    camera_read_opms(root, file);
    camera_read_extras(document, ours, file.extras);
}

}  // namespace opms_host
