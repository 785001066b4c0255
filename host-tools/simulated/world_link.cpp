/* SPDX-License-Identifier: Apache-2.0 */
#include "world_link.hpp"

#include <algorithm>

namespace opms_host {

namespace {

constexpr std::int64_t USB_FRAME_NS = NS_PER_MS;
constexpr std::uint32_t HISTORY_AT_ONCE = 32;
constexpr double LATE_MIN_MS = 1, LATE_MAX_MS = 5000, REPEATED_MAX_MS = 2000;

}  // namespace

WorldLink::WorldLink(Agenda &agenda, WorldBox &box, HostStall &stall, const WorldOptions &options)
    : agenda_(agenda), box_(box), stall_(stall),
      ping_interval_ns_(options.ping_interval_ms * NS_PER_MS), usb_(options.seed, Chance::usb),
      ping_random_(options.seed, Chance::ping),
      dice_(options.faults, options.seed, Chance::report_fault),
      ping_dice_(options.faults, options.seed, Chance::ping),
      history_dice_(options.faults, options.seed, Chance::history_fault)
{
}

void WorldLink::open()
{
    if (!is_open_) {
        is_open_ = true;
        plug();
        plan_ping();
    }
}

void WorldLink::say(opms_link_change_t change, std::uint32_t boot_id, const char *message)
{
    items_.push_back(link_item(agenda_.now_ns(), change, boot_id, message));
}

void WorldLink::plug()
{
    is_plugged_ = true;
    ++cable_;
    if (!is_open_ || !box_.is_on()) {
        return;
    }
    identity_ = box_.identity();
    const bool rebooted = tracker_.connected(identity_.boot_id);
    say(OPMS_LINK_CONNECTED, identity_.boot_id, "the simulated box is connected");
    if (rebooted) {
        say(OPMS_LINK_REBOOTED, identity_.boot_id, "the box has restarted while away");
    }
    wanted();
}

void WorldLink::unplug()
{
    if (!is_plugged_) {
        return;
    }
    is_plugged_ = false;
    ++cable_;
    held_.clear();
    if (is_open_) {
        say(OPMS_LINK_DISCONNECTED, 0, "the box was unplugged; seeking it");
    }
}

/** The host asks once in each frame of USB; what waits then goes. */
void WorldLink::wanted()
{
    if (is_open_ && is_connected() && !is_polling_) {
        is_polling_ = true;
        const auto phase = static_cast<std::int64_t>(usb_.unit() * USB_FRAME_NS);
        agenda_.after(phase, [this] {
            is_polling_ = false;
            poll_usb();
        });
    }
}

void WorldLink::poll_usb()
{
    if (!is_connected() || !box_.has_report()) {
        return;
    }
    hand_over(box_.next_report());
    if (box_.has_report()) {
        is_polling_ = true;
        agenda_.after(USB_FRAME_NS, [this] {
            is_polling_ = false;
            poll_usb();
        });
    }
}

/** On the bus: from here on anything may happen to a report. */
void WorldLink::hand_over(ReportBytes bytes)
{
    std::int64_t delay = usb_.ns_of_ms(0.03, 0.3);
    const bool is_pong = bytes[0] == OPMS_REPORT_PONG;
    if (is_pong && ping_dice_.hits(Fault::ping_held)) {
        delay += ping_dice_.random().ns_of_ms(20, 400);
    }
    if (dice_.hits(Fault::report_damaged)) {
        const std::int64_t bit = dice_.random().whole(0, 8 * OPMS_WIRE_SIZE - 1);
        bytes[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    }
    if (dice_.hits(Fault::report_repeated)) {
        const double later = dice_.random().uniform(1, REPEATED_MAX_MS);
        deliver_at(agenda_.now_ns() + delay + static_cast<std::int64_t>(later * 1e6), bytes);
    }
    if (dice_.hits(Fault::report_lost)) {
        return;
    }
    if (dice_.hits(Fault::report_late)) {
        delay += static_cast<std::int64_t>(
            dice_.random().log_uniform(LATE_MIN_MS, LATE_MAX_MS) * 1e6);
    } else if (dice_.hits(Fault::report_overtaken)) {
        held_.push_back({bytes, dice_.random().whole(1, 3)});
        return;
    }
    deliver_at(agenda_.now_ns() + delay, bytes);
}

void WorldLink::deliver_at(std::int64_t t_ns, const ReportBytes &bytes)
{
    agenda_.at(t_ns, [this, bytes] { arrive(bytes); });
}

void WorldLink::arrive(const ReportBytes &bytes)
{
    if (agenda_.now_ns() < stall_.until_ns()) {
        deliver_at(stall_.until_ns(), bytes);
        return;
    }
    take(bytes);
    for (Held &held : held_) {
        --held.others_left;
    }
    const auto is_due = [](const Held &held) { return held.others_left <= 0; };
    std::vector<Held> due;
    std::copy_if(held_.begin(), held_.end(), std::back_inserter(due), is_due);
    held_.erase(std::remove_if(held_.begin(), held_.end(), is_due), held_.end());
    for (const Held &held : due) {
        take(held.bytes);
    }
}

void WorldLink::take(const ReportBytes &bytes)
{
    std::vector<opms_box_item_t> items;
    std::vector<PulseGap> gaps;
    tracker_.take(bytes, agenda_.now_ns(), items, gaps);
    items_.insert(items_.end(), items.begin(), items.end());
    for (const PulseGap &gap : gaps) {
        agenda_.after(usb_.ns_of_ms(3, 12), [this, gap] { fetch(gap); });
    }
}

/** Some entries of HISTORY at once; the next ones after them. */
void WorldLink::fetch(const PulseGap &gap)
{
    if (!is_connected() || agenda_.now_ns() < stall_.until_ns()) {
        const std::int64_t again = std::max(stall_.until_ns(), agenda_.now_ns() + 250 * NS_PER_MS);
        agenda_.at(again, [this, gap] { fetch(gap); });
        return;
    }
    if (gap.boot_id != box_.boot_id()) {
        give_up(gap);
        return;
    }
    const std::uint32_t count = std::min(gap.count, HISTORY_AT_ONCE);
    if (history_dice_.hits(Fault::history_lost)) {
        give_up({gap.boot_id, gap.session_id, gap.first, count});
    } else {
        for (std::uint32_t number = gap.first; number < gap.first + count; ++number) {
            opms_box_item_t item = box_item(OPMS_ITEM_HISTORY, agenda_.now_ns());
            item.as.history = {gap.boot_id, gap.session_id,
                               box_.history(gap.session_id, number)};
            items_.push_back(item);
        }
    }
    if (count < gap.count) {
        const PulseGap rest = {gap.boot_id, gap.session_id, gap.first + count, gap.count - count};
        agenda_.after(2 * count * USB_FRAME_NS, [this, rest] { fetch(rest); });
    }
}

void WorldLink::give_up(const PulseGap &gap)
{
    items_.push_back(lost_item(agenda_.now_ns(), OPMS_LOST_UNFILLED, gap.session_id, gap.first,
                               gap.count));
}

void WorldLink::plan_ping()
{
    agenda_.after(ping_interval_ns_, [this] {
        send_ping();
        plan_ping();
    });
}

void WorldLink::send_ping()
{
    if (!is_connected() || agenda_.now_ns() < stall_.until_ns()) {
        return;
    }
    const std::uint32_t id = ++ping_id_;
    tracker_.ping_sent(id, agenda_.now_ns());
    std::int64_t delay = ping_random_.ns_of_ms(0.1, 1.1);
    if (ping_dice_.hits(Fault::ping_held)) {
        delay += ping_dice_.random().ns_of_ms(20, 400);
    }
    agenda_.after(delay, [this, id, cable = cable_] {
        if (cable == cable_) {
            box_.ping(id);
        }
    });
}

bool WorldLink::check_connected(std::string &error) const
{
    if (!is_connected()) {
        error = "the simulated box is unplugged";
    }
    return is_connected();
}

bool WorldLink::arm(std::uint32_t session_id, std::string &error)
{
    if (!check_connected(error)) {
        return false;
    }
    tracker_.arming(session_id);
    const opms_refusal_t refusal = box_.arm(session_id);
    if (refusal != OPMS_REFUSAL_NONE) {
        error = std::string("the box refuses to be armed: ") + opms_refusal_name(refusal);
    }
    return refusal == OPMS_REFUSAL_NONE;
}

bool WorldLink::disarm(std::string &error)
{
    if (!check_connected(error)) {
        return false;
    }
    box_.disarm();
    return true;
}

bool WorldLink::set_settings(const opms_settings_t &settings, std::string &error)
{
    if (!check_connected(error)) {
        return false;
    }
    if (const char *const wrong = opms_wire_check_settings(&settings)) {
        error = wrong;
        return false;
    }
    const opms_refusal_t refusal = box_.set_settings(settings);
    if (refusal != OPMS_REFUSAL_NONE) {
        error = std::string("the box refuses the settings: ") + opms_refusal_name(refusal);
    }
    return refusal == OPMS_REFUSAL_NONE;
}

}  // namespace opms_host
