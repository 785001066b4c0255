/* SPDX-License-Identifier: Apache-2.0 */
#include "open_devices.hpp"

#include <charconv>
#include <filesystem>
#include <utility>

#include "aravis_source.hpp"
#include "box_place.hpp"
#include "hid_box.hpp"
#include "preview_source.hpp"
#include "replay_devices.hpp"
#include "v4l2_source.hpp"

namespace opms_host {
namespace {

const char *const SOURCE_FORMS =
    "aravis:[NAME], v4l2:/dev/videoN, replay:PATH, simulated[:KEY=VALUE,...], preview:N or none";

/* "kind:rest". */
struct Text {
    std::string kind, rest;
    bool has_rest = false;
};

Text split(const std::string &text)
{
    const std::size_t colon = text.find(':');
    Text result;
    result.kind = text.substr(0, colon);
    result.has_rest = colon != std::string::npos;
    result.rest = result.has_rest ? text.substr(colon + 1) : "";
    return result;
}

bool is_none(const std::string &text)
{
    return text.empty() || text == "none";
}

bool fail(OpenError &error, OpenFailure kind, std::string text)
{
    error.kind = kind;
    error.text = std::move(text);
    return false;
}

bool parse_number(const std::string &text, int &number)
{
    const char *const end = text.data() + text.size();
    const auto [next, why] = std::from_chars(text.data(), end, number);
    return why == std::errc() && next == end && number >= 0;
}

bool open_box(const OpenRequest &request, Devices &devices, OpenError &error)
{
    opms_box_options_t place;
    std::string why;
    if (!box_place_parse(request.box, place, why)) {
        return fail(error, OpenFailure::usage, why);
    }
    devices.box = open_hid_box(place, request.wait_for_missing, why);
    return devices.box || fail(error, OpenFailure::device, why);
}

bool open_source(const OpenRequest &request, Devices &devices, OpenError &error)
{
    const Text text = split(request.source);
    std::string why;
    if (text.kind == "aravis") {
        AravisPlace place;
        if (!aravis_place_parse(text.rest, place, why)) {
            return fail(error, OpenFailure::usage, why);
        }
        devices.source =
            open_aravis_source(place, request.wait_for_missing, devices.clock, why);
    } else if (text.kind == "v4l2") {
        V4l2Place place;
        if (!v4l2_place_parse(text.rest, place, why)) {
            return fail(error, OpenFailure::usage, why);
        }
        devices.source = open_v4l2_source(place, request.wait_for_missing, devices.clock, nullptr,
                                          why);
    } else {
        int number = 0;
        parse_number(text.rest, number);
        devices.source = open_preview_source(number, devices.clock, why);
    }
    return devices.source || fail(error, OpenFailure::device, why);
}

bool open_simulated(const OpenRequest &request, Devices &devices, OpenError &error)
{
    const Text box = split(request.box), source = split(request.source);
    SimulatedRequest wanted;
    if (box.kind == "simulated") {
        wanted.box_options = box.rest;
    } else if (devices.box) {
        std::string ignored;
        wanted.box_text = request.box;
        box_place_parse(request.box, wanted.box_place, ignored);
    }
    if (source.kind == "simulated") {
        wanted.source_options = source.rest;
    }
    if (!wanted.box_options && !wanted.source_options) {
        return true;
    }
    if (!request.simulated) {
        return fail(error, OpenFailure::usage, "this program has no simulated box or camera");
    }
    return request.simulated(wanted, devices, error);
}

bool is_real(const std::string &text)
{
    const std::string kind = split(text).kind;
    return !is_none(text) && kind != "simulated" && kind != "replay";
}

std::string replayed(const std::string &text)
{
    const Text parts = split(text);
    return parts.kind == "replay" ? parts.rest : "";
}

bool open_all(const OpenRequest &request, Devices &devices, OpenError &error)
{
    const std::string box_path = replayed(request.box), source_path = replayed(request.source);
    if (is_real(request.box) && !open_box(request, devices, error)) {
        return false;
    }
    if ((!box_path.empty() || !source_path.empty()) &&
        !open_replay(source_path, box_path, devices, error)) {
        return false;
    }
    if (!open_simulated(request, devices, error)) {
        return false;
    }
    if (!devices.clock) {
        devices.clock = std::make_shared<SystemClock>();
    }
    return !is_real(request.source) || open_source(request, devices, error);
}

}  // namespace

bool open_devices(const OpenRequest &request, Devices &devices, OpenError &error)
{
    devices = Devices();
    error = OpenError();
    const std::string box = box_text_problem(request.box);
    const std::string source = source_text_problem(request.source);
    if (!box.empty() || !source.empty()) {
        return fail(error, OpenFailure::usage, box.empty() ? source : box);
    }
    Devices opened;
    if (!open_all(request, opened, error)) {
        return false;
    }
    devices = std::move(opened);
    return true;
}

std::string box_text_problem(const std::string &text)
{
    const Text parts = split(text);
    opms_box_options_t place;
    std::string why;
    if (is_none(text) || parts.kind == "simulated" ||
        (parts.kind == "replay" && !parts.rest.empty()) || box_place_parse(text, place, why)) {
        return "";
    }
    return why + ", replay:PATH, simulated[:KEY=VALUE,...] or none";
}

std::string source_text_problem(const std::string &text)
{
    const Text parts = split(text);
    std::string why;
    AravisPlace aravis;
    V4l2Place v4l2;
    int number = 0;
    if (is_none(text) || parts.kind == "simulated" ||
        (parts.kind == "replay" && !parts.rest.empty())) {
        return "";
    }
    if (parts.kind == "aravis") {
        aravis_place_parse(parts.rest, aravis, why);
    } else if (parts.kind == "v4l2") {
        v4l2_place_parse(parts.rest, v4l2, why);
    } else if (parts.kind != "preview" || (parts.has_rest && !parse_number(parts.rest, number))) {
        why = text + " is no source of pictures; give " + SOURCE_FORMS;
    }
    return why;
}

std::vector<SourceEntry> list_sources(std::vector<std::string> &problems)
{
    std::vector<SourceEntry> entries;
    std::string problem;
    for (const AravisEntry &camera : list_aravis(problem)) {
        entries.push_back({"aravis:" + camera.id, camera.model,
                           camera.protocol + (camera.address.empty() ? "" : " at ") +
                               camera.address});
    }
    if (!problem.empty()) {
        problems.push_back(problem);
    }
    V4l2Calls calls;
    for (const V4l2Entry &camera : list_v4l2(calls)) {
        entries.push_back({"v4l2:" + camera.path, camera.card, camera.notes});
    }
    return entries;
}

}  // namespace opms_host
