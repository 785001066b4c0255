/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a box tells, as JSON and as words for people. */
#ifndef OPMS_CLI_BOX_JSON_HPP
#define OPMS_CLI_BOX_JSON_HPP

#include <string>

#include <nlohmann/json.hpp>

#include <opms/hid.h>

using BoxJson = nlohmann::ordered_json;

BoxJson box_identity_json(const opms_identity_report_t &identity);
BoxJson box_status_json(const opms_status_report_t &status);
BoxJson box_settings_json(const opms_settings_t &settings);
BoxJson box_event_json(const opms_event_report_t &event);
BoxJson box_counters_json(const opms_box_counters_t &counters);

/** "0.2.0 (git 0123456789ab, modified)" */
std::string box_firmware_text(const opms_identity_report_t &identity);
/** One line, without its time: "START: run begins with pulse 7". */
std::string box_event_text(const opms_event_report_t &event);
const char *box_reset_text(opms_reset_cause_t cause);
/** "100 200 100 300 100 ms", or "off". */
std::string box_preamble_text(const opms_settings_t &settings);
/** Gaps of the preamble. */
size_t box_preamble_gaps(const opms_settings_t &settings);
double box_debounce_us(const opms_settings_t &settings);
/** printf() to a string. */
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
std::string box_text(const char *format, ...);

#endif
