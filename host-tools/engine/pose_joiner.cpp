/* SPDX-License-Identifier: Apache-2.0 */
#include "pose_joiner.hpp"

#include <utility>

#include "pose_times.hpp"

namespace opms_host {

PoseJoiner::Slot *PoseJoiner::at(std::uint64_t number)
{
    if (number < first_ || number - first_ >= slots_.size()) {
        return nullptr;
    }
    return &slots_[number - first_];
}

void PoseJoiner::expect(std::uint64_t number, double exposure_us)
{
    if (slots_.empty()) {
        first_ = number;
    }
    while (first_ + slots_.size() <= number) {
        slots_.emplace_back();
    }
    slots_.back().exposure_us = exposure_us;
}

bool PoseJoiner::located(std::unique_ptr<PoseRecord> pose)
{
    Slot *slot = at(pose->number);
    if (!slot || slot->pose) {
        return false;
    }
    slot->pose = std::move(pose);
    return true;
}

bool PoseJoiner::decided(const opms_pair_result_t &result)
{
    Slot *slot = at(result.frame.tag);
    if (!slot || slot->is_decided) {
        return false;
    }
    slot->pair = result;
    slot->is_decided = true;
    return true;
}

std::unique_ptr<PoseRecord> PoseJoiner::take(const opms_clock_t *box_clock)
{
    if (slots_.empty() || !slots_.front().pose || (with_pairs_ && !slots_.front().is_decided)) {
        return nullptr;
    }
    const Slot &slot = slots_.front();
    std::unique_ptr<PoseRecord> pose = std::move(slots_.front().pose);
    if (slot.is_decided) {
        set_pose_times(slot.pair, slot.exposure_us, box_clock, *pose);
    }
    slots_.pop_front();
    ++first_;
    return pose;
}

}  // namespace opms_host
