/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What happens to the world once in a while during a run: by plan, and by chance. */
#ifndef OPMS_SIMULATED_WORLD_MISHAPS_HPP
#define OPMS_SIMULATED_WORLD_MISHAPS_HPP

#include "world_box.hpp"
#include "world_camera.hpp"
#include "world_faults.hpp"
#include "world_link.hpp"
#include "world_truth.hpp"

namespace opms_host {

/** What mishaps happen to. */
struct MishapTargets {
    Agenda &agenda;
    WorldBox &box;
    WorldLink &link;
    WorldCamera &camera;
    HostStall &stall;
    WorldTruth &truth;
};

class WorldMishaps {
public:
    WorldMishaps(const MishapTargets &targets, const WorldOptions &options)
        : to_(targets), options_(options), random_(options.seed, Chance::link)
    {
    }
    /** START's edge took effect. */
    void run_began();

private:
    bool is_of_run(std::uint64_t run) const;
    void plan_random(Mishap what, std::uint64_t run);
    double random_length_s(Mishap what);
    void happen(Mishap what, double length_s);

    MishapTargets to_;
    const WorldOptions options_;
    WorldRandom random_;
    std::uint64_t runs_ = 0;
    std::uint32_t boot_id_ = 0, session_id_ = 0;
};

}  // namespace opms_host
#endif
