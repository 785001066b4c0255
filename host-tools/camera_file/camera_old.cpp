/* SPDX-License-Identifier: Apache-2.0 */
/* An old file need not be a good camera to be replaced by one, but it must be a camera file. */
#include "camera_old.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "camera_comments.hpp"
#include "camera_parts.hpp"

namespace opms_host {
namespace {

std::string bytes_of(const std::string &path)
{
    std::ifstream in(path, std::ios::binary);
    std::string bytes(CAMERA_FILE_BYTES_MAX + 1, '\0');
    in.read(&bytes[0], static_cast<std::streamsize>(bytes.size()));
    if (in.bad() || (!in.eof() && in.fail())) {
        throw FieldError(std::string("is there but cannot be read: ") + std::strerror(errno));
    }
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    if (bytes.size() > CAMERA_FILE_BYTES_MAX || bytes.find('\0') != std::string::npos) {
        throw FieldError("is no camera file");
    }
    return bytes;
}

/** Also of a lens that cannot be used. */
CameraFile read_ros(const std::string &bytes, const YAML::Node &document, const FieldMap &root)
{
    CameraFile old;
    if (root.has("camera_name")) {
        old.name = root.get("camera_name").text();
    }
    camera_read_extras(document, camera_root_key, old.extras);
    if (root.has("opms") && !root.get("opms").node.IsNull()) {
        const FieldMap opms = root.map("opms");
        if (opms.has("version") && opms.get("version").number() != 1) {
            opms.get("version").fail("is not 1: the file was written for another version of opms");
        }
        camera_read_extras(root.get("opms").node, camera_opms_key, old.opms_extras);
    }
    old.comments = camera_read_comments(bytes, document);
    return old;
}

}  // namespace

CameraFile camera_read_old(const std::string &path)
{
    const std::string bytes = bytes_of(path);
    CameraFile old;
    std::string error;
    if (camera_file_parse(bytes.data(), bytes.size(), old, error)) {
        return old;
    }
    const YAML::Node document = yaml_load_plain(bytes);
    const FieldMap root(document, "");
    if (camera_is_kalibr(root) || camera_is_opencv(root)) {
        throw FieldError(error);
    }
    if (!root.has("camera_matrix")) {
        throw FieldError("is no camera file");
    }
    return read_ros(bytes, document, root);
}

}  // namespace opms_host
