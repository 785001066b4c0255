/* SPDX-License-Identifier: Apache-2.0 */
#include "sim_world.h"

#include <algorithm>

namespace {

constexpr int PREAMBLE_PULSES = 6;
constexpr int64_t PREAMBLE_GAPS[] = {100 * MS, 200 * MS, 100 * MS, 300 * MS, 100 * MS};
constexpr double TICK_HZ = 125e6; // of the camera: GigE cameras count ticks of 8 ns
constexpr size_t PAST = 300;

/** Share of a fault that comes once in so many triggers. */
bool once_in(double triggers, Random &random)
{
    return random.chance(1 / triggers);
}

void make_triggers(Session &session, Random &random)
{
    int64_t at = session.armed_at + 50 * MS;
    for (int i = 0; i < PREAMBLE_PULSES; ++i) {
        session.triggers.push_back({});
        session.triggers.back().at = at;
        at += i < PREAMBLE_PULSES - 1 ? PREAMBLE_GAPS[i] : 0;
    }
    at += 150 * MS + int64_t(random.exponential(3e9)); // somebody gives START
    session.start_edge = box_time(session.box.box_from_host(at - 1000));
    session.first_run = session.first_number + PREAMBLE_PULSES;
    // Nine sessions of ten end by a reboot, so that there is one in 2,000 triggers.
    const int64_t count = random.whole(400, int64_t(1.8 * TRIGGERS_PER_BOX_REBOOT) - 400);
    for (int64_t i = 0; i < count; ++i) {
        session.triggers.push_back({});
        session.triggers.back().at = at;
        at += PERIOD;
    }
    session.ended_at = at;
    session.rebooted = random.chance(0.9);
    session.closed_at = session.ended_at + WAIT + 3 * SECOND;
}

void make_stalls(Session &session, Random &random)
{
    for (const TrueTrigger &trigger : session.triggers) {
        if (once_in(TRIGGERS_PER_HOST_STALL, random)) {
            const int64_t from = trigger.at + int64_t(random.uniform(0, 100e6));
            session.stalls.push_back({from, from + int64_t(random.uniform(0.5e9, 5e9))});
        }
    }
}

uint64_t wrapped_id(const CameraState &camera, int64_t id)
{
    if (camera.skips_0) {
        const int64_t period = (int64_t(1) << camera.bits) - 1;
        return uint64_t((id - 1) % period + 1);
    }
    return camera.bits == 64 ? uint64_t(id) : uint64_t(id) & ((uint64_t(1) << camera.bits) - 1);
}

class Camera {
public:
    Camera(Session &session, CameraState &state, Faults &faults, Random &random)
        : session_(session), state_(state), faults_(faults), random_(random)
    {
    }

    /** What the camera makes of one trigger: up to two frames. */
    void see(int trigger)
    {
        TrueTrigger &truth = session_.triggers[size_t(trigger)];
        if (once_in(TRIGGERS_PER_CAMERA_RESTART, random_)) {
            state_.down_until = truth.at + int64_t(random_.uniform(0.5e9, 4e9));
            ++state_.epoch;
            state_.started_at = state_.down_until - int64_t(random_.uniform(0.1e9, 2e9));
            state_.next_id = random_.whole(0, 1);
        }
        const bool ignored = faults_.hits(TRIGGER_IGNORED, random_);
        if (truth.at >= state_.down_until && !ignored) {
            truth.exposed = true;
            truth.strobe_seen = !faults_.hits(STROBE_UNSEEN, random_);
            truth.strobe_delay_cycles = uint32_t(random_.whole(1250, 1300)); // 10 us
            truth.strobe_length_cycles = 125 * 2000;
            expose(trigger, truth.at + 10000);
        }
        if (faults_.hits(FRAME_EXTRA, random_) && truth.at >= state_.down_until) {
            // Two exposures never overlap, and the sensor is read out after each.
            expose(-1, truth.at + int64_t(random_.uniform(15e6, 85e6)));
        }
    }

private:
    void expose(int trigger, int64_t at)
    {
        if (faults_.hits(ID_SKIP, random_)) {
            state_.next_id += random_.whole(1, 20);
        }
        if (faults_.hits(ID_RESET, random_)) {
            state_.next_id = random_.whole(0, 1);
        }
        if (state_.skips_0 && state_.next_id == 0) {
            state_.next_id = 1;
        }
        TrueFrame frame;
        frame.serial = state_.serial++;
        frame.trigger = trigger;
        frame.session = session_.id;
        frame.epoch = state_.epoch;
        frame.exposed_at = at;
        frame.id = state_.next_id++;
        frame.raw_id = wrapped_id(state_, frame.id);
        const double since = double(at - state_.started_at) * (1 + state_.drift);
        frame.ticks = uint64_t((since + random_.uniform(0, 40e3)) * TICK_HZ / 1e9);
        send(frame);
        state_.past.push_back(frame);
        if (state_.past.size() > PAST) {
            state_.past.erase(state_.past.begin());
        }
    }

