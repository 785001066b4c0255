/* SPDX-License-Identifier: Apache-2.0 */
#include "json_limits.hpp"

#include <algorithm>

namespace opms_host {

namespace {

int depth_of(std::string_view text)
{
    int depth = 0, deepest = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); i++) {
        const char c = text[i];
        if (in_string) {
            i += c == '\\' ? 1 : 0;
            in_string = c != '"';
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            deepest = std::max(deepest, ++depth);
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return deepest;
}

}  // namespace

bool json_from_outside(std::string_view text, int depth_max, nlohmann::json &json,
                       std::string &error)
{
    if (depth_of(text) > depth_max) {
        error = "is nested deeper than " + std::to_string(depth_max);
        return false;
    }
    try {
        json = nlohmann::json::parse(text.begin(), text.end());
    } catch (const nlohmann::json::parse_error &e) {
        error = "is not JSON, at byte " + std::to_string(e.byte);
        return false;
    } catch (const nlohmann::json::exception &) {
        error = "holds a number that is too large";
        return false;
    }
    return true;
}

std::string json_text(const nlohmann::ordered_json &json)
{
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace opms_host
