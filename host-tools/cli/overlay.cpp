/* SPDX-License-Identifier: Apache-2.0 */
#include "overlay.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include <opencv2/imgproc.hpp>

#include "overlay_parts.hpp"
#include "picture_file.hpp"
#include "png_matrix.hpp"

namespace {

namespace fs = std::filesystem;

constexpr double WIDTH_WANTED_PX = 2048; /* small pictures are enlarged to about this */
constexpr double MAGNIFICATION_MAX = 4;
constexpr int PANEL_HEIGHT_MIN_PX = 1200;
constexpr int PNG_LEVEL = 3; /* light: an overlay is looked at once, and 9 takes a second */
constexpr double BRIGHTNESS = 0.8; /* of the picture behind the marks */

/** The picture as 8 bit BGR, enlarged and a little darker. */
cv::Mat backdrop(const OverlayScene &scene, double magnification)
{
    const cv::Mat grey = picture_grey(scene.picture);
    const double white = scene.white_level       ? scene.white_level
                         : grey.depth() == CV_8U ? 255
                                                 : 65535;
    cv::Mat eight, large, bgr;
    grey.convertTo(eight, CV_8U, BRIGHTNESS * 255 / white);
    cv::resize(eight, large, cv::Size(), magnification, magnification, cv::INTER_LINEAR);
    cv::cvtColor(large, bgr, cv::COLOR_GRAY2BGR);
    return bgr;
}

bool write_file(const std::string &path, const std::vector<unsigned char> &bytes,
                std::string &error)
{
    errno = 0;
    std::FILE *out = std::fopen(path.c_str(), "wb");
    bool good = out != nullptr;
    if (out) {
        good = std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
        good = std::fclose(out) == 0 && good;
    }
    if (!good) {
        error = path + ": cannot write the overlay: " + std::strerror(errno);
    }
    return good;
}

}  // namespace

cv::Mat overlay_draw(const OverlayScene &scene)
{
    const double magnification = std::clamp(std::round(WIDTH_WANTED_PX / scene.picture.cols), 1.0,
                                            MAGNIFICATION_MAX);
    cv::Mat left = backdrop(scene, magnification);
    overlay_draw_marks(Canvas(left, magnification), scene);

    const int height = std::max(left.rows, PANEL_HEIGHT_MIN_PX);
    const int panel_width = static_cast<int>(height * 0.44);
    cv::Mat whole(height, left.cols + panel_width, CV_8UC3, colour::background);
    left.copyTo(whole(cv::Rect(0, 0, left.cols, left.rows)));
    overlay_draw_panel(whole(cv::Rect(left.cols, 0, panel_width, height)), scene, magnification);
    return whole;
}

std::unique_ptr<OverlayFolder> OverlayFolder::open(const std::string &path, std::string &error)
{
    std::error_code code;
    fs::create_directories(path, code);
    if (!fs::is_directory(path)) {
        error = path + ": cannot make the overlay folder: " +
                (code ? code.message() : std::string("a file of that name is in the way"));
        return nullptr;
    }
    if (access(path.c_str(), W_OK | X_OK) != 0) {
        error = path + ": cannot write to the overlay folder: " + std::strerror(errno);
        return nullptr;
    }
    return std::unique_ptr<OverlayFolder>(new OverlayFolder(path));
}

std::string OverlayFolder::file_for(const std::string &image)
{
    const std::string stem = fs::path(image).stem().string();
    std::string name = stem;
    for (int n = 2; !used_.insert(name).second; n++) {
        name = stem + "-" + std::to_string(n);
    }
    return (fs::path(path_) / (name + ".overlay.png")).string();
}

bool OverlayFolder::write(const OverlayScene &scene, std::string &error)
{
    const std::string path = file_for(scene.result.image);
    const auto bytes = opms_host::png_from_matrix(overlay_draw(scene), PNG_LEVEL);
    if (bytes.empty()) {
        error = path + ": cannot write the overlay: it cannot be packed";
        return false;
    }
    return write_file(path, bytes, error);
}
