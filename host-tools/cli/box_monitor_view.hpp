/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How `opms box monitor` shows a box: a JSON row, a line, or a few lines drawn over again. */
#ifndef OPMS_CLI_BOX_MONITOR_VIEW_HPP
#define OPMS_CLI_BOX_MONITOR_VIEW_HPP

#include <string>
#include <vector>

#include "box_json.hpp"
#include "box_watch.hpp"

/** What a view shows, taken at one moment. */
struct MonitorRow {
    double elapsed_s;
    std::string unique_id;
    double latency_ms; /**< negative: none */
    opms_box_counters_t counters;
    std::vector<opms_box_item_t> news;
};

/** One object of schema opms.box.monitor/1. */
std::string monitor_json(const BoxWatch &watch, const MonitorRow &row);
/** One line a second, for a file or a pipe. */
std::string monitor_line(const BoxWatch &watch, const MonitorRow &row);
/** The lines of the live view. */
std::vector<std::string> monitor_screen(const BoxWatch &watch, const MonitorRow &row);

#endif
