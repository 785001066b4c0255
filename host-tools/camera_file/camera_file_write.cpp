/* SPDX-License-Identifier: Apache-2.0 */
/* Our own keys are written from the values; of an old file only the others are taken. The new text
 * is read once before it replaces anything. */
#include "camera_file_write.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <system_error>

#include "yaml_fields.hpp"
#include "yaml_text.hpp"

namespace opms_host {
namespace {

namespace fs = std::filesystem;

constexpr const char *ROOT_KEYS[] = {
    "image_width", "image_height", "camera_name", "camera_matrix", "distortion_model",
    "distortion_coefficients", "rectification_matrix", "projection_matrix", "opms"};
constexpr const char *OPMS_KEYS[] = {
    "version", "R_detector_camera", "t_detector_camera_m", "covariance_intrinsics",
    "covariance_detector_camera", "grid", "footprint", "residual_rms_px", "date"};

/** What an old file holds besides our own keys, as lines of text. */
struct OldKeys {
    std::string name;
    std::string root_lines, opms_lines;
};

/** @param map  A mapping whose keys FieldMap has found to be scalars. */
template <std::size_t N>
std::string other_lines(const YAML::Node &map, const char *const (&ours)[N], const char *indent)
{
    std::string lines;
    for (const auto &entry : map) {
        const std::string &name = entry.first.Scalar();
        const bool mine = std::any_of(std::begin(ours), std::end(ours),
                                      [&](const char *key) { return name == key; });
        if (!mine) {
            lines += indent + yaml_flow(entry.first) + ": " + yaml_flow(entry.second) + "\n";
        }
    }
    return lines;
}

OldKeys parse_old(const std::string &bytes)
{
    const YAML::Node document = yaml_load_plain(bytes);
    const FieldMap root(document, "");
    OldKeys old;
    if (!root.has("camera_matrix")) {
        throw FieldError("is no camera file");
    }
    old.root_lines = other_lines(document, ROOT_KEYS, "");
    if (root.has("camera_name")) {
        old.name = root.get("camera_name").text();
    }
    if (root.has("opms") && !root.get("opms").node.IsNull()) {
        const FieldMap opms = root.map("opms");
        if (opms.has("version") && opms.get("version").number() != 1) {
            opms.get("version").fail("is not 1: the file was written for another version of opms");
        }
        old.opms_lines = other_lines(root.get("opms").node, OPMS_KEYS, "  ");
    }
    return old;
}

/** Throws where something stands at @p path that must not be replaced. */
OldKeys read_old(const std::string &path)
{
    if (!fs::exists(path)) {
        return OldKeys();
    }
    if (!fs::is_regular_file(path)) {
        throw FieldError("is there and is no file");
    }
    std::ifstream in(path, std::ios::binary);
    std::string bytes(CAMERA_FILE_BYTES_MAX + 1, '\0');
    in.read(&bytes[0], static_cast<std::streamsize>(bytes.size()));
    if (in.bad() || (!in.eof() && in.fail())) {
        throw FieldError(std::string("is there but cannot be read: ") + std::strerror(errno));
    }
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    if (bytes.empty()) {
        return OldKeys(); /* as mktemp leaves it */
    }
    if (bytes.size() > CAMERA_FILE_BYTES_MAX || bytes.find('\0') != std::string::npos) {
        throw FieldError("is no camera file");
    }
    return parse_old(bytes);
}

std::string matrix_lines(const char *key, int rows, int cols, const double *values)
{
    return std::string(key) + ":\n  rows: " + std::to_string(rows) + "\n  cols: " +
           std::to_string(cols) + "\n  data: " +
           yaml_numbers(values, static_cast<std::size_t>(rows * cols)) + "\n";
}

std::string lens_lines(const opms_lens_t &lens, const std::string &name)
{
    const double fx = lens.fx_px, fy = lens.fy_px, cx = lens.cx_px, cy = lens.cy_px;
    const double matrix[9] = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
    const double distortion[5] = {lens.k1, lens.k2, lens.p1, lens.p2, 0};
    const double rectification[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double projection[12] = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
    return "image_width: " + std::to_string(lens.width_px) + "\nimage_height: " +
           std::to_string(lens.height_px) + "\n" +
           (name.empty() ? std::string() : "camera_name: " + yaml_quoted(name) + "\n") +
           matrix_lines("camera_matrix", 3, 3, matrix) + "distortion_model: plumb_bob\n" +
           matrix_lines("distortion_coefficients", 1, 5, distortion) +
           matrix_lines("rectification_matrix", 3, 3, rectification) +
           matrix_lines("projection_matrix", 3, 4, projection);
}

std::string opms_line(const char *key, const std::string &value)
{
    return std::string("  ") + key + ": " + value + "\n";
}

std::string mounting_lines(const opms_camera_t &camera)
{
    std::string text;
    if (camera.has_detector_camera) {
        text += opms_line("R_detector_camera", yaml_numbers(camera.detector_camera.R, 9));
        text += opms_line("t_detector_camera_m", yaml_numbers(camera.detector_camera.t_m, 3));
    }
    if (camera.has_covariance_intrinsics) {
        text += opms_line("covariance_intrinsics", yaml_numbers(camera.covariance_intrinsics, 64));
    }
    if (camera.has_covariance_detector_camera) {
        text += opms_line("covariance_detector_camera",
                          yaml_numbers(camera.covariance_detector_camera, 36));
    }
    return text;
}

std::string history_lines(const CameraFile &file)
{
    std::string text;
    if (file.grid) {
        text += opms_line("grid", yaml_quoted(*file.grid));
    }
    if (file.footprint) {
        text += opms_line("footprint", "{x_m: " + yaml_number(file.footprint->x_m) +
                                           ", y_m: " + yaml_number(file.footprint->y_m) +
                                           ", yaw_rad: " + yaml_number(file.footprint->yaw_rad) +
                                           "}");
    }
    if (file.residual_rms_px) {
        text += opms_line("residual_rms_px", yaml_number(*file.residual_rms_px));
    }
    if (file.date) {
        text += opms_line("date", yaml_quoted(*file.date));
    }
    return text;
}

std::string text_of(const CameraFile &file, const OldKeys &old)
{
    return lens_lines(file.camera.lens, file.name.empty() ? old.name : file.name) +
           old.root_lines + "opms:\n" + opms_line("version", "1") + mounting_lines(file.camera) +
           history_lines(file) + old.opms_lines;
}

/** Nothing may take the place of a good file that cannot be read again. */
void check_text(const std::string &text, const CameraFile &file)
{
    CameraFile again;
    std::string error;
    if (!camera_file_parse(text.data(), text.size(), again, error)) {
        throw FieldError("would not be a camera file: " + error);
    }
    const opms_lens_t &a = again.camera.lens, &b = file.camera.lens;
    const bool same = a.fx_px == b.fx_px && a.fy_px == b.fy_px && a.cx_px == b.cx_px &&
                      a.cy_px == b.cy_px && a.k1 == b.k1 && a.k2 == b.k2 && a.p1 == b.p1 &&
                      a.p2 == b.p2;
    if (!same) {
        throw FieldError("would not hold the same numbers");
    }
}

/** Removes the file aside unless it was renamed. */
class AsideFile {
public:
    explicit AsideFile(const fs::path &target) : path_(target)
    {
        path_ += ".part-" + std::to_string(std::random_device{}());
    }
    AsideFile(const AsideFile &) = delete;
    AsideFile &operator=(const AsideFile &) = delete;
    ~AsideFile()
    {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    const fs::path &path() const { return path_; }
    void write(const std::string &text) const
    {
        errno = 0;
        std::ofstream out(path_, std::ios::binary | std::ios::trunc);
        out.write(text.data(), static_cast<std::streamsize>(text.size()));
        out.close();
        if (!out) {
            throw FieldError(std::string("cannot be written: ") +
                             (errno != 0 ? std::strerror(errno) : "write error"));
        }
    }
    void rename_to(const fs::path &target) const
    {
        std::error_code error;
        fs::rename(path_, target, error);
        if (error) {
            throw FieldError("cannot be written: " + error.message());
        }
    }

private:
    fs::path path_;
};

/** A link stays a link: the file it leads to is replaced. */
fs::path target_of(const std::string &path)
{
    return fs::exists(path) ? fs::canonical(path) : fs::path(path);
}

void replace_file(const std::string &path, const std::string &text)
{
    const fs::path target = target_of(path);
    const AsideFile aside(target);
    aside.write(text);
    if (fs::exists(target)) {
        std::error_code ignored;
        fs::permissions(aside.path(), fs::status(target).permissions(), ignored);
    }
    aside.rename_to(target);
}

template <typename Work>
bool guarded(const std::string &path, std::string &error, const Work &work) noexcept
{
    try {
        try {
            work();
            return true;
        } catch (const YAML::Exception &e) {
            error = path + ": is there and is not valid YAML: line " +
                    std::to_string(e.mark.line + 1) + ": " + e.msg;
        } catch (const fs::filesystem_error &e) {
            error = path + ": " + e.code().message();
        } catch (const std::exception &e) {
            error = path + ": " + e.what();
        }
    } catch (...) {
        error.clear(); /* no memory even for a message */
    }
    return false;
}

}  // namespace

bool camera_file_may_write(const std::string &path, std::string &error) noexcept
{
    return guarded(path, error, [&] {
        try {
            read_old(path);
        } catch (const FieldError &e) {
            throw FieldError(std::string(e.what()) + "; it is not overwritten");
        }
        const fs::path folder = fs::absolute(path).parent_path();
        if (!fs::is_directory(folder)) {
            throw FieldError("the folder " + folder.string() + " does not exist");
        }
        AsideFile(target_of(path)).write("\n");
    });
}

bool camera_file_write(const std::string &path, const CameraFile &file,
                       std::string &error) noexcept
{
    return guarded(path, error, [&] {
        const std::string text = text_of(file, read_old(path));
        check_text(text, file);
        replace_file(path, text);
    });
}

}  // namespace opms_host
