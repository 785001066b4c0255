/* SPDX-License-Identifier: Apache-2.0 */
#include "box_place.hpp"

#include <charconv>
#include <cstring>

namespace {

const char *const FORMS = "hid, hid:ID (16 hex digits), emulated or emulated:PORT";

bool parse_id(const std::string &id, opms_box_options_t &options)
{
    if (id.size() != OPMS_BOX_ID_SIZE - 1 ||
        id.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos) {
        return false;
    }
    std::memcpy(options.unique_id, id.c_str(), OPMS_BOX_ID_SIZE);
    return true;
}

bool parse_port(const std::string &port, opms_box_options_t &options)
{
    const char *const end = port.data() + port.size();
    const auto [next, error] = std::from_chars(port.data(), end, options.emulated_port);
    return error == std::errc() && next == end && options.emulated_port != 0;
}

}  // namespace

bool box_place_parse(const std::string &text, opms_box_options_t &options, std::string &error)
{
    opms_box_options_init(&options);
    const size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    const bool has_rest = colon != std::string::npos;
    const std::string rest = has_rest ? text.substr(colon + 1) : "";
    bool good = false;
    if (kind == "hid") {
        good = !has_rest || parse_id(rest, options);
    } else if (kind == "emulated") {
        options.transport = OPMS_BOX_EMULATED;
        good = !has_rest || parse_port(rest, options);
    }
    error = good ? "" : text + " is no box; give " + FORMS;
    return good;
}
