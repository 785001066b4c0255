/* SPDX-License-Identifier: Apache-2.0 */
#include "text_table.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace {

constexpr std::size_t NAME_WIDTH_LEAST = 7, NAME_WIDTH_MOST = 60;

std::size_t shown_width(const std::string &name)
{
    return static_cast<std::size_t>(std::count_if(name.begin(), name.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    }));
}

}  // namespace

std::string text_format(const char *format, ...)
{
    char buffer[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(buffer, sizeof buffer, format, arguments);
    va_end(arguments);
    return buffer;
}

std::string text_padded(const std::string &name, std::size_t width)
{
    const std::size_t shown = shown_width(name);
    return shown < width ? name + std::string(width - shown, ' ') : name;
}

std::size_t text_name_width(const std::vector<std::string> &names)
{
    std::size_t width = NAME_WIDTH_LEAST;
    for (const std::string &name : names) {
        width = std::max(width, shown_width(name));
    }
    return std::min(width, NAME_WIDTH_MOST);
}
