/* SPDX-License-Identifier: Apache-2.0 */
#include "access_policy.hpp"

#include <algorithm>
#include <vector>

#include "access_token.hpp"

namespace opms_host {

namespace {

constexpr std::string_view BEARER = "bearer ";

std::string_view without_port(std::string_view host)
{
    if (!host.empty() && host.front() == '[') {
        const std::size_t end = host.find(']');
        return end == std::string_view::npos ? host : host.substr(0, end + 1);
    }
    return host.substr(0, std::min(host.rfind(':'), host.size()));
}

bool is_own_host(const AccessPolicy &policy, std::string_view host)
{
    if (!policy.listen.is_loopback) {
        return !host.empty(); /* by any name; its token is the owner's, not known to any page */
    }
    const std::string_view name = without_port(host);
    return equal_ignoring_case(name, "localhost") || name == "127.0.0.1" || name == "[::1]" ||
           name == policy.listen.url_host();
}

bool is_cross_site(const HttpRequest &request, const std::string &host)
{
    if (request.count("Origin") > 0) {
        const std::string *origin = request.header("Origin");
        const std::string own = (request.secure ? "https://" : "http://") + host;
        if (!origin || !equal_ignoring_case(*origin, own)) {
            return true;
        }
    }
    if (request.count("Sec-Fetch-Site") > 0) {
        const std::string *site = request.header("Sec-Fetch-Site");
        return !site || (*site != "same-origin" && *site != "none");
    }
    return false;
}

std::vector<std::string_view> offered_subprotocols(const HttpRequest &request)
{
    std::vector<std::string_view> names;
    const std::string *value = request.header("Sec-WebSocket-Protocol");
    if (!request.upgrade || !value) {
        return names;
    }
    const std::string_view list = *value;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        std::string_view name = list.substr(begin, end - begin);
        name.remove_prefix(std::min(name.find_first_not_of(" \t"), name.size()));
        name = name.substr(0, name.find_last_not_of(" \t") + 1);
        names.push_back(name);
        begin = end + 1;
    }
    return names;
}

/** The one token that a request brings; empty: none, or more than one. */
std::string given_token(const HttpRequest &request)
{
    std::vector<std::string> tokens;
    for (const HttpHeader &header : request.headers) {
        if (equal_ignoring_case(header.name, "Authorization") &&
            equal_ignoring_case(header.value.substr(0, BEARER.size()), BEARER)) {
            tokens.push_back(header.value.substr(BEARER.size()));
        }
    }
    constexpr std::string_view prefix = SUBPROTOCOL_TOKEN;
    for (const std::string_view name : offered_subprotocols(request)) {
        if (name.substr(0, prefix.size()) == prefix) {
            tokens.emplace_back(name.substr(prefix.size()));
        }
    }
    return tokens.size() == 1 ? tokens.front() : std::string();
}

}  // namespace

bool offers_subprotocol(const HttpRequest &request)
{
    const auto names = offered_subprotocols(request);
    return std::find(names.begin(), names.end(), std::string_view(SUBPROTOCOL)) != names.end();
}

std::optional<HttpResponse> access_refusal(const AccessPolicy &policy, const HttpRequest &request)
{
    const std::string *host = request.header("Host");
    if (!host) {
        return http_error(400, "host", "a request names one Host");
    }
    if (!is_own_host(policy, *host)) {
        return http_error(403, "host", "this interface is not known by that Host's name");
    }
    if (is_cross_site(request, *host)) {
        return http_error(403, "origin", "pages of other origins may not use this interface");
    }
    const std::string token = given_token(request);
    if (token.empty() || !access_token_equal(token, policy.token)) {
        HttpResponse response =
            http_error(401, "token",
                       token.empty() ? "a token is needed: Authorization: Bearer TOKEN"
                                     : "that is not the token");
        response.headers.push_back({"WWW-Authenticate", "Bearer realm=\"opms\""});
        return response;
    }
    return std::nullopt;
}

}  // namespace opms_host
