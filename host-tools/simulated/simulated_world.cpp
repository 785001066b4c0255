/* SPDX-License-Identifier: Apache-2.0 */
#include "simulated_world.hpp"

#include <stdexcept>

#include "simulated_box.hpp"
#include "simulated_source.hpp"
#include "world_core.hpp"
#include "world_frame.hpp"

namespace opms_host {

SimulatedWorld::SimulatedWorld(std::shared_ptr<WorldCore> core) : core_(std::move(core)) {}

SimulatedWorld::~SimulatedWorld() = default;

std::unique_ptr<SimulatedWorld> SimulatedWorld::create(const WorldOptions &options,
                                                       std::string &error)
{
    error = world_options_problem(options);
    if (!error.empty()) {
        return nullptr;
    }
    try {
        return std::unique_ptr<SimulatedWorld>(
            new SimulatedWorld(std::make_shared<WorldCore>(options)));
    } catch (const std::exception &problem) {
        error = problem.what();
        return nullptr;
    }
}

std::shared_ptr<HostClock> SimulatedWorld::clock() const
{
    return core_->clock();
}

std::unique_ptr<BoxPort> SimulatedWorld::make_box()
{
    return std::make_unique<SimulatedBox>(core_);
}

std::unique_ptr<FrameSource> SimulatedWorld::make_source()
{
    return std::make_unique<SimulatedSource>(core_);
}

opms_camera_t SimulatedWorld::camera() const
{
    const opms::simulate::Camera &from = core_->pictures().camera();
    opms_camera_t camera = {};
    camera.lens = {from.width, from.height, from.fx, from.fy, from.cx, from.cy,
                   from.k1,    from.k2,     from.p1, from.p2};
    camera.has_detector_camera = 1;
    for (int i = 0; i < 9; ++i) {
        camera.detector_camera.R[i] = from.detector_camera.R.val[i];
    }
    for (int i = 0; i < 3; ++i) {
        camera.detector_camera.t_m[i] = from.detector_camera.t[i];
    }
    return camera;
}

opms_camera_profile_t SimulatedWorld::camera_profile() const
{
    return world_camera_profile(core_->options());
}

bool SimulatedWorld::step(std::int64_t limit_ns)
{
    return core_->step(limit_ns);
}

std::vector<TrueTrigger> SimulatedWorld::true_triggers() const
{
    return core_->now([](WorldCore &world) { return world.truth().triggers(); });
}

std::vector<TrueFrame> SimulatedWorld::true_frames() const
{
    return core_->now([](WorldCore &world) { return world.truth().frames(); });
}

std::vector<TrueRun> SimulatedWorld::true_runs() const
{
    return core_->now([](WorldCore &world) { return world.truth().runs(); });
}

TrueFrame SimulatedWorld::true_frame(std::uint64_t arrival_index) const
{
    return core_->now(
        [&](WorldCore &world) { return world.truth().frames().at(arrival_index); });
}

TruePose SimulatedWorld::true_pose(std::uint32_t picture) const
{
    return core_->pose(picture);
}

bool SimulatedWorld::true_scan_time(const TrueFrame &frame, std::int64_t &t_scan_ns) const
{
    return core_->now([&](WorldCore &world) {
        const TrueRun *const run = world.truth().run(frame.boot_id, frame.session_id);
        if (!run || frame.trigger_number == 0) {
            return false;
        }
        t_scan_ns = frame.mid_box_ns - run->start_edge_box_ns;
        return true;
    });
}

}  // namespace opms_host
