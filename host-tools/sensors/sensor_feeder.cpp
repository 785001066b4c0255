/* SPDX-License-Identifier: Apache-2.0 */
#include "sensor_feeder.hpp"

namespace opms_host {

namespace {

/* Of one file at a time, so that each gets its turn. */
constexpr std::size_t SAMPLES_A_STEP = 10000;

}  // namespace

std::vector<std::string> SensorFeeder::step(const std::string &scan, const HostClock &clock,
                                            const SensorFeed::Take &take)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    if (scan != scan_) {
        scan_ = scan;
        feeds_.clear();
        told_.assign(files_.size(), "");
        for (const SensorFile &file : files_) {
            if (!scan.empty()) {
                feeds_.emplace_back(file.name, file.path, clock.wall_ns());
            }
        }
    }
    std::vector<std::string> troubles;
    for (std::size_t i = 0; i < feeds_.size(); i++) {
        feeds_[i].poll(clock, SAMPLES_A_STEP, take);
        if (feeds_[i].problem() != told_[i]) {
            told_[i] = feeds_[i].problem();
            troubles.push_back(told_[i]);
        }
    }
    return troubles;
}

}  // namespace opms_host
