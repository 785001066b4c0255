/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the program and its module opms_preview.so know of each other. */
#ifndef OPMS_SOURCES_PREVIEW_CAMERA_HPP
#define OPMS_SOURCES_PREVIEW_CAMERA_HPP

#include <string>

#include <opencv2/core.hpp>

namespace opms_host {

/** A camera of OpenCV. */
class PreviewCamera {
public:
    virtual ~PreviewCamera() = default;
    /** @param number  As OpenCV counts cameras. */
    virtual bool open(int number) = 0;
    virtual bool read(cv::Mat &picture) = 0;
    /** What OpenCV reaches it by. */
    virtual std::string backend() const = 0;
};

}  // namespace opms_host

/** The module's function. @return A closed camera for delete. */
extern "C" opms_host::PreviewCamera *opms_preview_camera();

#endif
