/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A recorded scan at a glance, and how one ended, as JSON. */
#ifndef OPMS_CONSOLE_SCAN_SUMMARY_JSON_HPP
#define OPMS_CONSOLE_SCAN_SUMMARY_JSON_HPP

#include <nlohmann/json.hpp>

#include "scan_reader.hpp"
#include "scan_records.hpp"

namespace opms_host {

nlohmann::ordered_json scan_summary_json(const ScanSummary &scan);
nlohmann::ordered_json scan_end_json(const ScanEnd &end);
/** "2026-11-22T14:03:07.250Z" */
std::string utc_text(std::int64_t wall_ns);

}  // namespace opms_host
#endif
