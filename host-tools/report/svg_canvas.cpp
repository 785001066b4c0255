/* SPDX-License-Identifier: Apache-2.0 */
#include "svg_canvas.hpp"

#include <cmath>
#include <cstdio>

#include "report_html.hpp"

namespace {

/** A tenth of a pixel is as fine as anyone sees; 12.0 is written 12. */
std::string coordinate(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", std::isfinite(value) ? value : 0.0);
    std::string short_text = text;
    if (short_text.size() > 2 && short_text.compare(short_text.size() - 2, 2, ".0") == 0) {
        short_text.resize(short_text.size() - 2);
    }
    return short_text == "-0" ? "0" : short_text;
}

std::string attribute(const char *name, double value)
{
    return std::string(" ") + name + "=\"" + coordinate(value) + "\"";
}

std::string pair(SvgPoint point)
{
    return coordinate(point.x) + "," + coordinate(point.y);
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height, const std::string &label)
    : width_(width), height_(height), label_(label)
{
}

void SvgCanvas::open(const char *element, const char *css)
{
    body_ += std::string("<") + element;
    if (*css != '\0') {
        body_ += std::string(" class=\"") + css + "\"";
    }
}

void SvgCanvas::rect(SvgPoint at, double width, double height, const char *css,
                     const std::string &fill)
{
    open("rect", css);
    body_ += attribute("x", at.x) + attribute("y", at.y) + attribute("width", width) +
             attribute("height", height);
    body_ += fill.empty() ? "/>\n" : " style=\"fill:" + html_escaped(fill) + "\"/>\n";
}

void SvgCanvas::circle(SvgPoint at, double radius, const char *css)
{
    open("circle", css);
    body_ += attribute("cx", at.x) + attribute("cy", at.y) + attribute("r", radius) + "/>\n";
}

void SvgCanvas::line(SvgPoint from, SvgPoint to, const char *css)
{
    open("line", css);
    body_ += attribute("x1", from.x) + attribute("y1", from.y) + attribute("x2", to.x) +
             attribute("y2", to.y) + "/>\n";
}

void SvgCanvas::polyline(const std::vector<SvgPoint> &points, const char *css, bool closed)
{
    open(closed ? "polygon" : "polyline", css);
    body_ += " points=\"";
    for (const SvgPoint &point : points) {
        body_ += pair(point) + " ";
    }
    body_ += "\"/>\n";
}

void SvgCanvas::segments(const std::vector<std::pair<SvgPoint, SvgPoint>> &lines, const char *css)
{
    if (lines.empty()) {
        return;
    }
    open("path", css);
    body_ += " d=\"";
    for (const auto &[from, to] : lines) {
        body_ += "M" + pair(from) + "L" + pair(to);
    }
    body_ += "\"/>\n";
}

void SvgCanvas::text(SvgPoint at, const std::string &words, SvgAnchor anchor, const char *css)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    open("text", css);
    body_ += attribute("x", at.x) + attribute("y", at.y) + " text-anchor=\"" +
             anchors[static_cast<int>(anchor)] + "\">" + html_escaped(words) + "</text>\n";
}

std::string SvgCanvas::finish() const
{
    const std::string size = coordinate(width_) + " " + coordinate(height_);
    return "<svg viewBox=\"0 0 " + size + "\" width=\"" + coordinate(width_) + "\" height=\"" +
           coordinate(height_) + "\" role=\"img\" aria-label=\"" + html_escaped(label_) +
           "\">\n" + body_ + "</svg>\n";
}
