/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Text and numbers of the page. Every measured number is shown together with its place in the JSON
 * document (attribute data-json), so that a test, or a reader, can trace it. */
#ifndef OPMS_REPORT_HTML_HPP
#define OPMS_REPORT_HTML_HPP

#include <string>

#include <nlohmann/json.hpp>

using ReportJson = nlohmann::ordered_json;

/** For element content and attribute values; what is no UTF-8 or a control character becomes the
 * replacement character. */
std::string html_escaped(const std::string &text);

/** A number as printf's %.*f. */
std::string html_number(double value, int digits);

/** A number of the document, times @p factor; a dash where it is not there.
 * @param pointer  a JSON pointer, "/lens/fx_px" */
std::string html_traced(const ReportJson &report, const std::string &pointer, int digits,
                        double factor = 1);

/** A text of the document; empty where it is not there. */
std::string html_words(const ReportJson &report, const std::string &pointer);

/** The number at @p pointer, or NaN. */
double report_value(const ReportJson &report, const std::string &pointer);

/** Is there anything but null at @p pointer? */
bool report_has(const ReportJson &report, const std::string &pointer);

std::string html_section(const std::string &title, const std::string &body);
std::string html_figure(const std::string &svg, const std::string &caption);

#endif
