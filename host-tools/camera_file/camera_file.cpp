/* SPDX-License-Identifier: Apache-2.0 */
#include "camera_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include <opms/lens.h>
#include <opms/pose.h>

#include "yaml_fields.hpp"

namespace opms_host {
namespace {

constexpr long SIDE_MAX_PX = 16384;
constexpr std::size_t MESSAGE_CHARS_MAX = 300;
constexpr double ROTATION_TOLERANCE = 1e-6; /* that of opms_camera_check() */

/** A message may quote what the file says: keep it one line, short, and harmless to a terminal. */
std::string one_line(const std::string &message)
{
    std::string line = message.substr(0, MESSAGE_CHARS_MAX);
    std::replace_if(
        line.begin(), line.end(),
        [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return line;
}

/** A ROS matrix: {rows, cols, data}. @p rows or @p cols 0 means any up to 16. */
std::vector<double> read_matrix(const FieldMap &parent, const char *key, long rows, long cols)
{
    const FieldMap matrix = parent.map(key);
    const long r = matrix.get("rows").integer(rows ? rows : 1, rows ? rows : 16);
    const long c = matrix.get("cols").integer(cols ? cols : 1, cols ? cols : 16);
    return matrix.get("data").numbers(static_cast<std::size_t>(r * c));
}

void read_pinhole(const FieldMap &root, opms_lens_t &lens)
{
    lens.width_px = static_cast<int32_t>(root.get("image_width").integer(1, SIDE_MAX_PX));
    lens.height_px = static_cast<int32_t>(root.get("image_height").integer(1, SIDE_MAX_PX));
    const std::vector<double> k = read_matrix(root, "camera_matrix", 3, 3);
    const Field data = root.map("camera_matrix").get("data");
    if (k[1] != 0 || k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1) {
        data.fail("must read [fx, 0, cx, 0, fy, cy, 0, 0, 1]; skew is not supported");
    }
    if (k[0] <= 0 || k[4] <= 0) {
        data.fail("has a focal length that is not positive");
    }
    lens.fx_px = k[0];
    lens.cx_px = k[2];
    lens.fy_px = k[4];
    lens.cy_px = k[5];
}

void read_distortion(const FieldMap &root, opms_lens_t &lens)
{
    const Field model = root.get("distortion_model");
    if (model.text() != "plumb_bob") {
        model.fail("is '" + model.text().substr(0, 40) +
                   "', which is not supported; calibrate with plumb_bob (k1 k2 p1 p2)");
    }
    const std::vector<double> d = read_matrix(root, "distortion_coefficients", 0, 0);
    const Field data = root.map("distortion_coefficients").get("data");
    if (d.size() != 4 && d.size() != 5) {
        data.fail("has " + std::to_string(d.size()) +
                  " numbers; plumb_bob has 5 (k1 k2 p1 p2 k3) or 4 of them");
    }
    if (d.size() == 5 && d[4] != 0) {
        data.fail("has k3 other than 0, which is not supported; "
                  "calibrate again with k3 fixed at 0");
    }
    lens.k1 = d[0];
    lens.k2 = d[1];
    lens.p1 = d[2];
    lens.p2 = d[3];
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

void check_rotation(const Field &field, const std::vector<double> &R)
{
    double worst = 0;
    for (std::size_t i = 0; i < 3; i++) {
        for (std::size_t j = 0; j < 3; j++) {
            const double dot = R[i] * R[j] + R[3 + i] * R[3 + j] + R[6 + i] * R[6 + j];
            worst = std::max(worst, std::fabs(dot - (i == j ? 1 : 0)));
        }
    }
    const double det = R[0] * (R[4] * R[8] - R[5] * R[7]) - R[1] * (R[3] * R[8] - R[5] * R[6]) +
                       R[2] * (R[3] * R[7] - R[4] * R[6]);
    if (!(worst <= ROTATION_TOLERANCE)) {
        field.fail("is not a rotation to 1e-6; write it with at least 8 digits");
    }
    if (det < 0) {
        field.fail("is a mirror image, not a rotation (determinant -1)");
    }
}

void read_mounting(const FieldMap &opms, CameraFile &file)
{
    const bool has_R = opms.has("R_detector_camera");
    const bool has_t = opms.has("t_detector_camera_m");
    if (has_R) {
        const Field field = opms.get("R_detector_camera");
        const std::vector<double> R = field.numbers(9);
        check_rotation(field, R);
        std::copy(R.begin(), R.end(), file.camera.detector_camera.R);
    }
    if (has_t) {
        const std::vector<double> t = opms.get("t_detector_camera_m").numbers(3);
        std::copy(t.begin(), t.end(), file.camera.detector_camera.t_m);
    }
    file.camera.has_detector_camera = has_R && has_t;
    if (has_R != has_t) {
        const Field half = opms.get(has_R ? "R_detector_camera" : "t_detector_camera_m");
        file.notes.push_back(half.where() + " stands without " +
                             (has_R ? "t_detector_camera_m" : "R_detector_camera") +
                             ": there will be no detector pose");
    }
}

/** @return Whether the key is there; a matrix that is no covariance fails. */
bool read_covariance(const FieldMap &opms, const char *key, std::size_t n, double *out)
{
    if (!opms.has(key)) {
        return false;
    }
    const Field field = opms.get(key);
    const std::vector<double> c = field.numbers(n * n);
    for (std::size_t i = 0; i < n; i++) {
        if (c[i * n + i] < 0) {
            field.fail("has a negative variance, number " + std::to_string(i * n + i));
        }
        for (std::size_t j = 0; j < i; j++) {
            const double scale = std::sqrt(c[i * n + i] * c[j * n + j]);
            if (std::fabs(c[i * n + j] - c[j * n + i]) > 1e-6 * scale) {
                field.fail("is not symmetric: row " + std::to_string(i) + ", column " +
                           std::to_string(j));
            }
        }
    }
    std::copy(c.begin(), c.end(), out);
    return true;
}

void read_history(const FieldMap &opms, CameraFile &file)
{
    if (opms.has("grid")) {
        file.grid = opms.get("grid").text();
    }
    if (opms.has("date")) {
        file.date = opms.get("date").text();
    }
    if (opms.has("residual_rms_px")) {
        file.residual_rms_px = opms.get("residual_rms_px").number();
    }
    if (opms.has("footprint")) {
        const FieldMap map = opms.map("footprint");
        file.footprint = Footprint{map.get("x_m").number(), map.get("y_m").number(),
                                   map.get("yaw_rad").number()};
    }
}

void note_unknown_keys(const FieldMap &opms, CameraFile &file)
{
    static const char *const known[] = {
        "version", "R_detector_camera", "t_detector_camera_m", "covariance_intrinsics",
        "covariance_detector_camera", "grid", "footprint", "residual_rms_px", "date"};
    for (const auto &entry : opms.entries()) {
        const bool found = std::any_of(std::begin(known), std::end(known), [&](const char *key) {
            return entry.first == key;
        });
        if (!found) {
            file.notes.push_back(one_line(opms.get(entry.first).where().substr(0, 80) +
                                          " is unknown and ignored"));
        }
    }
}

void read_opms_mapping(const FieldMap &root, CameraFile &file)
{
    if (!root.has("opms") || root.get("opms").node.IsNull()) {
        return;
    }
    const FieldMap opms = root.map("opms");
    if (opms.has("version")) {
        const Field version = opms.get("version");
        if (version.number() != 1) {
            version.fail("is not 1: the file was written for another version of opms");
        }
    }
    read_mounting(opms, file);
    opms_camera_t &camera = file.camera;
    camera.has_covariance_intrinsics =
        read_covariance(opms, "covariance_intrinsics", 8, camera.covariance_intrinsics);
    camera.has_covariance_detector_camera =
        read_covariance(opms, "covariance_detector_camera", 6, camera.covariance_detector_camera);
    read_history(opms, file);
    note_unknown_keys(opms, file);
}

CameraFile parse(const std::string &text)
{
    const YAML::Node document = yaml_load_plain(text);
    const FieldMap root(document, "");
    CameraFile file;
    read_pinhole(root, file.camera.lens);
    read_distortion(root, file.camera.lens);
    check_unused_matrices(root);
    if (root.has("camera_name")) {
        file.name = root.get("camera_name").text();
    }
    read_opms_mapping(root, file);
    opms_error_t error = {};
    if (opms_camera_check(&file.camera, &error) != OPMS_OK) {
        throw FieldError(std::string("the camera cannot be used: ") + error.message);
    }
    return file;
}

/** Read all of a file up to the limit; what is wrong goes to @p error. */
bool read_bytes(const std::string &path, std::string &bytes, std::string &error)
{
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        error = path + ": is a directory, not a camera file";
        return false;
    }
    errno = 0;
    const std::unique_ptr<std::FILE, int (*)(std::FILE *)> in(std::fopen(path.c_str(), "rb"),
                                                              &std::fclose);
    if (!in) {
        error = path + ": cannot open the camera file: " + std::strerror(errno);
        return false;
    }
    bytes.resize(CAMERA_FILE_BYTES_MAX + 1);
    bytes.resize(std::fread(&bytes[0], 1, bytes.size(), in.get()));
    if (std::ferror(in.get())) {
        error = path + ": cannot read the camera file: " + std::strerror(errno);
        return false;
    }
    return true;
}

}  // namespace

bool camera_file_parse(const void *bytes, std::size_t size, CameraFile &file,
                       std::string &error) noexcept
{
    try {
        if (size > CAMERA_FILE_BYTES_MAX) {
            error = "is no camera file: larger than 64 KiB";
            return false;
        }
        const char *text = static_cast<const char *>(bytes);
        if (size != 0 && std::memchr(text, 0, size) != nullptr) {
            error = "is no camera file: it holds binary data";
            return false;
        }
        file = parse(size == 0 ? std::string() : std::string(text, size));
        return true;
    } catch (const YAML::Exception &e) {
        error = one_line("line " + std::to_string(e.mark.line + 1) + ": is not valid YAML: " +
                         e.msg);
    } catch (const std::bad_alloc &) {
        error = "out of memory"; /* short enough to need none */
    } catch (const std::exception &e) {
        error = one_line(e.what());
    }
    return false;
}

bool camera_file_read(const std::string &path, CameraFile &file, std::string &error) noexcept
{
    try {
        std::string bytes;
        if (!read_bytes(path, bytes, error)) {
            return false;
        }
        std::string what;
        if (camera_file_parse(bytes.data(), bytes.size(), file, what)) {
            return true;
        }
        error = path + ": " + what;
    } catch (const std::exception &) {
        error = "out of memory";
    }
    return false;
}

}  // namespace opms_host
