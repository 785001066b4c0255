/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * JSON from outside. */
#ifndef OPMS_CONSOLE_JSON_LIMITS_HPP
#define OPMS_CONSOLE_JSON_LIMITS_HPP

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace opms_host {

/** @return false with @p error for what is not JSON (UTF-8, finite numbers), or is nested deeper
 * than @p depth_max: that is found before anything is built. */
bool json_from_outside(std::string_view text, int depth_max, nlohmann::json &json,
                       std::string &error);

/** For the wire: what is not UTF-8 is replaced, what is not finite is null. */
std::string json_text(const nlohmann::ordered_json &json);

}  // namespace opms_host
#endif
