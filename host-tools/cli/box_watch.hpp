/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a box's items add up to: rate, jitter, losses, clock. No device, no output. */
#ifndef OPMS_CLI_BOX_WATCH_HPP
#define OPMS_CLI_BOX_WATCH_HPP

#include <deque>
#include <string>
#include <vector>

#include <opms/clock.h>
#include <opms/hid.h>

class BoxWatch {
public:
    explicit BoxWatch(uint32_t period_us);
    ~BoxWatch();
    BoxWatch(const BoxWatch &) = delete;
    BoxWatch &operator=(const BoxWatch &) = delete;

    void take(const opms_box_item_t &item);
    void set_period(uint32_t period_us) { period_us_ = period_us; }

    bool connected() const { return connected_; }
    opms_box_state_t state() const { return state_; }
    uint32_t session_id() const { return session_id_; }
    uint32_t trigger_number() const { return trigger_number_; }
    uint32_t first_run_number() const { return first_run_number_; }
    uint64_t uptime_us() const { return uptime_us_; }
    /** Pulses whose number and time the box lost since it was first seen. */
    uint32_t dropped() const;
    /** Of the run's last pulses, by the box's time; 0 where there are none. */
    double rate_hz() const;
    /** Largest distance of a period among them from the one that was set. */
    int64_t jitter_ns() const;
    opms_clock_fit_t clock() const;
    /** Is the conversion of a box time to host time known? */
    bool host_time(opms_box_time_t time, int64_t &host_ns) const;

    /** From a pulse to its report's arrival, the latest since the last call; negative: none. */
    double take_latency_ms();
    /** Events and changes of the link since the last call. */
    std::vector<opms_box_item_t> take_news();
    /** The last ones, oldest first, for people. */
    const std::deque<std::string> &last_news() const { return last_news_; }

private:
    struct Pulse {
        uint32_t number;
        int64_t time_ns;
    };

    void take_trigger(const opms_trigger_report_t &trigger, int64_t t_host_ns);
    void take_pong(const opms_pong_item_t &pong, int64_t t_host_ns);
    void take_status(const opms_status_report_t &status);
    void take_event(const opms_event_report_t &event);
    void take_link(const opms_link_item_t &link);
    void take_session(uint32_t session_id);
    void tell(const opms_box_item_t &item, const std::string &text);
    void forget_boot();

    uint32_t period_us_;
    opms_clock_t *clock_ = nullptr;
    bool connected_ = false;
    opms_box_state_t state_ = OPMS_BOX_IDLE;
    uint32_t session_id_ = 0, trigger_number_ = 0, first_run_number_ = 0;
    uint64_t uptime_us_ = 0;
    bool has_dropped_ = false;
    uint32_t dropped_first_ = 0, dropped_last_ = 0, dropped_before_ = 0;
    std::deque<Pulse> pulses_;
    double latency_ms_ = -1;
    std::vector<opms_box_item_t> news_;
    std::deque<std::string> last_news_;
};

#endif
