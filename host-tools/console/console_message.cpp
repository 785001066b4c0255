/* SPDX-License-Identifier: Apache-2.0 */
#include "console_message.hpp"

#include <boost/asio/error.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace opms_host {

namespace http = boost::beast::http;

HttpRequest console_request(const BeastRequest &request, bool secure, bool upgrade)
{
    HttpRequest plain;
    plain.method = std::string(request.method_string());
    plain.target = std::string(request.target());
    for (const auto &field : request) {
        plain.headers.push_back({std::string(field.name_string()), std::string(field.value())});
    }
    plain.secure = secure;
    plain.upgrade = upgrade;
    return plain;
}

BeastResponse console_response(const HttpResponse &response, bool keep_alive)
{
    BeastResponse wire(static_cast<http::status>(response.status), 11);
    wire.set(http::field::content_type, response.content_type);
    wire.set(http::field::cache_control, "no-store");
    wire.set("X-Content-Type-Options", "nosniff");
    for (const HttpHeader &header : response.headers) {
        wire.set(header.name, header.value);
    }
    wire.body() = response.body;
    wire.keep_alive(keep_alive);
    wire.prepare_payload();
    return wire;
}

bool console_expects_continue(const HttpRequest &request)
{
    const std::string *expect = request.header("Expect");
    return expect && equal_ignoring_case(*expect, "100-continue");
}

std::optional<HttpResponse> console_read_refusal(const boost::beast::error_code &error)
{
    if (error == http::error::header_limit) {
        return http_error(431, "headers", "the headers are larger than 16 KiB");
    }
    if (error == http::error::body_limit) {
        return http_error(413, "size", "the body is larger than 1 MiB");
    }
    if (error == http::error::buffer_overflow) {
        return http_error(413, "size", "the request is too large");
    }
    if (error == boost::beast::error::timeout || error == http::error::end_of_stream ||
        error == http::error::partial_message) {
        return std::nullopt; /* the stream is closed already, or is about to be */
    }
    if (error.category() == make_error_code(http::error::bad_method).category()) {
        return http_error(400, "http", "this is no HTTP request: " + error.message());
    }
    return std::nullopt;
}

}  // namespace opms_host
