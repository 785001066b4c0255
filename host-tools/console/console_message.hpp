/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Between the interface's plain messages and those of Boost.Beast. */
#ifndef OPMS_CONSOLE_CONSOLE_MESSAGE_HPP
#define OPMS_CONSOLE_CONSOLE_MESSAGE_HPP

#include <optional>

#include <boost/beast/core/error.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "http_message.hpp"

namespace opms_host {

using BeastRequest = boost::beast::http::request<boost::beast::http::string_body>;
using BeastResponse = boost::beast::http::response<boost::beast::http::string_body>;

/** The head of a request; its body is not looked at. */
HttpRequest console_request(const BeastRequest &request, bool secure, bool upgrade);
BeastResponse console_response(const HttpResponse &response, bool keep_alive);
bool console_expects_continue(const HttpRequest &request);
/** The answer to what could not be read; none where nobody is there to be answered. */
std::optional<HttpResponse> console_read_refusal(const boost::beast::error_code &error);

}  // namespace opms_host
#endif
