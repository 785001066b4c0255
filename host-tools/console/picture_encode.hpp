/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A camera's picture as a file's bytes, for a display. */
#ifndef OPMS_CONSOLE_PICTURE_ENCODE_HPP
#define OPMS_CONSOLE_PICTURE_ENCODE_HPP

#include <string>

#include <opms/types.h>

namespace opms_host {

/** PNG keeps all bits; JPEG is of 8 bits, with white at the picture's white level.
 * @return false with @p error. */
bool picture_encode(const opms_image_t &image, bool png, std::string &bytes, std::string &error);

}  // namespace opms_host
#endif
