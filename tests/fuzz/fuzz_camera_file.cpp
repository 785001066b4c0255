/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a camera file: refused with a text, or taken with values that can be used. */
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <opms/lens.h>

#include "camera_file.hpp"

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
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, std::size_t size)
{
    opms_host::CameraFile file;
    std::string error;
    if (opms_host::camera_file_parse(data, size, file, error)) {
        check_taken(file);
    } else {
        require(!error.empty() && error.find('\n') == std::string::npos);
    }
    return 0;
}
