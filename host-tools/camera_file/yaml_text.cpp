/* SPDX-License-Identifier: Apache-2.0 */
#include "yaml_text.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>

namespace opms_host {
namespace {

constexpr int DIGITS = 17;

/** Whether a plain scalar may stand unquoted within brackets, whatever is around it. */
bool is_plain(const std::string &text)
{
    const auto harmless = [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
               (c != 0 && std::strchr("_./+-~", c) != nullptr);
    };
    return !text.empty() && text != "-" && text != "---" && text != "..." &&
           std::all_of(text.begin(), text.end(), harmless);
}

std::string scalar_text(const YAML::Node &node)
{
    const bool was_plain = node.Tag() == "?" || node.Tag().empty();
    return was_plain && is_plain(node.Scalar()) ? node.Scalar() : yaml_quoted(node.Scalar());
}

/** A tag that the file gave itself; "?" and "!" are the parser's own. OpenCV's for a matrix says
 * nothing that its keys do not, and other readers stumble over it. */
std::string tag_text(const YAML::Node &node)
{
    const std::string &tag = node.Tag();
    const bool silent =
        tag.empty() || tag == "?" || tag == "!" || tag == "tag:yaml.org,2002:opencv-matrix";
    return silent ? std::string() : "!<" + tag + "> ";
}

std::string sequence_text(const YAML::Node &node)
{
    std::string text = "[";
    for (const auto &item : node) {
        text += (text.size() > 1 ? ", " : "") + yaml_flow(item);
    }
    return text + "]";
}

std::string map_text(const YAML::Node &node)
{
    std::string text = "{";
    for (const auto &entry : node) {
        text += (text.size() > 1 ? ", " : "") + yaml_flow(entry.first) + ": " +
                yaml_flow(entry.second);
    }
    return text + "}";
}

}  // namespace

std::string yaml_number(double value)
{
    char buffer[40];
    const std::to_chars_result end =
        std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, DIGITS);
    std::string text(buffer, end.ptr);
    const std::size_t exponent = text.find('e');
    if (text.find('.') == std::string::npos) {
        text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
    }
    return text;
}

std::string yaml_numbers(const double *values, std::size_t count)
{
    std::string text = "[";
    for (std::size_t i = 0; i < count; i++) {
        text += (i ? ", " : "") + yaml_number(values[i]);
    }
    return text + "]";
}

std::string yaml_quoted(const std::string &text)
{
    std::string out = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += '\\';
            out += c;
        } else if (byte < 0x20 || byte == 0x7f) {
            char escape[8];
            std::snprintf(escape, sizeof escape, "\\x%02x", byte);
            out += escape;
        } else {
            out += c;
        }
    }
    return out + "\"";
}

std::string yaml_flow(const YAML::Node &node)
{
    if (node.IsSequence()) {
        return tag_text(node) + sequence_text(node);
    }
    if (node.IsMap()) {
        return tag_text(node) + map_text(node);
    }
    return node.IsScalar() ? tag_text(node) + scalar_text(node) : "null";
}

}  // namespace opms_host
