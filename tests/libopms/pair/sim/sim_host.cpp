/* SPDX-License-Identifier: Apache-2.0 */
#include "sim_host.h"

#include <algorithm>
#include <array>
#include <functional>
#include <queue>

namespace {

using Bytes = std::array<uint8_t, OPMS_WIRE_SIZE>;

constexpr int64_t TICK = 100 * MS;
constexpr int64_t PINGS_EVERY = 200 * MS;
constexpr uint32_t HISTORY_AT_ONCE = 64;
constexpr int64_t BEFORE_ARMING = 3 * SECOND;

enum class Kind { CLOCK, PONG, REPORT, HISTORY };

/** Something that comes to the host; what came first is taken first. */
struct Event {
    int64_t at;
    uint64_t order;
    Kind kind;
    int64_t sent;
    Bytes bytes;
    bool operator>(const Event &other) const
    {
        return at != other.at ? at > other.at : order > other.order;
    }
};

class Host {
public:
    Host(Profile profile, Session &session, const BoxState &next_box, Subject &subject,
         std::vector<bool> &delivered, bool delays_learnt, Faults &faults, Random &random,
         Figures &figures)
        : profile_(profile), session_(session), next_box_(next_box), subject_(subject),
          delivered_(delivered), delays_learnt_(delays_learnt), faults_(faults), random_(random),
          figures_(figures)
    {
    }

    void run()
    {
        plan();
        bool open = false;
        size_t frame = 0, report = 0;
        while (true) {
            const int64_t frame_at = frame < session_.frames.size() ? session_.frames[frame].at
                                                                    : NEVER;
            const int64_t report_at =
                report < session_.reports.size() ? session_.reports[report].at : NEVER;
            const int64_t event_at = events_.empty() ? NEVER : events_.top().at;
            const int64_t now = std::min({frame_at, report_at, event_at});
            if (!open && now >= session_.armed_at) {
                open = true;
                subject_.open(session_.box.boot_id, session_.id, sim_settings(profile_));
            }
            if (now >= session_.closed_at) {
                break;
            }
            if (now == report_at) {
                read_report(session_.reports[report++]);
            } else if (now == frame_at) {
                read_frame(frame++);
            } else {
                const Event event = events_.top();
                events_.pop();
                handle(event);
            }
            collect();
        }
        // What comes later comes to nobody.
        session_.frames.resize(frame);
        subject_.close();
        collect();
    }

private:
    void hear(uint32_t triggers) { session_.heard = std::max<size_t>(session_.heard, triggers); }

    void post(Kind kind, int64_t at, const Bytes &bytes, int64_t sent = 0)
    {
        events_.push({at, order_++, kind, sent, bytes});
    }

    /** Pings, ticks, STATUS and events of the whole session. */
    void plan()
    {
        for (int64_t at = session_.armed_at - BEFORE_ARMING; at < session_.closed_at; at += TICK) {
            post(Kind::CLOCK, read_time(session_.stalls, at), {});
        }
        for (int64_t at = session_.armed_at - BEFORE_ARMING; at < session_.closed_at;
             at += PINGS_EVERY) {
            ping(read_time(session_.stalls, at));
        }
        for (int64_t at = session_.armed_at + SECOND / 2; at < session_.closed_at; at += SECOND) {
            status(at);
        }
        opms_event_report_t event{};
        event.kind = OPMS_EVENT_START;
        event.state = OPMS_BOX_RUNNING;
        event.boot_id = session_.box.boot_id;
        event.session_id = session_.id;
        event.time = session_.start_edge;
        event.argument = session_.first_run;
        send(event, session_.triggers[6].at);
        if (!session_.rebooted) {
            event.kind = OPMS_EVENT_STOP;
            event.state = OPMS_BOX_IDLE;
            event.time = box_time(session_.box.box_from_host(session_.ended_at));
            event.argument = session_.first_number + uint32_t(session_.triggers.size()) - 1;
            send(event, session_.ended_at);
            hear(uint32_t(session_.triggers.size())); // by STATUS at the latest
        }
    }

