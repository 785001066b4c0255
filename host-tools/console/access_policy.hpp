/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Who may ask anything at all. */
#ifndef OPMS_CONSOLE_ACCESS_POLICY_HPP
#define OPMS_CONSOLE_ACCESS_POLICY_HPP

#include <optional>
#include <string>

#include "http_message.hpp"
#include "listen_address.hpp"

namespace opms_host {

/** The WebSocket subprotocols: what is spoken, and how a browser brings its token along. */
constexpr char SUBPROTOCOL[] = "opms.v1", SUBPROTOCOL_TOKEN[] = "opms.token.";

struct AccessPolicy {
    std::string token;
    ListenAddress listen;
};

/** Why a request is turned away before anything is done for it; none: it may go on.
 *
 * - Host must name this machine where only this machine is served: a web page of elsewhere that had
 *   its own name pointed here (DNS rebinding) is found out by it.
 * - A page of another origin is refused, by Origin and Sec-Fetch-Site, which pages cannot forge.
 * - The token must be right: "Authorization: Bearer", for a WebSocket also a subprotocol. */
std::optional<HttpResponse> access_refusal(const AccessPolicy &policy, const HttpRequest &request);

/** Whether the client offers SUBPROTOCOL, which the answer then confirms. */
bool offers_subprotocol(const HttpRequest &request);

}  // namespace opms_host
#endif
