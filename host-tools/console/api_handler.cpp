/* SPDX-License-Identifier: Apache-2.0 */
#include "api_handler.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "api_calls.hpp"
#include "json_limits.hpp"

namespace opms_host {

namespace {

constexpr std::string_view ROOT = "/api/v1/", STREAM = "stream", SCANS = "scans/";

enum class Body { none, optional, needed };

struct Route {
    std::string_view method, path; /* behind ROOT; "scans/" goes on with a name */
    Body body;
    HttpResponse (*call)(const ApiCall &);
};

constexpr std::array<Route, 11> ROUTES = {{
    {"GET", "version", Body::none, api_version},
    {"GET", "state", Body::none, api_state},
    {"GET", "pose", Body::none, api_pose},
    {"GET", "picture", Body::none, api_picture},
    {"POST", "scan", Body::optional, api_scan_start},
    {"POST", "scan/stop", Body::none, api_scan_stop},
    {"DELETE", "scan", Body::none, api_scan_stop},
    {"POST", "start", Body::none, api_press_start},
    {"GET", "scans", Body::none, api_scans},
    {"GET", SCANS, Body::none, api_scan},
    {"POST", "samples", Body::needed, api_samples},
}};

/** The part of ROUTES that a path means; empty: none. */
std::string_view route_path(std::string_view path)
{
    if (path.substr(0, ROOT.size()) != ROOT) {
        return {};
    }
    path.remove_prefix(ROOT.size());
    const bool named = path.size() > SCANS.size() && path.substr(0, SCANS.size()) == SCANS &&
                       path.find('/', SCANS.size()) == std::string_view::npos;
    if (named) {
        return SCANS;
    }
    return path == SCANS ? std::string_view() : path;
}

const Route *find_route(std::string_view path, std::string_view method)
{
    const auto found =
        std::find_if(ROUTES.begin(), ROUTES.end(), [path, method](const Route &route) {
            return route.path == path && route.method == method;
        });
    return found == ROUTES.end() ? nullptr : &*found;
}

std::string methods_of(std::string_view path)
{
    std::string methods;
    for (const Route &route : ROUTES) {
        if (route.path == path) {
            methods += (methods.empty() ? "" : ", ") + std::string(route.method);
        }
    }
    return methods;
}

HttpResponse wrong_method(const std::string &allowed)
{
    HttpResponse response = http_error(405, "method", "this path takes " + allowed);
    response.headers.push_back({"Allow", allowed});
    return response;
}

bool is_json_type(const std::string &type)
{
    const std::string_view name = std::string_view(type).substr(0, type.find(';'));
    const std::size_t end = name.find_last_not_of(' ');
    return equal_ignoring_case(name.substr(0, end + 1), "application/json");
}

bool has_body(const HttpRequest &request)
{
    const std::string *length = request.header("Content-Length");
    return request.count("Transfer-Encoding") > 0 || (length && *length != "0");
}

std::optional<HttpResponse> body_refusal(Body body, const HttpRequest &request)
{
    if (body == Body::needed && request.count("Content-Length") == 0 &&
        request.count("Transfer-Encoding") == 0) {
        return http_error(411, "length", "a body with its Content-Length is needed");
    }
    if (!has_body(request)) {
        return std::nullopt;
    }
    if (body == Body::none) {
        return http_error(400, "body", "this call takes no body");
    }
    const std::string *type = request.header("Content-Type");
    if (!type || !is_json_type(*type)) {
        return http_error(415, "content-type", "Content-Type must be application/json");
    }
    return std::nullopt;
}

/** Whether the path, the method and the body's kind fit together. */
std::optional<HttpResponse> route_refusal(const HttpRequest &request)
{
    HttpTarget target;
    if (!parse_target(request.target, target)) {
        return http_error(400, "target", "the request's target is malformed");
    }
    const std::string_view path = route_path(target.path);
    if (path == STREAM) {
        if (request.method != "GET") {
            return wrong_method("GET");
        }
        if (!request.upgrade) {
            HttpResponse response = http_error(426, "upgrade", "this path is a WebSocket's");
            response.headers.push_back({"Upgrade", "websocket"});
            return response;
        }
        StreamChoice choice;
        const std::string problem = ApiHandler::stream_choice(request.target, choice);
        return problem.empty() ? std::nullopt
                               : std::make_optional(http_error(400, "query", problem));
    }
    const std::string allowed = methods_of(path);
    if (path.empty() || allowed.empty()) {
        return http_error(404, "path", "there is no such path; see docs/interface.md");
    }
    if (request.upgrade) {
        return http_error(400, "upgrade", "only /api/v1/stream is a WebSocket");
    }
    const Route *route = find_route(path, request.method);
    return route ? body_refusal(route->body, request) : wrong_method(allowed);
}

bool parse_body(const Route &route, const HttpRequest &request, nlohmann::json &json,
                HttpResponse &refused)
{
    if (request.body.empty() && route.body != Body::needed) {
        return true;
    }
    std::string error;
    if (request.body.size() > HTTP_BODY_BYTES_MAX) {
        refused = http_error(413, "size", "the body is larger than 1 MiB");
        return false;
    }
    if (!json_from_outside(request.body, JSON_DEPTH_MAX, json, error)) {
        refused = http_error(400, "json", "the body " + error);
        return false;
    }
    return true;
}

}  // namespace

std::optional<HttpResponse> ApiHandler::refusal(const HttpRequest &request) const
{
    std::optional<HttpResponse> refused = access_refusal(context_.policy, request);
    return refused ? refused : route_refusal(request);
}

HttpResponse ApiHandler::handle(const HttpRequest &request) const
{
    if (std::optional<HttpResponse> refused = refusal(request)) {
        return *refused;
    }
    HttpTarget target;
    parse_target(request.target, target);
    const Route *route = find_route(route_path(target.path), request.method);
    if (!route) { /* the stream: whoever carries the request makes a WebSocket of it */
        return http_error(426, "upgrade", "this path is a WebSocket's");
    }
    ApiCall call = {context_, request, target, "", nullptr};
    if (route->path == SCANS &&
        !percent_decode(std::string_view(target.path).substr(ROOT.size() + SCANS.size()),
                        call.name)) {
        return http_error(400, "target", "the request's target is malformed");
    }
    HttpResponse refused;
    return parse_body(*route, request, call.body, refused) ? route->call(call) : refused;
}

}  // namespace opms_host
