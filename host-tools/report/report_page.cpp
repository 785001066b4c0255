/* SPDX-License-Identifier: Apache-2.0 */
#include "report_page.hpp"

#include "report_parts.hpp"

namespace {

std::string title_of(const ReportJson &report)
{
    const std::string name = html_words(report, "/options/name");
    return "Calibration of " + (name.empty() ? "a camera" : "camera " + name);
}

}  // namespace

std::string report_page(const ReportJson &report)
{
    const std::string title = title_of(report);
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
           title + "</title>\n<style>\n" + report_style() + "</style>\n</head>\n<body>\n<main>\n" +
           "<h1>" + title + "</h1>\n" + report_verdict(report) + report_expected(report) +
           report_residuals(report) + report_pictures(report) + report_plane(report) +
           report_places(report) + report_lens(report) + report_original(report) +
           report_origin(report) + "</main>\n</body>\n</html>\n";
}
