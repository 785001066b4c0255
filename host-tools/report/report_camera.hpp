/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera that a document describes. */
#ifndef OPMS_REPORT_CAMERA_HPP
#define OPMS_REPORT_CAMERA_HPP

#include <opms/types.h>

#include "report_html.hpp"

inline opms_lens_t report_camera_lens(const ReportJson &report)
{
    const ReportJson &lens = report.at("lens");
    const auto value = [&](const char *key) { return lens.at(key).get<double>(); };
    return {report.at("width_px").get<int32_t>(),
            report.at("height_px").get<int32_t>(),
            value("fx_px"),
            value("fy_px"),
            value("cx_px"),
            value("cy_px"),
            value("k1"),
            value("k2"),
            value("p1"),
            value("p2")};
}

#endif
