/* SPDX-License-Identifier: Apache-2.0 */
#include <algorithm>

#include "session_control.hpp"

namespace opms_host {

namespace {

constexpr std::size_t NAME_MAX_BYTES = 100;

bool is_name_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           c == '-' || c == '_' || c == '.' || c == ' ';
}

}  // namespace

std::string scan_name_problem(const std::string &name)
{
    if (name.empty() || name.size() > NAME_MAX_BYTES) {
        return "a scan's name is 1 to 100 characters long";
    }
    if (!std::all_of(name.begin(), name.end(), is_name_character)) {
        return "a scan's name holds letters, digits, '-', '_', '.' and blanks only";
    }
    if (name.front() == '.' || name.back() == '.' || name.back() == ' ') {
        return "a scan's name does not begin with a dot, nor end with a dot or a blank";
    }
    return "";
}

}  // namespace opms_host
