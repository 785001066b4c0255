/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A drawing as inline SVG: y down, in units that the page shows as CSS pixels. */
#ifndef OPMS_REPORT_SVG_CANVAS_HPP
#define OPMS_REPORT_SVG_CANVAS_HPP

#include <string>
#include <vector>

struct SvgPoint {
    double x = 0, y = 0;
};

enum class SvgAnchor { start, middle, end };

/** Draws in the order of the calls. Everything it is given as text is escaped. */
class SvgCanvas {
public:
    /** @param label  what the drawing shows, for those who cannot see it. */
    SvgCanvas(double width, double height, const std::string &label);

    /** @param css  a class of report_style(); @param fill  a colour, or empty for the class's. */
    void rect(SvgPoint at, double width, double height, const char *css,
              const std::string &fill = std::string());
    void circle(SvgPoint at, double radius, const char *css);
    void line(SvgPoint from, SvgPoint to, const char *css);
    void polyline(const std::vector<SvgPoint> &points, const char *css, bool closed = false);
    /** Many separate lines as one element. */
    void segments(const std::vector<std::pair<SvgPoint, SvgPoint>> &lines, const char *css);
    void text(SvgPoint at, const std::string &words, SvgAnchor anchor = SvgAnchor::start,
              const char *css = "");

    /** The whole <svg> element. */
    std::string finish() const;

private:
    void open(const char *element, const char *css);

    double width_, height_;
    std::string label_, body_;
};

#endif
