/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The pairer of a session: fed with the box's items as they come, and asked what changed. */
#ifndef OPMS_ENGINE_PAIRING_HPP
#define OPMS_ENGINE_PAIRING_HPP

#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "scan_records.hpp"
#include <opms/hid.h>

namespace opms_host {

/** One thread at a time. The clock of the box is learnt from the first pong on, whether or not a
 * session is open. */
class Pairing {
public:
    using TakeResult = std::function<void(const opms_pair_result_t &)>;
    using TakeEvent = std::function<void(EventRecord &)>;

    explicit Pairing(std::uint32_t max_wait_ms) : max_wait_ms_(max_wait_ms) {}

    /** A pairer for this camera: the present one where it is the same. With no session open. */
    bool fit(const opms_camera_profile_t &profile, std::string &error);
    bool open(std::uint32_t boot_id, std::uint32_t session_id, const opms_settings_t &settings,
              std::string &error);
    /** Decide all that waits. @return Whether the sums hold. */
    bool close(std::string &error);
    bool is_open() const { return is_open_; }

    void take(const opms_box_item_t &item);
    void take(const opms_frame_t &frame);
    void advance(std::int64_t now_host_ns);

    /** Hand over what was decided since. To be called after each of the above. */
    void poll(const TakeResult &take);
    /** What a person should know of since the last call: locks, doubts, missing pictures.
     * @param all  Also what is told once a second only: nothing follows. */
    void news(std::int64_t now_host_ns, bool all, const TakeEvent &tell);

    /** Counters are those of the session that is open, or was last. */
    opms_pair_summary_t summary() const;
    /** NULL before fit(). */
    const opms_clock_t *clock() const;
    /** Whether arrivals may be a witness in this boot of the box: a line goes through some round
     * trips, and they were short. */
    bool is_clock_known(std::uint32_t boot_id) const;
    /** The newest round trips, oldest first, of the box's present boot. */
    const std::deque<ClockRecord> &round_trips() const { return round_trips_; }
    /** @return Whether the item was a round trip; it is the last of round_trips() then. */
    bool note_round_trip(const opms_box_item_t &item, std::int64_t wall_ns);

private:
    struct Free {
        void operator()(opms_pairer_t *pairer) const { opms_pairer_destroy(pairer); }
    };
    void push_round_trip(const ClockRecord &record);

    const std::uint32_t max_wait_ms_;
    opms_camera_profile_t profile_{};
    std::unique_ptr<opms_pairer_t, Free> pairer_;
    bool is_open_ = false;
    opms_pair_counters_t at_open_{};
    opms_pair_state_t told_state_ = OPMS_PAIR_CLOSED;
    opms_pair_counters_t told_{};
    std::int64_t told_host_ns_ = 0;
    bool told_not_locked_ = false;
    std::deque<ClockRecord> round_trips_;
    std::uint32_t boot_id_ = 0; /**< of the round trips */
};

}  // namespace opms_host
#endif
