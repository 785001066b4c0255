/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Puts together what comes at different times of one picture, its pose and its pair, and gives the
 * poses out in the order of the pictures. */
#ifndef OPMS_ENGINE_POSE_JOINER_HPP
#define OPMS_ENGINE_POSE_JOINER_HPP

#include <cstdint>
#include <deque>
#include <memory>

#include "scan_records.hpp"

namespace opms_host {

/** Holds pictures from their arrival until both are there: as long as the pairer's longest wait.
 * One thread at a time. */
class PoseJoiner {
public:
    /** @param with_pairs  false: without a box a picture is complete once it is located. */
    explicit PoseJoiner(bool with_pairs) : with_pairs_(with_pairs) {}

    /** A picture came. Numbers count up by one.
     * @param exposure_us  As the frame reports it; NaN: it does not. */
    void expect(std::uint64_t number, double exposure_us);
    /** It was located. @return false: not expected, or located before. */
    bool located(std::unique_ptr<PoseRecord> pose);
    /** Its pair is decided. @return false: not expected, or decided before. */
    bool decided(const opms_pair_result_t &result);
    /** The next picture's pose, if it is complete; else NULL.
     * @param box_clock  The pairer's, for times on the host's clock; may be NULL. */
    std::unique_ptr<PoseRecord> take(const opms_clock_t *box_clock);

    /** Pictures that are not taken out yet. */
    std::size_t waiting() const { return slots_.size(); }

private:
    struct Slot {
        std::unique_ptr<PoseRecord> pose;
        opms_pair_result_t pair{};
        double exposure_us = NOT_KNOWN;
        bool is_decided = false;
    };
    Slot *at(std::uint64_t number);

    const bool with_pairs_;
    std::uint64_t first_ = 1; /**< number of the first slot */
    std::deque<Slot> slots_;
};

}  // namespace opms_host
#endif
