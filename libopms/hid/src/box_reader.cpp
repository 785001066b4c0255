/* SPDX-License-Identifier: Apache-2.0 */
/* The reader thread: open, read until the box is gone, say so, seek it again. */
#include <cstdio>

#include "box_core.hpp"

namespace opms_hid {

namespace {

constexpr int READ_TIMEOUT_MS = 200;
constexpr int REOPEN_TIMEOUT_MS = 1000;
constexpr std::chrono::milliseconds REOPEN_PAUSE(250);
constexpr int64_t SILENT_NS = 3'000'000'000;
constexpr int IDENTITY_TRIES = 3;

std::string hex_id(const uint8_t (&unique_id)[8])
{
    char text[OPMS_BOX_ID_SIZE];
    for (size_t i = 0; i < sizeof unique_id; ++i) {
        std::snprintf(text + 2 * i, 3, "%02x", unique_id[i]);
    }
    return text;
}

OpenResult other_protocol(unsigned version)
{
    const std::string ours = std::to_string(OPMS_WIRE_PROTOCOL);
    return {OPMS_ERR_VERSION, false,
            "the box speaks protocol version " + std::to_string(version) + ", this program " +
                ours + ": flash the box with firmware of this program's version, or use the "
                "program of the box's", {}};
}

} // namespace

OpenResult BoxCore::read_identity(opms_identity_report_t &identity)
{
    OpenResult result = {OPMS_ERR_TIMEOUT, false, "the box does not tell its identity", {}};
    for (int i = 0; i < IDENTITY_TRIES; ++i) {
        Report report;
        size_t size = 0;
        const Io io = transport_->get_feature(OPMS_REPORT_IDENTITY, report, size);
        if (io == Io::gone) {
            return {OPMS_ERR_DEVICE, true, "the box was unplugged while it was opened", {}};
        }
        if (io != Io::done) {
            continue;
        }
        const opms_wire_result_t what = opms_wire_read_identity(report.data(), size, &identity);
        if (what == OPMS_WIRE_OK) {
            return {OPMS_OK, false, {}, hex_id(identity.unique_id)};
        }
        if (what == OPMS_WIRE_VERSION) {
            return other_protocol(report[1]);
        }
        result = {OPMS_ERR_DEVICE, false,
                  std::string("the box's identity does not read: ") + opms_wire_result_name(what),
                  {}};
    }
    return result;
}

OpenResult BoxCore::open_once(const std::string &unique_id, int timeout_ms,
                              opms_identity_report_t &identity)
{
    OpenResult result = transport_->open(unique_id, timeout_ms);
    if (result.status != OPMS_OK) {
        return result;
    }
    const OpenResult known = read_identity(identity);
    if (known.status != OPMS_OK) {
        transport_->close();
        return known;
    }
    if (result.unique_id.empty()) {
        result.unique_id = known.unique_id;
    }
    return result;
}

void BoxCore::read_thread()
{
    std::string unique_id = options_.unique_id, last_message;
    int timeout_ms = static_cast<int>(options_.open_timeout_ms);
    for (bool is_first = true; is_first || pause(REOPEN_PAUSE); is_first = false) {
        opms_identity_report_t identity = {};
        const OpenResult result = open_once(unique_id, timeout_ms, identity);
        if (result.status == OPMS_OK) {
            unique_id = result.unique_id;
            last_message.clear();
            set_connected(identity);
        } else if (!result.absent && !is_first && result.message != last_message) {
            last_message = result.message;
            tell_link(OPMS_LINK_FAILED, 0, result.message);
        }
        if (is_first) {
            const std::lock_guard<std::mutex> guard(mutex_);
            outcome_ = result;
            opened_ = true;
            timeout_ms = REOPEN_TIMEOUT_MS;
            changed_.notify_all();
        }
        if (result.status == OPMS_OK) {
            read_until_gone();
            set_disconnected();
        } else if (is_first) {
            return;
        }
    }
}

void BoxCore::set_connected(const opms_identity_report_t &identity)
{
    bool rebooted = false;
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        identity_ = identity;
        rebooted = tracker_.connected(identity.boot_id);
        seen_.armed_session_id = rebooted ? 0 : seen_.armed_session_id;
        ++connection_;
        // Before it is told: who hears of it may ask the box at once.
        connected_ = true;
        changed_.notify_all();
    }
    tell_link(OPMS_LINK_CONNECTED, identity.boot_id,
              "box " + hex_id(identity.unique_id) + " is connected");
    if (rebooted) {
        tell_link(OPMS_LINK_REBOOTED, identity.boot_id, "the box has restarted while away");
    }
    const std::lock_guard<std::mutex> guard(mutex_);
    announced_ = true;
    changed_.notify_all();
}

