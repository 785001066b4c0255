/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Colours that people who do not see red or green tell apart, and that a grey print keeps. */
#ifndef OPMS_REPORT_SVG_COLOURS_HPP
#define OPMS_REPORT_SVG_COLOURS_HPP

#include <string>

/** From pale yellow (0) to dark blue (1): lightness falls all the way. */
std::string svg_scale_colour(double part);

/** Is text on this colour better white? */
bool svg_scale_is_dark(double part);

#endif
