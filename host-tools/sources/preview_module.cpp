/* SPDX-License-Identifier: Apache-2.0 */
/* The module opms_preview.so: OpenCV's videoio loads more than a hundred libraries. */
#include "preview_camera.hpp"

#include <opencv2/videoio.hpp>

namespace {

class VideoioCamera : public opms_host::PreviewCamera {
public:
    bool open(int number) override { return capture_.open(number); }
    bool read(cv::Mat &picture) override { return capture_.read(picture); }
    std::string backend() const override { return capture_.getBackendName(); }

private:
    cv::VideoCapture capture_;
};

}  // namespace

opms_host::PreviewCamera *opms_preview_camera()
{
    return new VideoioCamera;
}
