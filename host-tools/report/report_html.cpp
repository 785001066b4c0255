/* SPDX-License-Identifier: Apache-2.0 */
#include "report_html.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>

namespace {

constexpr const char *REPLACEMENT = "\xef\xbf\xbd";

/** Bytes of the UTF-8 character that begins at @p i; 0 where none does. */
std::size_t utf8_length(const std::string &text, std::size_t i)
{
    const auto byte = [&](std::size_t k) {
        return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U;
    };
    const auto tail = [&](std::size_t k) { return (byte(k) & 0xc0U) == 0x80U; };
    const unsigned first = byte(i);
    if (first < 0x80) {
        return 1;
    }
    if (first >= 0xc2 && first <= 0xdf) {
        return tail(i + 1) ? 2 : 0;
    }
    if (first >= 0xe0 && first <= 0xef) {
        const bool good = tail(i + 1) && tail(i + 2) && !(first == 0xe0 && byte(i + 1) < 0xa0) &&
                          !(first == 0xed && byte(i + 1) > 0x9f);
        return good ? 3 : 0;
    }
    if (first >= 0xf0 && first <= 0xf4) {
        const bool good = tail(i + 1) && tail(i + 2) && tail(i + 3) &&
                          !(first == 0xf0 && byte(i + 1) < 0x90) &&
                          !(first == 0xf4 && byte(i + 1) > 0x8f);
        return good ? 4 : 0;
    }
    return 0;
}

std::string escaped_byte(char c)
{
    switch (c) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    case '"':
        return "&quot;";
    case '\'':
        return "&#39;";
    default:
        break;
    }
    const bool control = (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') ||
                         c == 0x7f;
    return control ? REPLACEMENT : std::string(1, c);
}

const ReportJson *find(const ReportJson &report, const std::string &pointer)
{
    const ReportJson::json_pointer at(pointer);
    return report.contains(at) ? &report.at(at) : nullptr;
}

}  // namespace

std::string html_escaped(const std::string &text)
{
    std::string escaped;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_length(text, i);
        if (length == 1) {
            escaped += escaped_byte(text[i]);
        } else {
            escaped += length > 0 ? text.substr(i, length) : REPLACEMENT;
        }
        i += length > 0 ? length : 1;
    }
    return escaped;
}

std::string html_number(double value, int digits)
{
    if (!std::isfinite(value)) {
        return "\xe2\x80\x93";
    }
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    const bool is_zero = std::strspn(text, "-0.") == std::strlen(text);
    return text[0] == '-' && is_zero ? text + 1 : text;
}

std::string html_traced(const ReportJson &report, const std::string &pointer, int digits,
                        double factor)
{
    const double value = report_value(report, pointer);
    if (!std::isfinite(value)) {
        return "\xe2\x80\x93";
    }
    char scale[32];
    std::snprintf(scale, sizeof scale, "%.17g", factor);
    return "<span data-json=\"" + html_escaped(pointer) + "\" data-factor=\"" + scale + "\">" +
           html_number(factor * value, digits) + "</span>";
}

std::string html_words(const ReportJson &report, const std::string &pointer)
{
    const ReportJson *const found = find(report, pointer);
    return found && found->is_string() ? html_escaped(found->get<std::string>()) : std::string();
}

double report_value(const ReportJson &report, const std::string &pointer)
{
    const ReportJson *const found = find(report, pointer);
    return found && found->is_number() ? found->get<double>() : NAN;
}

bool report_has(const ReportJson &report, const std::string &pointer)
{
    const ReportJson *const found = find(report, pointer);
    return found && !found->is_null();
}

std::string html_section(const std::string &title, const std::string &body)
{
    return "<section>\n<h2>" + html_escaped(title) + "</h2>\n" + body + "</section>\n";
}

std::string html_figure(const std::string &svg, const std::string &caption)
{
    return "<figure>\n" + svg + "<figcaption>" + caption + "</figcaption>\n</figure>\n";
}