    void deliver(const TrueFrame &frame, int64_t at)
    {
        Delivery delivery{};
        delivery.at = at;
        delivery.frame = frame;
        session_.frames.push_back(delivery);
    }

    void send(const TrueFrame &frame)
    {
        int64_t at = frame.exposed_at + FRAME_DELAY +
                     int64_t(std::min(random_.exponential(0.8e6), 6e6));
        const bool late = faults_.hits(FRAME_LATE, random_);
        if (late) {
            if (faults_.begins(FRAME_LATE)) {
                in_order_ = random_.chance(0.5);
            }
            at += int64_t(random_.log_uniform(20e6, 9e9));
        }
        if (in_order_) { // a queue: those behind wait, too
            at = std::max(at, last_arrival_ + 200000);
            in_order_ = late || at == last_arrival_ + 200000;
        }
        last_arrival_ = std::max(at, last_arrival_);
        if (!faults_.hits(FRAME_LOST, random_)) {
            deliver(frame, at);
            if (faults_.hits(FRAME_REPEATED, random_)) {
                deliver(frame, at + int64_t(random_.log_uniform(1e6, 2e9)));
            }
        }
        if (faults_.hits(FRAME_STALE, random_) && state_.past.size() > 3) {
            const auto last = int64_t(state_.past.size());
            deliver(state_.past[size_t(random_.whole(0, last - 3))],
                    at + int64_t(random_.uniform(-20e6, 60e6)));
        }
    }

