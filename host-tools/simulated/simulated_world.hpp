/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A trigger box and a camera that share one world, its clock and its truth: for people without
 * hardware, and for tests, which know what is right. docs/simulated.md.
 *
 * A program with threads opens the devices and uses them as it would real ones. A test may go
 * through the world by itself, with speed 0:
 *
 *     while (world->step(limit_ns)) { box->poll(0, item) ...; source->wait(0, item) ...; } */
#ifndef OPMS_SIMULATED_SIMULATED_WORLD_HPP
#define OPMS_SIMULATED_SIMULATED_WORLD_HPP

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "box_port.hpp"
#include "frame_source.hpp"
#include "host_clock.hpp"
#include "world_options.hpp"
#include "world_truth.hpp"

namespace opms_host {

class WorldCore;

/** Calls from any thread at any time. Lives as long as its devices do. */
class SimulatedWorld {
public:
    /** @return NULL with @p error. Renders its pictures before it returns, unless they are lazy. */
    static std::unique_ptr<SimulatedWorld> create(const WorldOptions &options,
                                                  std::string &error);
    ~SimulatedWorld();

    std::shared_ptr<HostClock> clock() const;
    /** One of each. */
    std::unique_ptr<BoxPort> make_box();
    std::unique_ptr<FrameSource> make_source();
    /** The camera that the pictures are taken with. */
    opms_camera_t camera() const;
    opms_camera_profile_t camera_profile() const;

    /** Speed 0, and nobody waits in poll() or wait(): go on to what happens next.
     * @return false, at @p limit_ns, where that would be later, or where all buffers are in use. */
    bool step(std::int64_t limit_ns);

    std::vector<TrueTrigger> true_triggers() const;
    std::vector<TrueFrame> true_frames() const;
    std::vector<TrueRun> true_runs() const;
    /** The frame that wait() gave as number @p arrival_index, from 0. It must have come. */
    TrueFrame true_frame(std::uint64_t arrival_index) const;
    TruePose true_pose(std::uint32_t picture) const;
    /** Middle of the exposure since START's edge. @return false where no run's trigger did it. */
    bool true_scan_time(const TrueFrame &frame, std::int64_t &t_scan_ns) const;

private:
    explicit SimulatedWorld(std::shared_ptr<WorldCore> core);
    std::shared_ptr<WorldCore> core_;
};

}  // namespace opms_host
#endif
