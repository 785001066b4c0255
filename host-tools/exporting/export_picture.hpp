/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A stored picture as a PNG file's bytes. */
#ifndef OPMS_EXPORTING_EXPORT_PICTURE_HPP
#define OPMS_EXPORTING_EXPORT_PICTURE_HPP

#include <cstdint>
#include <string>

namespace opms_host {

/** Bytes of a PNG of the picture: the file's own where it is one, else the same pixels packed anew.
 * It is unpacked to see that it is whole and of its size. False with @p error, which begins with
 * the path. */
bool export_picture_png(const std::string &path, std::int32_t width_px, std::int32_t height_px,
                        std::string &png, std::string &error);

}  // namespace opms_host
#endif
