/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Request and response as values, so that all the interface does is a function from one to the
 * other, whatever carries them. */
#ifndef OPMS_CONSOLE_HTTP_MESSAGE_HPP
#define OPMS_CONSOLE_HTTP_MESSAGE_HPP

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace opms_host {

constexpr std::size_t HTTP_HEADER_BYTES_MAX = 16384, HTTP_BODY_BYTES_MAX = 1048576;
constexpr int JSON_DEPTH_MAX = 16;

struct HttpHeader {
    std::string name, value;
};

struct HttpRequest {
    std::string method, target; /**< as they were sent */
    std::vector<HttpHeader> headers;
    std::string body;
    bool secure = false;        /**< came over TLS */
    bool upgrade = false;       /**< asks for a WebSocket */

    /** The value of a header that is there exactly once, by any letter case; else NULL. */
    const std::string *header(std::string_view name) const;
    std::size_t count(std::string_view name) const;
};

struct HttpResponse {
    int status = 200;
    std::string content_type = "application/json";
    std::string body;
    std::vector<HttpHeader> headers; /**< besides those that every response has */
};

/** {"error":{"code":...,"message":...}} */
HttpResponse http_error(int status, const std::string &code, const std::string &message);
std::string error_json(const std::string &code, const std::string &message);

bool equal_ignoring_case(std::string_view a, std::string_view b);
/** %41 becomes A. @return false for what is no such text, or holds a control character. */
bool percent_decode(std::string_view text, std::string &decoded);

/** A target's path and the fields behind its question mark. */
struct HttpTarget {
    std::string path;
    std::vector<HttpHeader> query;
    const std::string *field(std::string_view name) const;
};
bool parse_target(std::string_view target, HttpTarget &parsed);

}  // namespace opms_host
#endif
