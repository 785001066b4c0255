/* SPDX-License-Identifier: Apache-2.0 */
/* How far the lens moves each point from where a pinhole would have it. */
#include <algorithm>
#include <cmath>
#include <vector>

#include <opms/lens.h>

#include "report_camera.hpp"
#include "report_parts.hpp"
#include "svg_canvas.hpp"
#include "svg_colours.hpp"

namespace {

constexpr double WIDTH = 540;
constexpr int COLUMNS = 12, ROWS = 9;

struct Shift {
    double px[2];    /* in the picture */
    double ideal[2]; /* a pinhole's, with the same focal lengths and principal point */
    double length() const { return std::hypot(px[0] - ideal[0], px[1] - ideal[1]); }
};

std::vector<Shift> shifts_of(const opms_lens_t &lens)
{
    std::vector<Shift> shifts;
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        Shift shift{};
        double ray[2];
        shift.px[0] = lens.width_px * (i % COLUMNS + 0.5) / COLUMNS - 0.5;
        shift.px[1] = lens.height_px * (i / COLUMNS + 0.5) / ROWS - 0.5;
        if (opms_lens_unproject(&lens, shift.px, ray, nullptr, nullptr) == OPMS_OK) {
            shift.ideal[0] = lens.fx_px * ray[0] + lens.cx_px;
            shift.ideal[1] = lens.fy_px * ray[1] + lens.cy_px;
            shifts.push_back(shift);
        }
    }
    return shifts;
}

void draw_shifts(SvgCanvas &canvas, const std::vector<Shift> &shifts, double zoom, double height)
{
    double most = 1e-9;
    for (const Shift &shift : shifts) {
        most = std::max(most, shift.length());
    }
    const double w = WIDTH / COLUMNS, h = height / ROWS;
    const auto place = [&](const double *px) {
        return SvgPoint{zoom * (px[0] + 0.5), zoom * (px[1] + 0.5)};
    };
    std::vector<std::pair<SvgPoint, SvgPoint>> arrows;
    for (const Shift &shift : shifts) {
        const SvgPoint middle = place(shift.px);
        canvas.rect({middle.x - w / 2, middle.y - h / 2}, w, h, "cell",
                    svg_scale_colour(0.6 * shift.length() / most));
        arrows.push_back({place(shift.ideal), middle});
    }
    canvas.segments(arrows, "mean");
    for (const Shift &shift : shifts) {
        const SvgPoint middle = place(shift.px);
        canvas.circle(middle, 1.8, "dot");
        canvas.text({middle.x, middle.y + h / 2 - 4}, html_number(shift.length(), 1),
                    SvgAnchor::middle);
    }
}

}  // namespace

std::string report_distortion(const ReportJson &report)
{
    if (!report_has(report, "/lens")) {
        return std::string();
    }
    const opms_lens_t lens = report_camera_lens(report);
    const double zoom = WIDTH / lens.width_px, height = zoom * lens.height_px;
    SvgCanvas canvas(WIDTH, height, "distortion of the lens over the picture");
    canvas.rect({0, 0}, WIDTH, height, "frame");
    draw_shifts(canvas, shifts_of(lens), zoom, height);
    const SvgPoint centre{zoom * (lens.cx_px + 0.5), zoom * (lens.cy_px + 0.5)};
    canvas.segments({{{centre.x - 7, centre.y}, {centre.x + 7, centre.y}},
                     {{centre.x, centre.y - 7}, {centre.x, centre.y + 7}}},
                    "scale");
    return html_figure(
        canvas.finish(),
        "<b>Distortion of the lens.</b> Each line runs from where a lens without distortion would "
        "show a point to where this one does (dot), at true size; the figure is its length in px. "
        "The cross is the principal point, at u " +
            html_traced(report, "/lens/cx_px", 1) + ", v " +
            html_traced(report, "/lens/cy_px", 1) + " px.");
}
