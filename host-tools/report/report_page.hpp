/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A calibration as one page of HTML that needs no other file. */
#ifndef OPMS_REPORT_PAGE_HPP
#define OPMS_REPORT_PAGE_HPP

#include <string>

#include "report_html.hpp"

/** @param report  a document of schema opms.calibrate-report/1 (docs/calibrate.md). The same
 * document gives the same bytes. */
std::string report_page(const ReportJson &report);

#endif
