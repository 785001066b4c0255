/* SPDX-License-Identifier: Apache-2.0 */
/* States and pulses of the simulated box. */
#include "world_box.hpp"

#include <cstring>

namespace opms_host {

namespace {

constexpr std::size_t EVENTS_MAX = 32, PONGS_MAX = 16;
constexpr std::int64_t CYCLES_PER_MS = 125000;

std::uint32_t preamble_gaps(const opms_settings_t &settings)
{
    std::uint32_t gaps = 0;
    while (gaps < OPMS_BOX_PREAMBLE_MAX && settings.preamble_gap_ms[gaps] != 0) {
        ++gaps;
    }
    return gaps;
}

}  // namespace

WorldBox::WorldBox(Agenda &agenda, std::uint64_t seed, double drift_ppm,
                   const opms_settings_t &settings)
    : agenda_(agenda), random_(seed, Chance::identity), unique_id_(random_.bits()),
      settings_(settings)
{
    clock_.drift = drift_ppm * 1e-6;
    power_on(OPMS_RESET_POWER);
}

void WorldBox::power_on(opms_reset_cause_t cause)
{
    ++era_;
    ++boots_;
    is_on_ = true;
    reset_cause_ = cause;
    clock_.boot_ns = agenda_.now_ns();
    boot_id_ = static_cast<std::uint32_t>(random_.bits()) | 1U;
    state_ = OPMS_BOX_IDLE;
    last_set_ = OPMS_REFUSAL_NONE;
    session_id_ = first_run_number_ = 0;
    start_edge_cycles_ = 0;
    start_active_until_ns_ = 0;
    memory_.clear();
    pongs_.clear();
    events_.clear();
    last_number_ = reported_ = strobe_number_ = strobe_checked_ = 0;
    strobe_missing_news_ = preamble_cut_ = false;
    report_number_ = event_number_ = triggers_in_row_ = 0;
    glitches_ = starts_refused_ = strobes_missing_ = dropped_ = commands_refused_ = 0;
    status_due_ = true;
    plan_status();
}

void WorldBox::power_off()
{
    ++era_;
    ++boots_;
    is_on_ = false;
    state_ = OPMS_BOX_IDLE;
}

/** STATUS goes on over sessions, so only a new boot ends it. */
void WorldBox::plan_status()
{
    const std::uint64_t boot = boots_;
    const std::int64_t next = clock_.cycles(agenda_.now_ns()) + 1000 * CYCLES_PER_MS;
    agenda_.at(clock_.true_ns(next), [this, boot] {
        if (boot == boots_) {
            status_due_ = true;
            tell();
            plan_status();
        }
    });
}

void WorldBox::tell()
{
    if (listener_.on_report) {
        listener_.on_report();
    }
}

/** Unless the box is stopped, armed or switched off before. */
void WorldBox::plan(std::int64_t cycles, std::function<void()> action)
{
    agenda_.at(clock_.true_ns(cycles), [this, era = era_, action = std::move(action)] {
        if (era == era_) {
            action();
        }
    });
}

void WorldBox::push_event(opms_event_kind_t kind, std::int64_t cycles, std::uint32_t argument,
                          std::uint32_t detail)
{
    ++event_number_;
    if (events_.size() < EVENTS_MAX) {
        events_.push_back({kind, state_, boot_id_, session_id_, 0, event_number_,
                           box_time_of(cycles), argument, detail});
    }
    tell();
}

void WorldBox::refuse(std::uint8_t report_id, std::uint32_t opcode, opms_refusal_t refusal)
{
    ++commands_refused_;
    push_event(OPMS_EVENT_REFUSED, clock_.cycles(agenda_.now_ns()), report_id + 256U * opcode,
               static_cast<std::uint32_t>(refusal));
}

opms_refusal_t WorldBox::arm(std::uint32_t session_id)
{
    const opms_refusal_t refusal = session_id == 0           ? OPMS_REFUSAL_VALUE
                                   : state_ != OPMS_BOX_IDLE ? OPMS_REFUSAL_STATE
                                                             : OPMS_REFUSAL_NONE;
    if (refusal != OPMS_REFUSAL_NONE) {
        refuse(OPMS_REPORT_COMMAND, OPMS_COMMAND_ARM, refusal);
        return refusal;
    }
    ++era_;
    dropped_ += last_number_ - reported_;
    memory_.clear();
    session_id_ = session_id;
    last_number_ = reported_ = first_run_number_ = strobe_number_ = strobe_checked_ = 0;
    strobe_missing_news_ = preamble_cut_ = false;
    start_edge_cycles_ = 0;
    state_ = OPMS_BOX_ARMED;
    const std::int64_t now = clock_.cycles(agenda_.now_ns());
    push_event(OPMS_EVENT_ARMED, now, session_id);
    if (preamble_gaps(settings_) == 0) {
        plan(now + CYCLES_PER_MS, [this] { enter_waiting(); });
    } else {
        plan(now + CYCLES_PER_MS, [this] {
            state_ = OPMS_BOX_PREAMBLE;
            preamble_pulse(0);
        });
    }
    return OPMS_REFUSAL_NONE;
}

void WorldBox::enter_waiting()
{
    const std::int64_t now = clock_.cycles(agenda_.now_ns());
    state_ = OPMS_BOX_WAITING;
    push_event(OPMS_EVENT_WAITING, now, last_number_);
    if (listener_.on_waiting) {
        listener_.on_waiting();
    }
    if (settings_.wait_timeout_s != 0) {
        plan(now + settings_.wait_timeout_s * 1000 * CYCLES_PER_MS, [this] {
            if (state_ == OPMS_BOX_WAITING) {
                to_idle(OPMS_EVENT_WAIT_TIMEOUT);
            }
        });
    }
}

/** While START is active no pulse of the preamble begins: a glitch holds it up. */
void WorldBox::preamble_pulse(std::uint32_t index)
{
    if (state_ != OPMS_BOX_PREAMBLE) {
        return;
    }
    if (agenda_.now_ns() < start_active_until_ns_) {
        plan(clock_.cycles(start_active_until_ns_) + 1, [this, index] { preamble_pulse(index); });
        return;
    }
    const std::int64_t now = clock_.cycles(agenda_.now_ns());
    pulse(OPMS_TRIGGER_PREAMBLE, now);
    if (index == preamble_gaps(settings_)) {
        enter_waiting();
        return;
    }
    plan(now + settings_.preamble_gap_ms[index] * CYCLES_PER_MS,
         [this, index] { preamble_pulse(index + 1); });
}

void WorldBox::start_edge(std::int64_t length_ns)
{
    if (!is_on_) {
        return;
    }
    const std::int64_t now_ns = agenda_.now_ns(), edge = clock_.cycles(now_ns);
    const std::int64_t length = length_ns / NS_PER_CYCLE, debounce = settings_.debounce_cycles;
    if (now_ns < start_active_until_ns_) {
        return;  // it is active already
    }
    start_active_until_ns_ = now_ns + length_ns;
    if (length < debounce) {
        // Only its end shows that it was a glitch, and a disarm in between changes nothing.
        agenda_.after(length_ns, [this, edge, length, boot = boots_] {
            if (boot == boots_) {
                ++glitches_;
                push_event(OPMS_EVENT_GLITCH, edge, static_cast<std::uint32_t>(length));
            }
        });
    } else if (state_ == OPMS_BOX_PREAMBLE || state_ == OPMS_BOX_WAITING) {
        plan(edge + debounce + OPMS_BOX_START_CYCLES, [this, edge] { begin_run(edge); });
    } else {
        ++starts_refused_;
        push_event(OPMS_EVENT_START_REFUSED, edge, static_cast<std::uint32_t>(state_));
    }
}

void WorldBox::begin_run(std::int64_t edge_cycles)
{
    if (state_ != OPMS_BOX_PREAMBLE && state_ != OPMS_BOX_WAITING) {
        return;  // it timed out meanwhile
    }
    ++era_;  // a preamble that goes on no more
    preamble_cut_ = state_ == OPMS_BOX_PREAMBLE;
    start_edge_cycles_ = edge_cycles;
    first_run_number_ = last_number_ + 1;
    if (preamble_cut_) {
        push_event(OPMS_EVENT_PREAMBLE_CUT, edge_cycles, last_number_);
    }
    state_ = OPMS_BOX_RUNNING;
    push_event(OPMS_EVENT_START, edge_cycles, first_run_number_);
    if (listener_.on_run) {
        listener_.on_run();
    }
    run_pulse(0);
}

void WorldBox::run_pulse(std::uint32_t index)
{
    const std::int64_t first =
        start_edge_cycles_ + settings_.debounce_cycles + OPMS_BOX_START_CYCLES;
    const std::int64_t period =
        static_cast<std::int64_t>(settings_.period_us) * OPMS_BOX_CYCLES_PER_US;
    pulse(static_cast<std::uint16_t>(OPMS_TRIGGER_RUN |
                                     (preamble_cut_ ? OPMS_TRIGGER_PREAMBLE_CUT : 0)),
          first + index * period);
    plan(first + (index + 1) * period, [this, index] { run_pulse(index + 1); });
}

void WorldBox::pulse(std::uint16_t flags, std::int64_t cycles)
{
    BoxPulse pulse;
    pulse.number = ++last_number_;
    pulse.flags = flags;
    pulse.cycles = cycles;
    pulse.true_ns = agenda_.now_ns();
    memory_.push_back(pulse);
    if (memory_.size() > OPMS_BOX_HISTORY_ENTRIES) {
        memory_.pop_front();
        if (reported_ + 1 < memory_.front().number) {
            dropped_ += memory_.front().number - reported_ - 1;
            reported_ = memory_.front().number - 1;
        }
    }
    check_strobes(pulse.number);
    if (listener_.on_pulse) {
        listener_.on_pulse(pulse);
    }
    tell();
}

void WorldBox::disarm()
{
    to_idle(OPMS_EVENT_STOP);
}

void WorldBox::to_idle(opms_event_kind_t kind)
{
    ++era_;
    state_ = OPMS_BOX_IDLE;
    push_event(kind, clock_.cycles(agenda_.now_ns()), last_number_);
}

opms_refusal_t WorldBox::set_settings(const opms_settings_t &settings)
{
    last_set_ = opms_wire_check_settings(&settings) ? OPMS_REFUSAL_VALUE
                : state_ != OPMS_BOX_IDLE           ? OPMS_REFUSAL_STATE
                                                    : OPMS_REFUSAL_NONE;
    if (last_set_ != OPMS_REFUSAL_NONE) {
        refuse(OPMS_REPORT_SETTINGS, 0, last_set_);
        return last_set_;
    }
    settings_ = settings;
    settings_stored_ = true;
    push_event(OPMS_EVENT_SETTINGS_STORED, clock_.cycles(agenda_.now_ns()),
               opms_wire_settings_crc(&settings_));
    return OPMS_REFUSAL_NONE;
}

void WorldBox::ping(std::uint32_t ping_id)
{
    if (is_on_ && pongs_.size() < PONGS_MAX) {
        pongs_.push_back({ping_id, clock_.cycles(agenda_.now_ns())});
        tell();
    }
}

opms_identity_report_t WorldBox::identity() const
{
    opms_identity_report_t identity = {};
    identity.hardware_version = 1;
    identity.firmware_version[1] = 2;
    identity.capabilities = OPMS_CAPABILITY_STROBE | OPMS_CAPABILITY_SYNC | OPMS_CAPABILITY_HISTORY;
    for (std::size_t i = 0; i < sizeof identity.unique_id; ++i) {
        identity.unique_id[i] = static_cast<std::uint8_t>(unique_id_ >> (8 * i));
    }
    std::memset(identity.git_hash, '0', sizeof identity.git_hash - 1);
    identity.boot_id = boot_id_;
    identity.clock_hz = OPMS_BOX_CLOCK_HZ;
    identity.start_cycles = OPMS_BOX_START_CYCLES;
    identity.ring_entries = OPMS_BOX_RING_ENTRIES;
    identity.history_entries = OPMS_BOX_HISTORY_ENTRIES;
    return identity;
}

opms_settings_report_t WorldBox::settings_report() const
{
    return {settings_, last_set_, false, settings_stored_, opms_wire_settings_crc(&settings_)};
}

}  // namespace opms_host
