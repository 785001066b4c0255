/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a host makes of the simulated box's input reports: the items that opms/hid.h describes. */
#ifndef OPMS_SIMULATED_WORLD_TRACKER_HPP
#define OPMS_SIMULATED_WORLD_TRACKER_HPP

#include <cstdint>
#include <map>
#include <vector>

#include <opms/hid.h>

#include "world_box.hpp"

namespace opms_host {

struct PulseGap {
    std::uint32_t boot_id, session_id, first, count;
};

class WorldTracker {
public:
    /** @param[out] items, gaps  Added to. */
    void take(const ReportBytes &bytes, std::int64_t t_host_ns,
              std::vector<opms_box_item_t> &items, std::vector<PulseGap> &gaps);
    /** @return Whether it is another boot than before. */
    bool connected(std::uint32_t boot_id);
    void arming(std::uint32_t session_id) { armed_here_ = session_id; }
    void ping_sent(std::uint32_t ping_id, std::int64_t t_host_ns);

private:
    using Items = std::vector<opms_box_item_t>;
    using Gaps = std::vector<PulseGap>;

    void see(std::uint32_t boot_id, std::uint32_t report_number, std::int64_t t, Items &items);
    void see_session(std::uint32_t session_id, std::uint32_t before_first);
    void see_pulse(const opms_trigger_report_t &report, std::int64_t t, Items &items, Gaps &gaps);
    void see_last(std::uint32_t session_id, std::uint32_t number, bool by_status, std::int64_t t,
                  Items &items, Gaps &gaps);
    void miss(std::uint32_t first, std::uint32_t count, std::int64_t t, Items &items, Gaps &gaps);

    std::map<std::uint32_t, std::int64_t> pings_;
    std::uint32_t boot_id_ = 0, report_number_ = 0, armed_here_ = 0;
    bool has_report_number_ = false;
    std::uint32_t session_id_ = 0, trigger_number_ = 0, announced_ = 0;
};

opms_box_item_t box_item(opms_item_kind_t kind, std::int64_t t_host_ns);
opms_box_item_t link_item(std::int64_t t_host_ns, opms_link_change_t change,
                          std::uint32_t boot_id, const char *message);
opms_box_item_t lost_item(std::int64_t t_host_ns, opms_lost_what_t what,
                          std::uint32_t session_id, std::uint32_t first, std::uint32_t count);

}  // namespace opms_host
#endif
