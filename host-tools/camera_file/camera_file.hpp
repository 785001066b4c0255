/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reads the camera file (docs/camera-file.md): a ROS camera_info YAML with an `opms:` mapping; or
 * what OpenCV (YAML, XML) and Kalibr write. Which it is its content says.
 *
 * Foreign bytes go in; a checked opms_camera_t or a text that names the field and its line comes
 * out. Nothing is thrown. */
#ifndef OPMS_HOST_CAMERA_FILE_HPP
#define OPMS_HOST_CAMERA_FILE_HPP

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <opms/types.h>

namespace opms_host {

/** A camera file is some 4 KB, and OpenCV's with all its points 100; beyond this it is something
 * else. */
constexpr std::size_t CAMERA_FILE_BYTES_MAX = 1024 * 1024;
constexpr long CAMERA_SIDE_MAX_PX = 16384;

enum class CameraFormat { ros, opencv_yaml, opencv_xml, kalibr };

/** Where the head stood on the grid's footprint when the first calibration picture was taken. */
struct Footprint {
    double x_m = 0, y_m = 0, yaw_rad = 0;
};

/** A field that is none of ours, kept for a rewrite: its name, and name and value as YAML text. */
struct CameraExtra {
    std::string name, key, value;
};

/** A line "# ..." that belongs to a key of the document or of `opms`; to no key: at the end. */
struct CameraComment {
    bool in_opms = false;
    std::string name, text;
};

/** All that a camera file says. */
struct CameraFile {
    opms_camera_t camera{};  /**< passed opms_camera_check() */
    std::string name;        /**< camera_name, may be empty */
    std::optional<std::string> grid;
    std::optional<Footprint> footprint;
    std::optional<double> residual_rms_px;
    std::optional<std::string> date; /**< ISO 8601, UTC */
    CameraFormat format = CameraFormat::ros;
    std::vector<CameraExtra> extras, opms_extras; /**< beside the lens; in `opms` */
    std::vector<CameraComment> comments;          /**< of ROS's form only */
    /** What was ignored, for a person to read ("line 27: ..."). */
    std::vector<std::string> notes;
};

/** Parse the bytes of a camera file.
 *
 * @param which  Which camera of a file that holds several ("cam1"); empty: there is but one.
 * @param[out] file   Written on success only.
 * @param[out] error  On failure one line, without the file's name: "line 9: ...".
 * @return Whether the camera can be used. */
bool camera_file_parse(const void *bytes, std::size_t size, CameraFile &file, std::string &error,
                       const std::string &which = std::string()) noexcept;

/** Read and parse a camera file; @p error begins with the path. */
bool camera_file_read(const std::string &path, CameraFile &file, std::string &error,
                      const std::string &which = std::string()) noexcept;

}  // namespace opms_host
#endif