    void send(const opms_event_report_t &event, int64_t at)
    {
        Bytes bytes;
        opms_wire_write_event(&event, bytes.data());
        if (!random_.chance(0.01)) {
            post(Kind::REPORT, read_time(session_.stalls, at + 2 * MS), bytes);
        }
    }

    const BoxState *box_at(int64_t at) const
    {
        if (session_.rebooted && at >= session_.ended_at) {
            return at >= next_box_.started_at + SECOND ? &next_box_ : nullptr; // it starts up
        }
        return &session_.box;
    }

    /** A poll of USB is up to 1 ms away on either way. */
    void ping(int64_t sent)
    {
        int64_t received = sent + int64_t(random_.uniform(20e3, 1020e3));
        int64_t arrived = received + int64_t(random_.uniform(20e3, 1020e3));
        if (faults_.hits(PING_STALL, random_)) {
            const auto stall = int64_t(random_.uniform(20e6, 400e6));
            received += random_.chance(0.5) ? stall : 0;
            arrived += stall;
        }
        const BoxState *box = box_at(received);
        if (!box) {
            return;
        }
        opms_pong_report_t pong{};
        pong.boot_id = box->boot_id;
        pong.ping_id = uint32_t(order_);
        pong.received = box_time(box->box_from_host(received));
        pong.sent = box_time(box->box_from_host(received + 15000));
        Bytes bytes;
        opms_wire_write_pong(&pong, bytes.data());
        const int64_t read = read_time(session_.stalls, std::max(arrived, received + 20000));
        if (box == &session_.box && read - sent < 3 * MS) {
            session_.clock_known = std::min(session_.clock_known, read);
        }
        post(Kind::PONG, read, bytes, sent);
    }

    void status(int64_t at)
    {
        const BoxState *box = box_at(at);
        if (!box) {
            return;
        }
        opms_status_report_t report{};
        const bool same_boot = box == &session_.box;
        report.boot_id = box->boot_id;
        report.session_id = same_boot ? session_.id : 0;
        report.uptime_us = uint64_t(box->box_from_host(at) / 1000);
        report.state = same_boot && at < session_.ended_at ? OPMS_BOX_RUNNING : OPMS_BOX_IDLE;
        const auto next = std::upper_bound(
            session_.triggers.begin(), session_.triggers.end(), at,
            [](int64_t time, const TrueTrigger &trigger) { return time < trigger.at; });
        const auto count = uint32_t(next - session_.triggers.begin());
        report.trigger_number = same_boot && count > 0 ? session_.first_number + count - 1 : 0;
        Bytes bytes;
        opms_wire_write_status(&report, bytes.data());
        post(Kind::REPORT, read_time(session_.stalls, at + MS), bytes);
        if (read_time(session_.stalls, at + MS) < session_.closed_at) {
            hear(same_boot ? count : 0);
        }
    }

    void read_report(const ReportDelivery &delivery)
    {
        TrueTrigger &trigger = session_.triggers[size_t(delivery.trigger)];
        Bytes bytes;
        opms_wire_write_trigger(&trigger.report, bytes.data());
        if (delivery.damaged_bit >= 0) {
            bytes[size_t(delivery.damaged_bit / 8)] ^= uint8_t(1U << (delivery.damaged_bit % 8));
        } else {
            trigger.known = std::min(trigger.known, delivery.at);
            hear(uint32_t(delivery.trigger) + 1);
        }
        subject_.report(bytes.data(), delivery.at);
    }

    void read_frame(size_t index)
    {
        Delivery &delivery = session_.frames[index];
        const uint64_t serial = delivery.frame.serial;
        if (delivered_.size() <= serial) {
            delivered_.resize(serial + 4096);
        }
        delivery.copy = delivered_[serial];
        delivered_[serial] = true;
        opms_frame_t frame{};
        frame.frame_id = delivery.frame.raw_id;
        frame.camera_time_ticks = has_stamp(profile_) ? delivery.frame.ticks : 0;
        frame.arrival_host_ns = delivery.at;
        frame.tag = uint64_t(session_.id) << 32 | index;
        subject_.frame(frame);
        if (delays_learnt_) {
            watch_.see(session_, delivery, subject_.locked(), figures_);
        }
    }