    Session &session_;
    CameraState &state_;
    Faults &faults_;
    Random &random_;
    bool in_order_ = false;
    int64_t last_arrival_ = 0;
};

/** The report of trigger i as the box makes it 1 ms after the pulse. */
void fill_report(Session &session, size_t i, bool strobe)
{
    TrueTrigger &trigger = session.triggers[i];
    opms_trigger_report_t &report = trigger.report;
    const bool run = i >= PREAMBLE_PULSES;
    report = {};
    report.flags = run ? OPMS_TRIGGER_RUN : OPMS_TRIGGER_PREAMBLE;
    report.boot_id = session.box.boot_id;
    report.session_id = session.id;
    report.report_number = ++session.box.report_number;
    report.trigger_number = session.first_number + uint32_t(i);
    report.time = box_time(session.box.box_from_host(trigger.at));
    if (run) {
        report.start_edge = session.start_edge;
        report.first_run_number = session.first_run;
    }
    for (size_t k = i; strobe && k-- > 0 && k + 60 > i;) {
        const TrueTrigger &before = session.triggers[k];
        if (before.strobe_seen) {
            report.flags |= OPMS_TRIGGER_STROBE;
            report.strobe_for_trigger = session.first_number + uint32_t(k);
            report.strobe_delay_cycles = before.strobe_delay_cycles;
            report.strobe_length_cycles = before.strobe_length_cycles;
            break;
        }
    }
    for (size_t k = 0; k < 2 && k + 1 <= i; ++k) {
        const opms_box_time_t before = session.triggers[i - k - 1].report.time;
        const opms_box_time_t after = session.triggers[i - k].report.time;
        const uint64_t gap = after.us - before.us;
        report.gap_us[k] = gap <= 16700000 ? uint32_t(gap) : 0;
    }
}

void send_report(Session &session, size_t i, Faults &faults, Random &random)
{
    int64_t at = session.triggers[i].at + int64_t(random.uniform(0.1e6, 3e6));
    if (faults.hits(REPORT_LATE, random)) {
        at += int64_t(random.log_uniform(1e6, 5e9));
    }
    if (faults.hits(REPORT_REORDERED, random)) {
        at += random.whole(1, 3) * PERIOD + 5 * MS;
    }
    if (!faults.hits(REPORT_LOST, random)) {
        const int bit = faults.hits(REPORT_DAMAGED, random)
                            ? int(random.whole(0, OPMS_WIRE_SIZE * 8 - 1))
                            : -1;
        session.reports.push_back({at, int(i), bit});
    }
    if (faults.hits(REPORT_REPEATED, random)) {
        session.reports.push_back({at + int64_t(random.log_uniform(1e6, 2e9)), int(i), -1});
    }
}

/** What waits at the end of a stall is read in the order in which it came. */
template <typename Item> void hold_back(std::vector<Item> &items, const std::vector<Stall> &stalls)
{
    const auto by_time = [](const Item &a, const Item &b) { return a.at < b.at; };
    std::stable_sort(items.begin(), items.end(), by_time);
    int64_t last = 0;
    for (Item &item : items) {
        const int64_t read = read_time(stalls, item.at);
        item.at = read > item.at ? std::max(read, last + 2000) : read;
        last = item.at;
    }
    std::stable_sort(items.begin(), items.end(), by_time);
}

} // namespace

opms_settings_t sim_settings(Profile profile)
{
    opms_settings_t settings{};
    settings.period_us = 100000;
    settings.width_us = 1000;
    settings.debounce_cycles = 125;
    settings.strobe_enabled = has_strobe(profile);
    for (size_t i = 0; i < PREAMBLE_PULSES - 1; ++i) {
        settings.preamble_gap_ms[i] = uint16_t(PREAMBLE_GAPS[i] / MS);
    }
    return settings;
}

opms_box_time_t box_time(int64_t box_ns)
{
    return {uint64_t(box_ns / 1000), uint8_t(box_ns % 1000 / 8)};
}

int64_t read_time(const std::vector<Stall> &stalls, int64_t at)
{
    for (const Stall &stall : stalls) { // by their beginning; they may overlap
        at = at >= stall.from && at < stall.to ? stall.to : at;
    }
    return at;
}

Session make_session(Profile profile, uint32_t id, uint32_t first_number, int64_t armed_at,
                     BoxState &box, CameraState &camera, Faults &faults, Random &random)
{
    Session session{};
    session.id = id;
    session.first_number = first_number;
    session.armed_at = armed_at;
    session.box = box;
    make_triggers(session, random);
    make_stalls(session, random);
    Camera eye(session, camera, faults, random);
    for (size_t i = 0; i < session.triggers.size(); ++i) {
        eye.see(int(i));
    }
    for (size_t i = 0; i < session.triggers.size(); ++i) {
        fill_report(session, i, has_strobe(profile));
        send_report(session, i, faults, random);
    }
    if (session.rebooted) {
        box.boot_id = uint32_t(random.bits() | 1);
        box.started_at = session.ended_at + 300 * MS;
        box.drift = random.uniform(-50e-6, 50e-6);
        box.report_number = 0;
    } else {
        box.report_number = session.box.report_number;
    }
    hold_back(session.frames, session.stalls);
    hold_back(session.reports, session.stalls);
    return session;
}
