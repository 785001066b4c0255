/* SPDX-License-Identifier: Apache-2.0 */
#include "export_picture.hpp"

#include <fstream>
#include <iterator>
#include <vector>

#include "picture_file.hpp"
#include "png_matrix.hpp"

namespace opms_host {

namespace {

constexpr int PNG_LEVEL = 1;
const std::string PNG_MAGIC("\x89PNG\r\n\x1a\n", 8);

bool read_whole(const std::string &path, std::string &bytes)
{
    std::ifstream file(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    return !file.bad() && file.is_open();
}

}  // namespace

bool export_picture_png(const std::string &path, std::int32_t width_px, std::int32_t height_px,
                        std::string &png, std::string &error)
{
    std::string why;
    const cv::Mat picture = picture_read(path, width_px, height_px, why);
    if (picture.empty() || !read_whole(path, png)) {
        error = path + ": " + (why.empty() ? "cannot be read" : why);
        return false;
    }
    if (png.compare(0, PNG_MAGIC.size(), PNG_MAGIC) == 0) {
        return true;
    }
    const std::vector<unsigned char> packed = png_from_matrix(picture, PNG_LEVEL);
    if (packed.empty()) {
        error = path + ": cannot be packed as PNG";
        return false;
    }
    png.assign(packed.begin(), packed.end());
    return true;
}

}  // namespace opms_host
