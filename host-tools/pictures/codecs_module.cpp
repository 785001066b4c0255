/* SPDX-License-Identifier: Apache-2.0 */
/* The module opms_imgcodecs.so. */
#include "picture_codecs.hpp"

#include <opencv2/imgcodecs.hpp>

bool opms_codecs_decode(const std::vector<unsigned char> &file, cv::Mat &picture)
{
    try {
        picture = cv::imdecode(file, cv::IMREAD_UNCHANGED);
        return !picture.empty();
    } catch (const cv::Exception &) {
        return false;
    }
}

bool opms_codecs_jpeg(const cv::Mat &picture, int quality, std::vector<unsigned char> &file)
{
    try {
        return cv::imencode(".jpg", picture, file, {cv::IMWRITE_JPEG_QUALITY, quality});
    } catch (const cv::Exception &) {
        return false;
    }
}