void BoxCore::set_disconnected()
{
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        connected_ = announced_ = false;
        changed_.notify_all();
    }
    transport_->close();
    tell_link(OPMS_LINK_DISCONNECTED, 0, "the box was unplugged; seeking it");
}

void BoxCore::read_until_gone()
{
    Input input;
    int64_t last_ns = host_now_ns();
    bool silent = false;
    for (;;) {
        const Io io = transport_->read(input, READ_TIMEOUT_MS);
        if (io == Io::done) {
            last_ns = input.t_host_ns;
            silent = false;
            take(input);
        } else if (io != Io::none) {
            return;
        } else if (!silent && host_now_ns() - last_ns > SILENT_NS) {
            silent = true;
            tell_link(OPMS_LINK_SILENT, 0, "no report from the box for 3 s");
        }
        const std::lock_guard<std::mutex> guard(mutex_);
        if (stopping_) {
            return;
        }
    }
}

void BoxCore::take(const Input &input)
{
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        tracker_.take(input, taken_);
        for (const opms_box_item_t &item : taken_.items) {
            note(item);
        }
        changed_.notify_all();
    }
    deliver(taken_.items.data(), taken_.items.size());
    // Only now: what is fetched from HISTORY must come after the word that it was lost.
    if (options_.fill_gaps && !taken_.gaps.empty()) {
        const std::lock_guard<std::mutex> guard(mutex_);
        new_gaps_.insert(new_gaps_.end(), taken_.gaps.begin(), taken_.gaps.end());
        changed_.notify_all();
    }
}

/** Remember what callers may wait for. Call with the mutex held. */
void BoxCore::note(const opms_box_item_t &item)
{
    if (item.kind == OPMS_ITEM_STATUS) {
        ++seen_.statuses;
        seen_.state = item.as.status.state;
        seen_.session_id = item.as.status.session_id;
    } else if (item.kind == OPMS_ITEM_EVENT) {
        const opms_event_report_t &event = item.as.event;
        seen_.state = event.state;
        seen_.session_id = event.session_id;
        if (event.kind == OPMS_EVENT_ARMED) {
            seen_.armed_session_id = event.argument;
        } else if (event.kind == OPMS_EVENT_STOP) {
            ++seen_.stops;
        } else if (event.kind == OPMS_EVENT_REFUSED) {
            ++seen_.refusals;
            seen_.refused = event.argument;
            seen_.refusal = static_cast<opms_refusal_t>(event.detail);
        }
    }
}

void BoxCore::tell_link(opms_link_change_t change, uint32_t boot_id, const std::string &message)
{
    opms_box_item_t item = {};
    item.kind = OPMS_ITEM_LINK;
    item.t_host_ns = host_now_ns();
    item.as.link.change = change;
    item.as.link.boot_id = boot_id;
    std::snprintf(item.as.link.message, sizeof item.as.link.message, "%s", message.c_str());
    deliver(&item, 1);
}

/** @return Whether to go on. */
bool BoxCore::pause(std::chrono::milliseconds time)
{
    Lock lock(mutex_);
    return !changed_.wait_until(lock, Clock::now() + time, [this] { return stopping_; });
}

} // namespace opms_hid
