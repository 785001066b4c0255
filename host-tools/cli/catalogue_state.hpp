/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Scans in a list: their state, whether they fit a search, and their rows. */
#ifndef OPMS_CLI_CATALOGUE_STATE_HPP
#define OPMS_CLI_CATALOGUE_STATE_HPP

#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "scan_reader.hpp"

/** "recording", "whole", "recovered" (cut off and mended since) or "cut off". */
const char *catalogue_state(const opms_host::ScanSummary &scan);

/** The name that a scan goes by now: its folder's, which a person may have changed. */
std::string catalogue_name(const std::string &folder);

/** What `opms catalogue search` looks for; what is not given fits all. */
struct CatalogueSearch {
    std::string name, text; /**< parts, whatever their case; `text` of events and settings */
    std::optional<std::int64_t> from_wall_ns, to_wall_ns; /**< of the beginning; `to` excluded */
};

/** Whether all but the text fits. */
bool catalogue_fits(const opms_host::ScanSummary &scan, const CatalogueSearch &search);
/** Whether an event, the settings, the box or the camera hold the text. False with @p error, too,
 * where the scan cannot be read. */
bool catalogue_has_text(opms_host::ScanReader &scan, const std::string &text, std::string &error);

/** "2026-11-22" or "2026-11-22T14:03:07" in UTC. @p length_ns  Of the day, or of the second. */
bool catalogue_parse_time(const std::string &text, std::int64_t &wall_ns, std::int64_t &length_ns);

/** opms.catalogue/1 */
nlohmann::ordered_json catalogue_row(const opms_host::ScanSummary &scan);
std::string catalogue_heading(std::size_t name_width);
std::string catalogue_line(const opms_host::ScanSummary &scan, std::size_t name_width);
/** All that the header and the end say. */
std::string catalogue_page(const opms_host::ScanSummary &scan);
/** The same, opms.catalogue.show/1. */
nlohmann::ordered_json catalogue_page_row(const opms_host::ScanSummary &scan);

#endif
