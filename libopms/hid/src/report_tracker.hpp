/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What input reports tell: decoded ones, malformed ones, and what their numbers say is missing.
 *
 * Pure: bytes in, items out; no device, no thread, no clock. One thread at a time. */
#ifndef OPMS_HID_REPORT_TRACKER_HPP
#define OPMS_HID_REPORT_TRACKER_HPP

#include <array>
#include <vector>

#include "box_transport.hpp"

namespace opms_hid {

/** Pulses whose reports are missing. */
struct Gap {
    uint32_t boot_id;
    uint32_t session_id;
    uint32_t first;
    uint32_t count;
};

/** Host times of the pings on their way. */
class PingTimes {
public:
    void sent(uint32_t ping_id, int64_t t_host_ns);
    /** @return 0 where the ping is not known, or was answered before. */
    int64_t take(uint32_t ping_id);

private:
    struct Ping {
        uint32_t id = 0;
        int64_t t_host_ns = 0;
    };
    std::array<Ping, 64> pings_;
    size_t next_ = 0;
};

class ReportTracker {
public:
    /** Items in order, and gaps to fill, of one input report. */
    struct Result {
        std::vector<opms_box_item_t> items;
        std::vector<Gap> gaps;
    };

    /** The box is connected. @return Whether its boot id is another one than before. */
    bool connected(uint32_t boot_id);
    /** This handle arms: pulses of that session count from 1. */
    void arming(uint32_t session_id) { armed_here_ = session_id; }
    void ping_sent(uint32_t ping_id, int64_t t_host_ns) { pings_.sent(ping_id, t_host_ns); }
    /** @param[out] result  Emptied first. */
    void take(const Input &input, Result &result);
    const opms_box_counters_t &counters() const { return counters_; }

private:
    void add_malformed(const Input &input, opms_wire_result_t what, Result &result);
    opms_wire_result_t add_report(const Input &input, Result &result);
    opms_wire_result_t add_trigger(const Input &input, Result &result);
    opms_wire_result_t add_pong(const Input &input, Result &result);
    opms_wire_result_t add_status(const Input &input, Result &result);
    opms_wire_result_t add_event(const Input &input, Result &result);
    template <typename T> void see(const T &report, int64_t t_host_ns, Result &result);
    void see_boot(uint32_t boot_id, int64_t t_host_ns, Result &result);
    void see_report_number(uint32_t number, int64_t t_host_ns, Result &result);
    void see_session(uint32_t session_id, uint32_t before_first);
    void see_trigger(const opms_trigger_report_t &trigger, int64_t t_host_ns, Result &result);
    void see_last_trigger(uint32_t session_id, uint32_t number, bool is_final, int64_t t_host_ns,
                          Result &result);
    void miss(uint32_t first, uint32_t count, int64_t t_host_ns, Result &result);

    opms_box_counters_t counters_ = {};
    PingTimes pings_;
    uint32_t boot_id_ = 0;
    bool has_report_number_ = false;
    uint32_t report_number_ = 0; /* of the last report */
    uint32_t armed_here_ = 0;
    uint32_t session_id_ = 0;     /* that the next two belong to; 0: none */
    uint32_t trigger_number_ = 0; /* of the last pulse known of */
    uint32_t announced_ = 0;      /* number of a pulse that the box had made earlier */
};

} // namespace opms_hid

#endif
