/* SPDX-License-Identifier: Apache-2.0 */
#include "simulated_factory.hpp"

#include <memory>

#include "simulated_world.hpp"

namespace opms_host {

namespace {

bool fail(OpenError &error, OpenFailure kind, const std::string &text)
{
    error = {kind, text};
    return false;
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
    WorldOptions options;
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
