/* SPDX-License-Identifier: Apache-2.0 */
#include "report_parts.hpp"

namespace {

std::string tile(const std::string &number, const char *unit, const std::string &what)
{
    return "<div class=\"tile\"><b>" + number + " " + unit + "</b><small>" + what +
           "</small></div>\n";
}

std::string tiles(const ReportJson &report)
{
    std::string body;
    if (report_has(report, "/expected")) {
        body += tile(html_traced(report, "/expected/parts/total/position_rms_mm", 2), "mm",
                     "expected error of the head\xe2\x80\x99s position, RMS over the working "
                     "volume");
        body += tile(html_traced(report, "/expected/parts/total/rotation_rms_deg", 3), "\xc2\xb0",
                     "expected error of its direction, RMS");
    }
    if (report_has(report, "/lens")) {
        body += tile("\xc2\xb1 " + html_traced(report, "/lens_sigma/fx_px", 3), "px",
                     "standard deviation of the focal length (" +
                         html_traced(report, "/lens/fx_px", 1) + " px)");
        body += tile(html_traced(report, "/residual_rms_px", 3), "px",
                     "residual of the nodes, RMS");
        body += tile(html_traced(report, "/pictures_used", 0), "pictures",
                     "used of " + html_traced(report, "/pictures_given", 0));
    }
    return body.empty() ? body : "<div class=\"tiles\">\n" + body + "</div>\n";
}

}  // namespace

std::string report_verdict(const ReportJson &report)
{
    std::string reasons;
    const ReportJson::json_pointer list("/verdict/reasons");
    const std::size_t count = report.contains(list) ? report.at(list).size() : 0;
    for (std::size_t i = 0; i < count; i++) {
        reasons +=
            "<li>" + html_words(report, "/verdict/reasons/" + std::to_string(i)) + "</li>\n";
    }
    const std::string next = html_words(report, "/next/advice");
    return "<div class=\"verdict " + html_words(report, "/verdict/level") + "\">\n<h2>" +
           html_words(report, "/verdict/headline") + "</h2>\n" +
           (reasons.empty() ? reasons : "<ul>\n" + reasons + "</ul>\n") +
           (next.empty() ? next : "<p><b>Next:</b> " + next + "</p>\n") + "</div>\n" +
           tiles(report);
}
