/* SPDX-License-Identifier: Apache-2.0 */
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "recorder.hpp"
#include "scan_folder.hpp"

namespace opms_host {

namespace {

constexpr std::size_t NAME_MOST = 100;

bool is_allowed(char c)
{
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           c == '-' || c == '_' || c == '.' || c == ' ';
}

std::string date_and_time(std::int64_t wall_ns)
{
    const auto seconds = static_cast<std::time_t>(wall_ns / 1000000000);
    std::tm utc = {};
    char text[32] = "";
    if (::gmtime_r(&seconds, &utc)) {
        std::strftime(text, sizeof text, "%Y-%m-%d_%H-%M-%S", &utc);
    }
    return text;
}

}  // namespace

bool scan_name_check(const std::string &name, std::string &error)
{
    if (name.empty() || name.size() > NAME_MOST) {
        error = "a scan's name has 1 to 100 characters";
    } else if (name.front() == '.') {
        error = "a scan's name does not begin with a dot";
    } else if (name.back() == ' ' || name.back() == '.') {
        error = "a scan's name does not end with a space or a dot";
    } else {
        for (const char c : name) {
            if (!is_allowed(c)) {
                error = "a scan's name holds letters, digits, \"-\", \"_\", \".\" and spaces only";
                return false;
            }
        }
        return true;
    }
    return false;
}

std::string scan_free_name(const std::string &folder, const std::string &wanted,
                           std::int64_t wall_ns, std::string &error)
{
    const std::string first = wanted.empty() ? date_and_time(wall_ns) : wanted;
    if (!scan_name_check(first, error)) {
        return std::string();
    }
    std::string name = first;
    std::error_code ignored;
    for (int i = 2; std::filesystem::exists(std::filesystem::path(folder) / name, ignored); i++) {
        const std::string tail = "-" + std::to_string(i);
        name = first.substr(0, NAME_MOST - tail.size()) + tail;
    }
    return name;
}

}  // namespace opms_host
