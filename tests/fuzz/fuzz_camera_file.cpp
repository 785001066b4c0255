/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a camera file of any format: refused with a text, or taken with values that can be
 * used, that every format hands on, and that nothing is lost of. */
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <opms/lens.h>

#include "camera_file.hpp"
#include "camera_parts.hpp"

namespace {

void require(bool holds)
{
    if (!holds) {
        std::abort();
    }
}

/** What a camera that was taken promises. */
void check_taken(const opms_host::CameraFile &file)
{
    const opms_camera_t &camera = file.camera;
    require(opms_lens_check(&camera.lens, nullptr) == OPMS_OK);
    for (const double value : camera.detector_camera.R) {
        require(std::isfinite(value));
    }
    for (const double value : camera.covariance_intrinsics) {
        require(std::isfinite(value));
    }
    for (const double value : camera.covariance_detector_camera) {
        require(std::isfinite(value));
    }
    for (const double value : camera.covariance_detector_camera_intrinsics) {
        require(std::isfinite(value));
    }
}

/** Written in a format and read again: the same lens. Where it cannot be, it is refused. */
void check_written(const opms_host::CameraFile &file, const std::string &text)
{
    opms_host::CameraFile again;
    std::string error;
    if (!opms_host::camera_file_parse(text.data(), text.size(), again, error)) {
        require(text.size() > opms_host::CAMERA_FILE_BYTES_MAX ||
                error.find("nested too deeply") != std::string::npos);
        return;
    }
    const opms_lens_t &a = file.camera.lens, &b = again.camera.lens;
    require(a.fx_px == b.fx_px && a.fy_px == b.fy_px && a.cx_px == b.cx_px && a.cy_px == b.cy_px &&
            a.k1 == b.k1 && a.k2 == b.k2 && a.p1 == b.p1 && a.p2 == b.p2);
    require(again.camera.has_detector_camera == file.camera.has_detector_camera);
}

void check_all_formats(const opms_host::CameraFile &file)
{
    std::vector<std::string> notes;
    check_written(file, opms_host::camera_ros_text(file));
    check_written(file, opms_host::camera_kalibr_text(file));
    check_written(file, opms_host::camera_opencv_yaml_text(file, notes));
    check_written(file, opms_host::camera_opencv_xml_text(file, notes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, std::size_t size)
{
    opms_host::CameraFile file;
    std::string error;
    if (opms_host::camera_file_parse(data, size, file, error)) {
        check_taken(file);
        check_all_formats(file);
    } else {
        require(!error.empty() && error.find('\n') == std::string::npos);
    }
    return 0;
}
