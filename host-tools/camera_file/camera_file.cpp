/* SPDX-License-Identifier: Apache-2.0 */
/* Bytes of any known format in, a checked camera out. */
#include "camera_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include <opms/pose.h>

#include "camera_comments.hpp"
#include "camera_parts.hpp"
#include "yaml_text.hpp"

namespace opms_host {
namespace {

constexpr std::size_t MESSAGE_CHARS_MAX = 300;
constexpr const char *ROOT_KEYS[] = {
    "image_width", "image_height", "camera_name", "camera_matrix", "distortion_model",
    "distortion_coefficients", "rectification_matrix", "projection_matrix", "opms"};

bool is_xml(const std::string &text)
{
    const std::size_t first = text.find_first_not_of("\xef\xbb\xbf \t\r\n");
    return first != std::string::npos && text[first] == '<';
}

CameraFormat format_of(const FieldMap &root, bool xml)
{
    if (xml) {
        return CameraFormat::opencv_xml;
    }
    if (camera_is_kalibr(root)) {
        return CameraFormat::kalibr;
    }
    return camera_is_opencv(root) ? CameraFormat::opencv_yaml : CameraFormat::ros;
}

CameraFile parse(const std::string &text, const std::string &which)
{
    const bool xml = is_xml(text);
    const YAML::Node document = xml ? camera_load_xml(text) : yaml_load_plain(text);
    const FieldMap root(document, "");
    CameraFile file;
    file.format = format_of(root, xml);
    switch (file.format) {
    case CameraFormat::ros:
        camera_read_ros(document, root, file);
        file.comments = camera_read_comments(text, document);
        break;
    case CameraFormat::opencv_yaml:
    case CameraFormat::opencv_xml:
        camera_read_opencv(document, root, file);
        break;
    case CameraFormat::kalibr:
        camera_read_kalibr(root, which, file);
        break;
    }
    if (!which.empty() && file.format != CameraFormat::kalibr) {
        throw FieldError("holds one camera without a name, not '" + which + "'");
    }
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

std::string camera_one_line(const std::string &message)
{
    std::string line = message.substr(0, MESSAGE_CHARS_MAX);
    std::replace_if(
        line.begin(), line.end(),
        [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return line;
}

bool camera_root_key(const std::string &name)
{
    return std::any_of(std::begin(ROOT_KEYS), std::end(ROOT_KEYS),
                       [&](const char *key) { return name == key; });
}

void camera_read_extras(const YAML::Node &map, bool (*ours)(const std::string &),
                        std::vector<CameraExtra> &extras)
{
    for (const auto &entry : map) {
        if (!ours(entry.first.Scalar())) {
            extras.push_back({entry.first.Scalar(), yaml_flow(entry.first),
                              yaml_flow(entry.second)});
        }
    }
}

bool camera_file_parse(const void *bytes, std::size_t size, CameraFile &file, std::string &error,
                       const std::string &which) noexcept
{
    try {
        if (size > CAMERA_FILE_BYTES_MAX) {
            error = "is no camera file: larger than 1 MiB";
            return false;
        }
        const char *text = static_cast<const char *>(bytes);
        if (size != 0 && std::memchr(text, 0, size) != nullptr) {
            error = "is no camera file: it holds binary data";
            return false;
        }
        file = parse(size == 0 ? std::string() : std::string(text, size), which);
        return true;
    } catch (const YAML::Exception &e) {
        error = camera_one_line("line " + std::to_string(e.mark.line + 1) +
                                ": is not valid YAML: " + e.msg);
    } catch (const std::bad_alloc &) {
        error = "out of memory"; /* short enough to need none */
    } catch (const std::exception &e) {
        error = camera_one_line(e.what());
    }
    return false;
}

bool camera_file_read(const std::string &path, CameraFile &file, std::string &error,
                      const std::string &which) noexcept
{
    try {
        std::string bytes;
        if (!read_bytes(path, bytes, error)) {
            return false;
        }
        std::string what;
        if (camera_file_parse(bytes.data(), bytes.size(), file, what, which)) {
            return true;
        }
        error = path + ": " + what;
    } catch (const std::exception &) {
        error = "out of memory";
    }
    return false;
}

}  // namespace opms_host
