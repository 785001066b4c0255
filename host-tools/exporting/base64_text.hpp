/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Bytes as text (RFC 4648, with padding). */
#ifndef OPMS_EXPORTING_BASE64_TEXT_HPP
#define OPMS_EXPORTING_BASE64_TEXT_HPP

#include <string>

namespace opms_host {

std::string base64_text(const std::string &bytes);

}  // namespace opms_host
#endif
