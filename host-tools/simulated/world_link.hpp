/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The way between the simulated box and its host: USB with its delays, the cable, a host that
 * stalls, and the faults of reports. Items for a BoxPort come out. One thread at a time. */
#ifndef OPMS_SIMULATED_WORLD_LINK_HPP
#define OPMS_SIMULATED_WORLD_LINK_HPP

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "world_box.hpp"
#include "world_faults.hpp"
#include "world_tracker.hpp"

namespace opms_host {

class WorldLink {
public:
    WorldLink(Agenda &agenda, WorldBox &box, HostStall &stall, const WorldOptions &options);

    /** The host opens the box. Items and pings begin. */
    void open();
    /** Reports wait in the box. */
    void wanted();
    bool arm(std::uint32_t session_id, std::string &error);
    bool disarm(std::string &error);
    bool set_settings(const opms_settings_t &settings, std::string &error);
    bool is_connected() const { return is_plugged_ && box_.is_on(); }
    /** The identity as it was read when the box was connected last. */
    const opms_identity_report_t &identity() const { return identity_; }

    void unplug();
    void plug();

    std::deque<opms_box_item_t> &items() { return items_; }
    const FaultDice &faults() const { return dice_; }

private:
    bool check_connected(std::string &error) const;
    void poll_usb();
    void hand_over(ReportBytes bytes);
    void deliver_at(std::int64_t t_ns, const ReportBytes &bytes);
    void arrive(const ReportBytes &bytes);
    void take(const ReportBytes &bytes);
    void plan_ping();
    void send_ping();
    void fetch(const PulseGap &gap);
    void give_up(const PulseGap &gap);
    void say(opms_link_change_t change, std::uint32_t boot_id, const char *message);

    Agenda &agenda_;
    WorldBox &box_;
    HostStall &stall_;
    const std::int64_t ping_interval_ns_;
    WorldRandom usb_, ping_random_;
    FaultDice dice_, ping_dice_, history_dice_;
    WorldTracker tracker_;
    opms_identity_report_t identity_{};
    bool is_open_ = false, is_plugged_ = true, is_polling_ = false;
    std::uint64_t cable_ = 0; /**< changes with each plug and unplug */
    std::uint32_t ping_id_ = 0;
    struct Held {
        ReportBytes bytes;
        std::int64_t others_left;
    };
    std::vector<Held> held_; /**< reports that others overtake */
    std::deque<opms_box_item_t> items_;
};

}  // namespace opms_host
#endif
