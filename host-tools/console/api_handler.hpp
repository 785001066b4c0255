/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The interface itself (docs/interface.md): from a request to its response, with no network in it.
 *
 * Any thread at any time. */
#ifndef OPMS_CONSOLE_API_HANDLER_HPP
#define OPMS_CONSOLE_API_HANDLER_HPP

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "access_policy.hpp"
#include "http_message.hpp"
#include "session_control.hpp"
#include "stream_message.hpp"

namespace opms_host {

/** What requests are answered from. */
struct ApiContext {
    SessionControl &control;
    AccessPolicy policy;
    std::function<std::shared_ptr<const PoseRecord>()> newest_pose;
};

class ApiHandler {
public:
    explicit ApiHandler(ApiContext context) : context_(std::move(context)) {}

    /** Why a request is turned away by its head alone, before its body is read; none: go on. For
     * `upgrade` requests: none means that the stream may begin. */
    std::optional<HttpResponse> refusal(const HttpRequest &request) const;
    /** With refusal() in it. Answers each request, whatever it is. */
    HttpResponse handle(const HttpRequest &request) const;

    /** A stream's first wishes, by the target's query. @return Empty, or what is wrong. */
    static std::string stream_choice(const std::string &target, StreamChoice &choice);
    /** A client's message on the stream: the reply, and perhaps another @p choice. */
    std::string stream_message(const std::string &text, StreamChoice &choice) const;

    const ApiContext &context() const { return context_; }

private:
    ApiContext context_;
};

}  // namespace opms_host
#endif
