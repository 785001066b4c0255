/* SPDX-License-Identifier: Apache-2.0 */
#include "simulated_factory.hpp"

#include <cstdlib>
#include <exception>
#include <memory>
#include <sstream>

#include "simulated_world.hpp"
#include "wired_source.hpp"

namespace opms_host {

namespace {

bool fail(OpenError &error, OpenFailure kind, const std::string &text)
{
    error = {kind, text};
    return false;
}

/** Takes "wires=PORT" out of a text. @return Empty, or what is wrong with it. */
std::string take_wires(std::string &text, std::uint16_t &port)
{
    std::string rest;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) {
        if (part.rfind("wires=", 0) != 0) {
            rest += (rest.empty() ? "" : ",") + part;
            continue;
        }
        char *end = nullptr;
        const unsigned long value = std::strtoul(part.c_str() + 6, &end, 10);
        if (*end != 0 || value == 0 || value > 65535) {
            return "simulated: " + part + " is no port";
        }
        port = static_cast<std::uint16_t>(value);
    }
    text = rest;
    return {};
}

bool wired_devices(const std::string &text, std::uint16_t port, Devices &devices, OpenError &error)
{
    WorldOptions options;
    std::string problem = simulated_options_parse(text, options);
    problem = problem.empty() ? world_options_problem(options) : problem;
    if (problem.empty() && options.speed != 1) {
        problem = "an emulated box runs in real time: speed must be 1";
    }
    if (!problem.empty()) {
        return fail(error, OpenFailure::usage, problem);
    }
    try {
        devices.source = std::make_unique<WiredSource>(options, port);
    } catch (const std::exception &wrong) {
        return fail(error, OpenFailure::input, std::string("simulated: ") + wrong.what());
    }
    if (!devices.clock) {
        devices.clock = std::make_shared<SystemClock>();
    }
    return true;
}

/** One world of both texts; the same key in both is the camera's word. */
bool read_options(const SimulatedRequest &request, WorldOptions &options, OpenError &error)
{
    for (const auto &text : {request.box_options, request.source_options}) {
        const std::string problem = text ? simulated_options_parse(*text, options) : "";
        if (!problem.empty()) {
            return fail(error, OpenFailure::usage, problem);
        }
    }
    const std::string problem = world_options_problem(options);
    return problem.empty() ? true : fail(error, OpenFailure::usage, "simulated: " + problem);
}

}  // namespace

bool simulated_devices(const SimulatedRequest &request, Devices &devices, OpenError &error)
{
    if (request.source_options && !request.box_options) {
        std::string text = *request.source_options;
        const bool is_emulated = request.box_place.transport == OPMS_BOX_EMULATED;
        std::uint16_t port = is_emulated
                                 ? static_cast<std::uint16_t>(request.box_place.emulated_port + 1)
                                 : std::uint16_t{0};
        const std::string problem = take_wires(text, port);
        if (!problem.empty()) {
            return fail(error, OpenFailure::usage, problem);
        }
        if (port != 0) {
            return wired_devices(text, port, devices, error);
        }
    }
    WorldOptions options;
    options.keep_truth = false;  // nobody could ask for it, and scans may be long
    if (!read_options(request, options, error)) {
        return false;
    }
    const bool is_alone = !request.box_options || !request.source_options;
    if (is_alone && (devices.box || devices.source) && options.speed != 1) {
        return fail(error, OpenFailure::usage,
                    "simulated: beside a real device time can only have speed=1");
    }
    std::string problem;
    const std::unique_ptr<SimulatedWorld> world = SimulatedWorld::create(options, problem);
    if (!world) {
        return fail(error, OpenFailure::input, "simulated: " + problem);
    }
    devices.clock = world->clock();
    if (request.box_options) {
        devices.box = world->make_box();
    }
    if (request.source_options) {
        devices.source = world->make_source();
    }
    return true;
}

}  // namespace opms_host