    void handle(const Event &event)
    {
        if (event.kind == Kind::CLOCK) {
            subject_.advance(event.at);
            ask_history(event.at);
        } else if (event.kind == Kind::PONG) {
            subject_.pong(event.sent, event.bytes.data(), event.at);
        } else {
            if (event.kind == Kind::HISTORY) {
                note_history(event);
            }
            subject_.report(event.bytes.data(), event.at);
        }
    }

    void note_history(const Event &event)
    {
        opms_history_report_t history;
        if (opms_wire_read_history(event.bytes.data(), OPMS_WIRE_SIZE, &history) != OPMS_WIRE_OK) {
            std::abort();
        }
        for (uint32_t i = 0; i < history.count; ++i) {
            TrueTrigger &trigger =
                session_.triggers[history.entries[i].number - session_.first_number];
            trigger.known = std::min(trigger.known, event.at);
        }
    }

    void ask_history(int64_t now)
    {
        if (session_.rebooted && now >= session_.ended_at) {
            return; // gone with the boot
        }
        uint32_t asked = 0;
        for (const opms_pair_gap_t &gap : subject_.gaps()) {
            for (uint32_t i = 0; i < gap.count && asked < HISTORY_AT_ONCE; i += 2, asked += 2) {
                answer(gap.first_number + i, std::min<uint32_t>(2, gap.count - i),
                       now + 5 * MS + asked * MS / 2);
            }
        }
    }

    void answer(uint32_t number, uint32_t count, int64_t at)
    {
        opms_history_report_t report{};
        report.token = 1;
        report.boot_id = session_.box.boot_id;
        report.session_id = session_.id;
        for (uint32_t i = 0; i < count; ++i) {
            const size_t index = number + i - session_.first_number;
            const TrueTrigger &trigger = session_.triggers.at(index);
            opms_history_entry_t &entry = report.entries[report.count++];
            entry.number = number + i;
            entry.flags = trigger.report.flags &
                          (OPMS_TRIGGER_PREAMBLE | OPMS_TRIGGER_RUN);
            entry.time = trigger.report.time;
            if (has_strobe(profile_) && trigger.strobe_seen) {
                entry.flags |= OPMS_TRIGGER_STROBE;
                entry.strobe_delay_cycles = trigger.strobe_delay_cycles;
                entry.strobe_length_cycles = trigger.strobe_length_cycles;
            } else if (has_strobe(profile_) && at - trigger.at > PERIOD) {
                entry.flags |= OPMS_TRIGGER_STROBE_MISSING;
            }
        }
        if (faults_.hits(HISTORY_LOST, random_)) {
            return;
        }
        Bytes bytes;
        opms_wire_write_history(&report, bytes.data());
        post(Kind::HISTORY, read_time(session_.stalls, at), bytes);
    }

    void collect()
    {
        for (const opms_pair_result_t &result : subject_.take()) {
            judge_result(session_, result, figures_);
        }
    }

    Profile profile_;
    Session &session_;
    const BoxState &next_box_;
    Subject &subject_;
    std::vector<bool> &delivered_;
    bool delays_learnt_;
    Faults &faults_;
    Random &random_;
    Figures &figures_;
    LockWatch watch_;
    std::priority_queue<Event, std::vector<Event>, std::greater<Event>> events_;
    uint64_t order_ = 0;
};

} // namespace

void run_session(Profile profile, Session &session, const BoxState &next_box, Subject &subject,
                 std::vector<bool> &delivered, bool &delays_learnt, Faults &faults,
                 Random &random, Figures &figures)
{
    Host(profile, session, next_box, subject, delivered, delays_learnt, faults, random,
         figures)
        .run();
    judge_session(profile, session, delays_learnt, figures);
}
