/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The simulated trigger box: states, pulses, memory and reports, as docs/wire.md promises them.
 *
 * It shares no code with the firmware; what it says is checked against the wire's definition by
 * opms_wire_write_...() and opms_wire_read_...(). One thread at a time. */
#ifndef OPMS_SIMULATED_WORLD_BOX_HPP
#define OPMS_SIMULATED_WORLD_BOX_HPP

#include <array>
#include <cstdint>
#include <deque>
#include <functional>

#include <opms/wire.h>

#include "world_agenda.hpp"
#include "world_box_clock.hpp"
#include "world_random.hpp"

namespace opms_host {

using ReportBytes = std::array<std::uint8_t, OPMS_WIRE_SIZE>;

/** A pulse on TRIG. */
struct BoxPulse {
    std::uint32_t number = 0;
    std::uint16_t flags = 0;
    std::int64_t cycles = 0, true_ns = 0;
    std::uint32_t strobe_delay_cycles = 0, strobe_length_cycles = 0;
};

class WorldBox {
public:
    struct Listener {
        std::function<void(const BoxPulse &)> on_pulse;
        std::function<void()> on_waiting;
        /** START's edge took effect. */
        std::function<void()> on_run;
        /** Reports wait to be read. */
        std::function<void()> on_report;
    };

    WorldBox(Agenda &agenda, std::uint64_t seed, double drift_ppm,
             const opms_settings_t &settings);
    void set_listener(Listener listener) { listener_ = std::move(listener); }

    // What people and the host do; all at the agenda's present.
    void power_on(opms_reset_cause_t cause);
    void power_off();
    opms_refusal_t arm(std::uint32_t session_id);
    void disarm();
    opms_refusal_t set_settings(const opms_settings_t &settings);
    void ping(std::uint32_t ping_id);
    /** START goes active for a while. */
    void start_edge(std::int64_t length_ns);
    /** The camera's exposure was active. */
    void strobe(std::int64_t from_true_ns, std::int64_t to_true_ns);

    // What the host reads.
    bool has_report() const;
    /** The next input report; there must be one. */
    ReportBytes next_report();
    opms_identity_report_t identity() const;
    opms_settings_report_t settings_report() const;
    opms_history_entry_t history(std::uint32_t session_id, std::uint32_t number) const;

    // The truth.
    opms_box_state_t state() const { return state_; }
    bool is_on() const { return is_on_; }
    std::uint32_t boot_id() const { return boot_id_; }
    std::uint32_t session_id() const { return session_id_; }
    std::uint32_t first_run_number() const { return first_run_number_; }
    std::int64_t start_edge_cycles() const { return start_edge_cycles_; }
    const BoxClock &clock() const { return clock_; }
    const opms_settings_t &settings() const { return settings_; }

private:
    void tell();
    void push_event(opms_event_kind_t kind, std::int64_t cycles, std::uint32_t argument,
                    std::uint32_t detail = 0);
    void refuse(std::uint8_t report_id, std::uint32_t opcode, opms_refusal_t refusal);
    void to_idle(opms_event_kind_t kind);
    void plan(std::int64_t cycles, std::function<void()> action);
    void plan_status();
    void enter_waiting();
    void preamble_pulse(std::uint32_t index);
    void begin_run(std::int64_t edge_cycles);
    void run_pulse(std::uint32_t index);
    void pulse(std::uint16_t flags, std::int64_t cycles);
    void check_strobes(std::uint32_t newest);
    const BoxPulse *find(std::uint32_t number) const;
    BoxPulse *find(std::uint32_t number);
    std::uint32_t gap_us(std::uint32_t number, std::uint32_t back) const;
    bool others_wait() const;
    ReportBytes write_trigger();
    ReportBytes write_other();
    ReportBytes write_status();

    Agenda &agenda_;
    Listener listener_;
    WorldRandom random_;
    BoxClock clock_;
    const std::uint64_t unique_id_;
    bool is_on_ = false;
    std::uint64_t era_ = 0;     /**< plans of an earlier one are void: arming, stop, power */
    std::uint64_t boots_ = 0;
    std::uint32_t boot_id_ = 0;
    opms_reset_cause_t reset_cause_ = OPMS_RESET_POWER;
    opms_box_state_t state_ = OPMS_BOX_IDLE;
    opms_settings_t settings_;
    bool settings_stored_ = false;
    opms_refusal_t last_set_ = OPMS_REFUSAL_NONE;
    std::uint32_t session_id_ = 0, first_run_number_ = 0;
    std::int64_t start_edge_cycles_ = 0;
    std::int64_t start_active_until_ns_ = 0;
    bool preamble_cut_ = false;
    std::deque<BoxPulse> memory_;   /**< of the session armed last, at most HISTORY's */
    std::uint32_t last_number_ = 0, reported_ = 0;
    std::uint32_t strobe_number_ = 0, strobe_checked_ = 0;
    bool strobe_missing_news_ = false;
    struct Pong {
        std::uint32_t id;
        std::int64_t received_cycles;
    };
    std::deque<Pong> pongs_;
    std::deque<opms_event_report_t> events_;
    bool status_due_ = false;
    std::uint32_t triggers_in_row_ = 0;
    std::uint32_t report_number_ = 0, event_number_ = 0;
    std::uint32_t glitches_ = 0, starts_refused_ = 0, strobes_missing_ = 0, dropped_ = 0;
    std::uint32_t commands_refused_ = 0;
};

}  // namespace opms_host
#endif
