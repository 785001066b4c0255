/* SPDX-License-Identifier: Apache-2.0 */
/* ROS's camera_info: the camera file's own form, read and written. */
#include <algorithm>

#include "camera_parts.hpp"
#include "yaml_text.hpp"

namespace opms_host {
namespace {

constexpr std::size_t RATIONAL_LENGTH = 8;

/** A ROS matrix: {rows, cols, data}. @p rows or @p cols 0 means any up to 16. */
std::vector<double> read_matrix(const FieldMap &parent, const char *key, long rows, long cols)
{
    const FieldMap matrix = parent.map(key);
    const long r = matrix.get("rows").integer(rows ? rows : 1, rows ? rows : 16);
    const long c = matrix.get("cols").integer(cols ? cols : 1, cols ? cols : 16);
    return matrix.get("data").numbers(static_cast<std::size_t>(r * c));
}

void read_distortion(const FieldMap &root, opms_lens_t &lens)
{
    const Field model = root.get("distortion_model");
    const std::string name = model.text();
    if (name != "plumb_bob" && name != "rational_polynomial") {
        model.fail("is '" + name.substr(0, 40) +
                   "', which is not supported; calibrate with plumb_bob (k1 k2 p1 p2)");
    }
    const std::vector<double> d = read_matrix(root, "distortion_coefficients", 0, 0);
    const Field data = root.map("distortion_coefficients").get("data");
    if (name == "rational_polynomial" && d.size() != RATIONAL_LENGTH) {
        data.fail("has " + std::to_string(d.size()) + " numbers, rational_polynomial has 8");
    }
    if (name == "plumb_bob" && d.size() != 4 && d.size() != 5) {
        data.fail("has " + std::to_string(d.size()) +
                  " numbers; plumb_bob has 5 (k1 k2 p1 p2 k3) or 4 of them");
    }
    camera_read_distortion(data, d, lens);
}

/** Neither matrix is used (pictures are not rectified), but a broken one means a broken file. */
void check_unused_matrices(const FieldMap &root)
{
    if (root.has("rectification_matrix")) {
        read_matrix(root, "rectification_matrix", 3, 3);
    }
    if (root.has("projection_matrix")) {
        read_matrix(root, "projection_matrix", 3, 4);
    }
}

/** A key with all its lines, so that its comments can be put above it. */
struct Block {
    bool in_opms;
    std::string name, text;
};

std::string matrix_text(const char *key, int rows, int cols, const double *values)
{
    return std::string(key) + ":\n  rows: " + std::to_string(rows) + "\n  cols: " +
           std::to_string(cols) + "\n  data: " +
           yaml_numbers(values, static_cast<std::size_t>(rows * cols)) + "\n";
}

void add_lens(const CameraFile &file, std::vector<Block> &blocks)
{
    const opms_lens_t &lens = file.camera.lens;
    const double fx = lens.fx_px, fy = lens.fy_px, cx = lens.cx_px, cy = lens.cy_px;
    const double matrix[9] = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
    const double distortion[5] = {lens.k1, lens.k2, lens.p1, lens.p2, 0};
    const double rectification[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double projection[12] = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
    const auto add = [&](const char *name, const std::string &text) {
        blocks.push_back({false, name, text});
    };
    add("image_width", "image_width: " + std::to_string(lens.width_px) + "\n");
    add("image_height", "image_height: " + std::to_string(lens.height_px) + "\n");
    if (!file.name.empty()) {
        add("camera_name", "camera_name: " + yaml_quoted(file.name) + "\n");
    }
    add("camera_matrix", matrix_text("camera_matrix", 3, 3, matrix));
    add("distortion_model", "distortion_model: plumb_bob\n");
    add("distortion_coefficients", matrix_text("distortion_coefficients", 1, 5, distortion));
    add("rectification_matrix", matrix_text("rectification_matrix", 3, 3, rectification));
    add("projection_matrix", matrix_text("projection_matrix", 3, 4, projection));
}

/** Comments of a key; those whose key is not written again are for the end. */
std::string comments_of(const CameraFile &file, bool in_opms, const std::string &name)
{
    std::string text;
    for (const CameraComment &comment : file.comments) {
        if (comment.in_opms == in_opms && comment.name == name) {
            text += (in_opms ? "  " : "") + comment.text + "\n";
        }
    }
    return text;
}

}  // namespace

std::string camera_ros_text(const CameraFile &file)
{
    std::vector<Block> blocks;
    add_lens(file, blocks);
    for (const CameraExtra &extra : file.extras) {
        blocks.push_back({false, extra.name, extra.key + ": " + extra.value + "\n"});
    }
    blocks.push_back({false, "opms", "opms:\n"});
    for (const auto &entry : camera_opms_node(file)) {
        blocks.push_back({true, entry.first.Scalar(),
                          "  " + yaml_flow(entry.first) + ": " + yaml_flow(entry.second) + "\n"});
    }
    std::string text;
    for (const Block &block : blocks) {
        text += comments_of(file, block.in_opms, block.name) + block.text;
    }
    for (const CameraComment &comment : file.comments) {
        const bool written = std::any_of(blocks.begin(), blocks.end(), [&](const Block &block) {
            return block.in_opms == comment.in_opms && block.name == comment.name;
        });
        text += written ? std::string() : comment.text + "\n";
    }
    return text;
}

void camera_read_ros(const YAML::Node &document, const FieldMap &root, CameraFile &file)
{
    opms_lens_t &lens = file.camera.lens;
    lens.width_px = static_cast<int32_t>(root.get("image_width").integer(1, CAMERA_SIDE_MAX_PX));
    lens.height_px = static_cast<int32_t>(root.get("image_height").integer(1, CAMERA_SIDE_MAX_PX));
    const std::vector<double> k = read_matrix(root, "camera_matrix", 3, 3);
    camera_read_matrix(root.map("camera_matrix").get("data"), k, lens);
    read_distortion(root, lens);
    check_unused_matrices(root);
    if (root.has("camera_name")) {
        file.name = root.get("camera_name").text();
    }
    camera_read_opms(root, file);
    camera_read_extras(document, camera_root_key, file.extras);
}

}  // namespace opms_host
