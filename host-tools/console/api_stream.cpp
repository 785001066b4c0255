/* SPDX-License-Identifier: Apache-2.0 */
/* What a client of the stream may say: which kinds it wants, and samples of its sensors. */
#include <algorithm>
#include <string_view>

#include "api_calls.hpp"
#include "json_limits.hpp"

namespace opms_host {

namespace {

using Json = nlohmann::json;

bool choose_kind(std::string_view name, StreamChoice &choice)
{
    const auto found = std::find(STREAM_KIND_NAMES.begin(), STREAM_KIND_NAMES.end(), name);
    if (found == STREAM_KIND_NAMES.end()) {
        return false;
    }
    choice.kinds[static_cast<std::size_t>(found - STREAM_KIND_NAMES.begin())] = true;
    return true;
}

std::string kinds_from_text(std::string_view list, StreamChoice &choice)
{
    choice.kinds = {};
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        if (end > begin && !choose_kind(list.substr(begin, end - begin), choice)) {
            return "kinds are pose, event and state";
        }
        begin = end + 1;
    }
    return "";
}

/** {"type":"subscribe","kinds":["pose"],"squares":true}: what is not named stays. */
std::string subscribe(const Json &message, StreamChoice &choice)
{
    StreamChoice wanted = choice;
    if (message.contains("kinds")) {
        if (!message["kinds"].is_array()) {
            return "\"kinds\" must be a list";
        }
        wanted.kinds = {};
        for (const Json &kind : message["kinds"]) {
            if (!kind.is_string() || !choose_kind(kind.get_ref<const std::string &>(), wanted)) {
                return "\"kinds\" are \"pose\", \"event\" and \"state\"";
            }
        }
    }
    if (message.contains("squares")) {
        if (!message["squares"].is_boolean()) {
            return "\"squares\" must be true or false";
        }
        wanted.squares = message["squares"].get<bool>();
    }
    choice = wanted;
    return "";
}

const char *failure_code(ControlFailure kind)
{
    switch (kind) {
    case ControlFailure::conflict: return "state";
    case ControlFailure::invalid: return "value";
    case ControlFailure::not_found: return "name";
    case ControlFailure::unavailable:
    case ControlFailure::none: break;
    }
    return "device";
}

/** @p id is the client's own, and comes back to it. */
std::string reply(nlohmann::ordered_json answer, const Json &message)
{
    if (message.is_object() && message.contains("id")) {
        answer["id"] = message["id"];
    }
    return json_text(answer);
}

std::string refusal_reply(const std::string &code, const std::string &text, const Json &message)
{
    return reply({{"schema", "opms.error/1"}, {"error", {{"code", code}, {"message", text}}}},
                 message);
}

/** @return Empty, or the first field that the message's type does not know. */
std::string unknown_field(const Json &message, std::initializer_list<std::string_view> known)
{
    for (const auto &[key, value] : message.items()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            return "there is no field \"" + key.substr(0, 40) + "\" here";
        }
    }
    return "";
}

std::string samples_reply(const ApiContext &context, const Json &message)
{
    std::size_t taken = 0;
    const ControlError error =
        api_take_samples(context, message.value("samples", Json(nullptr)), taken);
    if (error.kind != ControlFailure::none) {
        return refusal_reply(failure_code(error.kind), error.text, message);
    }
    return reply({{"schema", "opms.accepted/1"}, {"samples", taken}}, message);
}

}  // namespace

std::string ApiHandler::stream_choice(const std::string &target, StreamChoice &choice)
{
    HttpTarget parsed;
    if (!parse_target(target, parsed)) {
        return "the request's target is malformed";
    }
    StreamChoice wanted;
    if (const std::string *squares = parsed.field("squares")) {
        if (*squares != "0" && *squares != "1") {
            return "squares is 0 or 1";
        }
        wanted.squares = *squares == "1";
    }
    if (const std::string *kinds = parsed.field("kinds")) {
        const std::string problem = kinds_from_text(*kinds, wanted);
        if (!problem.empty()) {
            return problem;
        }
    }
    choice = wanted;
    return "";
}

std::string ApiHandler::stream_message(const std::string &text, StreamChoice &choice) const
{
    Json message;
    std::string problem;
    if (!json_from_outside(text, JSON_DEPTH_MAX, message, problem)) {
        return refusal_reply("json", "the message " + problem, nullptr);
    }
    if (!message.is_object() || !message.contains("type") || !message["type"].is_string()) {
        return refusal_reply("type", "a message is an object with a \"type\"", message);
    }
    const std::string type = message["type"].get<std::string>();
    if (type == "samples") {
        problem = unknown_field(message, {"type", "id", "samples"});
        return problem.empty() ? samples_reply(context_, message)
                               : refusal_reply("value", problem, message);
    }
    if (type != "subscribe") {
        return refusal_reply("type", "types are \"subscribe\" and \"samples\"", message);
    }
    problem = unknown_field(message, {"type", "id", "kinds", "squares"});
    problem = problem.empty() ? subscribe(message, choice) : problem;
    if (!problem.empty()) {
        return refusal_reply("value", problem, message);
    }
    nlohmann::ordered_json kinds = nlohmann::ordered_json::array();
    for (std::size_t kind = 0; kind < STREAM_KINDS; kind++) {
        if (choice.kinds[kind]) {
            kinds.push_back(STREAM_KIND_NAMES[kind]);
        }
    }
    return reply({{"schema", "opms.subscribed/1"}, {"kinds", kinds},
                  {"squares", choice.squares}}, message);
}

}  // namespace opms_host
