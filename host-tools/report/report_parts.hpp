/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The parts of the page, in their order. Each returns HTML, empty where the document holds nothing
 * for it. */
#ifndef OPMS_REPORT_PARTS_HPP
#define OPMS_REPORT_PARTS_HPP

#include <string>

#include "report_html.hpp"

/** Style sheet of page and drawings. */
const char *report_style();

std::string report_verdict(const ReportJson &report);
std::string report_expected(const ReportJson &report);
std::string report_lens(const ReportJson &report);
std::string report_pictures(const ReportJson &report);
std::string report_residuals(const ReportJson &report);
std::string report_plane(const ReportJson &report); /**< coverage, distortion, cockle */
std::string report_distortion(const ReportJson &report); /**< one figure of the plane */
std::string report_places(const ReportJson &report);
std::string report_original(const ReportJson &report);
std::string report_origin(const ReportJson &report); /**< options and versions */

#endif
