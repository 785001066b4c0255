/* SPDX-License-Identifier: Apache-2.0 */
#include "box_monitor_view.hpp"

namespace {

const char *clock_name(opms_clock_state_t state)
{
    switch (state) {
    case OPMS_CLOCK_COARSE: return "coarse";
    case OPMS_CLOCK_FITTED: return "fitted";
    case OPMS_CLOCK_UNKNOWN: break;
    }
    return "unknown";
}

const char *link_name(opms_link_change_t change)
{
    switch (change) {
    case OPMS_LINK_CONNECTED: return "connected";
    case OPMS_LINK_DISCONNECTED: return "disconnected";
    case OPMS_LINK_REBOOTED: return "rebooted";
    case OPMS_LINK_SILENT: return "silent";
    case OPMS_LINK_FAILED: break;
    }
    return "failed";
}

const char *lost_name(opms_lost_what_t what)
{
    switch (what) {
    case OPMS_LOST_REPORTS: return "reports";
    case OPMS_LOST_TRIGGERS: return "triggers";
    case OPMS_LOST_UNFILLED: return "triggers unfilled";
    case OPMS_LOST_ITEMS: break;
    }
    return "items";
}

BoxJson news_json(const opms_box_item_t &item)
{
    BoxJson row = {{"t_host_ns", item.t_host_ns}};
    if (item.kind == OPMS_ITEM_EVENT) {
        row["event"] = box_event_json(item.as.event);
    } else if (item.kind == OPMS_ITEM_LINK) {
        row["link"] = {{"change", link_name(item.as.link.change)},
                       {"boot_id", item.as.link.boot_id},
                       {"text", item.as.link.message}};
    } else if (item.kind == OPMS_ITEM_LOST) {
        row["lost"] = {{"what", lost_name(item.as.lost.what)},
                       {"session_id", item.as.lost.session_id},
                       {"first", item.as.lost.first},
                       {"count", item.as.lost.count}};
    } else {
        row["malformed"] = {{"result", opms_wire_result_name(item.as.malformed.result)},
                            {"id", item.as.malformed.id},
                            {"size", item.as.malformed.size}};
    }
    return row;
}

BoxJson clock_json(const opms_clock_fit_t &clock)
{
    return {{"state", clock_name(clock.state)},
            {"residual_us", static_cast<double>(clock.residual_ns) / 1e3},
            {"bound_us", static_cast<double>(clock.bound_ns) / 1e3},
            {"drift_ppm", clock.drift_ppm},
            {"accepted", clock.accepted},
            {"refused", clock.refused}};
}

std::string state_text(const BoxWatch &watch)
{
    if (!watch.connected()) {
        return "AWAY";
    }
    return watch.state() == OPMS_BOX_WAITING ? "WAITING (ready for START)"
                                             : opms_box_state_name(watch.state());
}

std::string clock_text(const opms_clock_fit_t &clock)
{
    if (clock.state == OPMS_CLOCK_UNKNOWN) {
        return "unknown";
    }
    return box_text("residual %.3f ms, drift %+.2f ppm, %llu round trips",
                    static_cast<double>(clock.residual_ns) / 1e6, clock.drift_ppm,
                    static_cast<unsigned long long>(clock.accepted));
}

std::string loss_text(const BoxWatch &watch, const opms_box_counters_t &counters)
{
    return box_text("%llu reports lost, %llu pulses missed, %llu filled, %llu lost for good, "
                    "%u dropped in the box",
                    static_cast<unsigned long long>(counters.reports_lost),
                    static_cast<unsigned long long>(counters.triggers_missed),
                    static_cast<unsigned long long>(counters.triggers_filled),
                    static_cast<unsigned long long>(counters.triggers_unfilled), watch.dropped());
}

std::string latency_text(double latency_ms)
{
    return latency_ms < 0 ? "-" : box_text("%.2f ms", latency_ms);
}

} // namespace

std::string monitor_json(const BoxWatch &watch, const MonitorRow &row)
{
    BoxJson json = {{"schema", "opms.box.monitor/1"},
                    {"elapsed_s", row.elapsed_s},
                    {"unique_id", row.unique_id},
                    {"connected", watch.connected()},
                    {"state", opms_box_state_name(watch.state())},
                    {"session_id", watch.session_id()},
                    {"uptime_us", watch.uptime_us()},
                    {"trigger_number", watch.trigger_number()},
                    {"first_run_number", watch.first_run_number()},
                    {"rate_hz", watch.rate_hz()},
                    {"jitter_ns", watch.jitter_ns()},
                    {"latency_ms", nullptr},
                    {"clock", clock_json(watch.clock())},
                    {"dropped", watch.dropped()},
                    {"counters", box_counters_json(row.counters)},
                    {"news", BoxJson::array()}};
    if (row.latency_ms >= 0) {
        json["latency_ms"] = row.latency_ms;
    }
    for (const opms_box_item_t &item : row.news) {
        json["news"].push_back(news_json(item));
    }
    return json.dump(-1, ' ', false, BoxJson::error_handler_t::replace);
}

std::string monitor_line(const BoxWatch &watch, const MonitorRow &row)
{
    return box_text("%7.1f s  ", row.elapsed_s) + state_text(watch) +
           box_text("  pulse %u  %.3f Hz  jitter %lld ns  latency ", watch.trigger_number(),
                    watch.rate_hz(), static_cast<long long>(watch.jitter_ns())) +
           latency_text(row.latency_ms) + "  clock " + clock_text(watch.clock()) + "  " +
           loss_text(watch, row.counters);
}

std::vector<std::string> monitor_screen(const BoxWatch &watch, const MonitorRow &row)
{
    std::vector<std::string> lines;
    lines.push_back(box_text("box %s  %.0f s", row.unique_id.c_str(), row.elapsed_s));
    lines.push_back("state    " + state_text(watch) +
                    box_text(", session %u, pulse %u", watch.session_id(),
                             watch.trigger_number()));
    lines.push_back(box_text("rate     %.4f Hz, jitter %lld ns, pulse to report ",
                             watch.rate_hz(), static_cast<long long>(watch.jitter_ns())) +
                    latency_text(row.latency_ms));
    lines.push_back("clock    " + clock_text(watch.clock()));
    lines.push_back("losses   " + loss_text(watch, row.counters));
    lines.emplace_back("last     ");
    for (const std::string &news : watch.last_news()) {
        lines.push_back("         " + news);
    }
    return lines;
}
