/* SPDX-License-Identifier: Apache-2.0 */
#include "http_message.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace opms_host {

namespace {

char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

int hex_digit(char c)
{
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    const char letter = lower(c);
    return letter >= 'a' && letter <= 'f' ? letter - 'a' + 10 : -1;
}

}  // namespace

bool equal_ignoring_case(std::string_view a, std::string_view b)
{
    return a.size() == b.size() &&
           std::equal(a.begin(), a.end(), b.begin(),
                      [](char x, char y) { return lower(x) == lower(y); });
}

std::size_t HttpRequest::count(std::string_view name) const
{
    return static_cast<std::size_t>(
        std::count_if(headers.begin(), headers.end(), [name](const HttpHeader &header) {
            return equal_ignoring_case(header.name, name);
        }));
}

const std::string *HttpRequest::header(std::string_view name) const
{
    const std::string *found = nullptr;
    for (const HttpHeader &header : headers) {
        if (equal_ignoring_case(header.name, name)) {
            if (found) {
                return nullptr;
            }
            found = &header.value;
        }
    }
    return found;
}

std::string error_json(const std::string &code, const std::string &message)
{
    const nlohmann::ordered_json json = {{"error", {{"code", code}, {"message", message}}}};
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

HttpResponse http_error(int status, const std::string &code, const std::string &message)
{
    HttpResponse response;
    response.status = status;
    response.body = error_json(code, message) + "\n";
    return response;
}

bool percent_decode(std::string_view text, std::string &decoded)
{
    decoded.clear();
    for (std::size_t i = 0; i < text.size(); i++) {
        unsigned char c = static_cast<unsigned char>(text[i]);
        if (c == '%') {
            if (i + 2 >= text.size()) {
                return false;
            }
            const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
            if (high < 0 || low < 0) {
                return false;
            }
            c = static_cast<unsigned char>(16 * high + low);
            i += 2;
        }
        if (c < ' ' || c == 0x7f) {
            return false;
        }
        decoded.push_back(static_cast<char>(c));
    }
    return true;
}

const std::string *HttpTarget::field(std::string_view name) const
{
    for (const HttpHeader &pair : query) {
        if (pair.name == name) {
            return &pair.value;
        }
    }
    return nullptr;
}

bool parse_target(std::string_view target, HttpTarget &parsed)
{
    if (target.empty() || target.front() != '/') {
        return false;
    }
    const std::size_t mark = std::min(target.find('?'), target.size());
    parsed = {};
    parsed.path = std::string(target.substr(0, mark));
    for (std::size_t begin = mark + 1; begin < target.size();) {
        const std::size_t end = std::min(target.find('&', begin), target.size());
        const std::string_view field = target.substr(begin, end - begin);
        const std::size_t equals = std::min(field.find('='), field.size());
        HttpHeader pair;
        if (!percent_decode(field.substr(0, equals), pair.name) ||
            !percent_decode(field.substr(std::min(equals + 1, field.size())), pair.value)) {
            return false;
        }
        parsed.query.push_back(std::move(pair));
        begin = end + 1;
    }
    return true;
}

}  // namespace opms_host
