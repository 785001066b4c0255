/* SPDX-License-Identifier: Apache-2.0 */
/* What is left between nodes and solution, as arrows. Noise points everywhere; where neighbours
 * point the same way, lens model or sheet do not fit, and the means over cells show it best. */
#include <algorithm>
#include <cmath>

#include "report_parts.hpp"
#include "svg_canvas.hpp"

namespace {

constexpr double WIDTH = 540, SMALL_WIDTH = 258, FOOT = 26;
constexpr int COLUMNS = 16, ROWS = 12;
constexpr int LEAST_NODES = 3; /* of a cell, for a mean */
constexpr double ARROW_RAW = 10, ARROW_MEAN = 34, SCALE_BAR = 60; /* wanted lengths */

struct Node {
    double px[2], residual[2];
    bool inlier;
};

using Nodes = std::vector<Node>;

Nodes nodes_of(const ReportJson &picture)
{
    Nodes nodes;
    if (!picture.contains("nodes")) {
        return nodes;
    }
    const ReportJson &all = picture.at("nodes");
    for (std::size_t i = 0; i < all.at("px").size(); i++) {
        const ReportJson &px = all.at("px")[i], &residual = all.at("residual_px")[i];
        nodes.push_back({{px[0].get<double>(), px[1].get<double>()},
                         {residual[0].get<double>(), residual[1].get<double>()},
                         all.at("inlier")[i].get<int>() != 0});
    }
    return nodes;
}

/** The largest of 1, 2 and 5 times a power of ten that is not above @p value. */
double round_down(double value)
{
    const double decade = std::pow(10.0, std::floor(std::log10(value)));
    const double part = value / decade;
    return decade * (part >= 5 ? 5 : part >= 2 ? 2 : 1);
}

/** A picture's frame, drawn smaller, in which residuals are drawn larger. */
struct Field {
    double zoom;          /* drawing units a pixel of the picture */
    double magnification; /* of the residuals beside the picture */
    double width, height;

    SvgPoint place(const double *px) const { return {zoom * (px[0] + 0.5), zoom * (px[1] + 0.5)}; }
    SvgPoint tip(const double *px, const double *residual) const
    {
        const SvgPoint from = place(px);
        return {from.x + zoom * magnification * residual[0],
                from.y + zoom * magnification * residual[1]};
    }
};

Field field_of(const ReportJson &report, double width, double typical_px, double arrow)
{
    Field field{};
    field.zoom = width / report_value(report, "/width_px");
    field.width = width;
    field.height = field.zoom * report_value(report, "/height_px");
    field.magnification = round_down(arrow / (field.zoom * std::max(1e-6, typical_px)));
    return field;
}

/** What a length of the drawing stands for. */
void draw_scale(SvgCanvas &canvas, const Field &field, double most)
{
    const double px = round_down(most / (field.zoom * field.magnification));
    const double length = px * field.zoom * field.magnification, y = field.height + 14;
    canvas.segments({{{1, y}, {1 + length, y}},
                     {{1, y - 4}, {1, y + 4}},
                     {{1 + length, y - 4}, {1 + length, y + 4}}},
                    "scale");
    char text[64];
    std::snprintf(text, sizeof text, "%g px, drawn %g times as large", px, field.magnification);
    canvas.text({length + 10, y + 4}, text);
}

void draw_nodes(SvgCanvas &canvas, const Field &field, const Nodes &nodes)
{
    std::vector<std::pair<SvgPoint, SvgPoint>> good, bad;
    for (const Node &node : nodes) {
        const SvgPoint at = field.place(node.px);
        if (node.inlier) {
            good.push_back({at, field.tip(node.px, node.residual)});
        } else {
            bad.push_back({{at.x - 3, at.y - 3}, {at.x + 3, at.y + 3}});
            bad.push_back({{at.x - 3, at.y + 3}, {at.x + 3, at.y - 3}});
        }
    }
    canvas.segments(good, "node");
    canvas.segments(bad, "outlier");
}

struct Mean {
    double px[2] = {0, 0}, residual[2] = {0, 0};
    int count = 0;
};

std::vector<Mean> means_of(const ReportJson &report, const Nodes &nodes)
{
    const double size[2] = {report_value(report, "/width_px"), report_value(report, "/height_px")};
    std::vector<Mean> cells(COLUMNS * ROWS);
    for (const Node &node : nodes) {
        const int column = static_cast<int>((node.px[0] + 0.5) / size[0] * COLUMNS);
        const int row = static_cast<int>((node.px[1] + 0.5) / size[1] * ROWS);
        if (!node.inlier || column < 0 || column >= COLUMNS || row < 0 || row >= ROWS) {
            continue;
        }
        Mean &cell = cells[static_cast<std::size_t>(row * COLUMNS + column)];
        cell.count++;
        for (int i = 0; i < 2; i++) {
            cell.px[i] += (node.px[i] - cell.px[i]) / cell.count;
            cell.residual[i] += (node.residual[i] - cell.residual[i]) / cell.count;
        }
    }
    cells.erase(std::remove_if(cells.begin(), cells.end(),
                               [](const Mean &cell) { return cell.count < LEAST_NODES; }),
                cells.end());
    return cells;
}

std::string all_nodes(const ReportJson &report, const Nodes &nodes)
{
    const Field field =
        field_of(report, WIDTH, report_value(report, "/residual_rms_px"), ARROW_RAW);
    SvgCanvas canvas(WIDTH, field.height + FOOT, "residuals of all nodes of all pictures");
    canvas.rect({0, 0}, field.width, field.height, "frame");
    draw_nodes(canvas, field, nodes);
    draw_scale(canvas, field, SCALE_BAR);
    return html_figure(canvas.finish(), "<b>Every node of every picture</b>, at its place in the "
                                        "picture; crosses are outliers.");
}

std::string all_means(const ReportJson &report, const Nodes &nodes)
{
    const std::vector<Mean> cells = means_of(report, nodes);
    double typical = 0;
    for (const Mean &cell : cells) {
        typical = std::max(typical, std::hypot(cell.residual[0], cell.residual[1]));
    }
    const Field field = field_of(report, WIDTH, typical, ARROW_MEAN);
    SvgCanvas canvas(WIDTH, field.height + FOOT, "mean residuals over cells of the picture");
    canvas.rect({0, 0}, field.width, field.height, "frame");
    for (const Mean &cell : cells) {
        canvas.circle(field.place(cell.px), 1.8, "dot");
        canvas.line(field.place(cell.px), field.tip(cell.px, cell.residual), "mean");
    }
    draw_scale(canvas, field, SCALE_BAR);
    return html_figure(canvas.finish(),
                       "<b>Means over cells.</b> Dots are their middles. Noise leaves arrows in "
                       "all directions; whole parts that point one way tell of a lens or a sheet "
                       "that is not quite as assumed.");
}

std::string one_picture(const ReportJson &report, std::size_t i, const Nodes &nodes)
{
    const Field field =
        field_of(report, SMALL_WIDTH, report_value(report, "/residual_rms_px"), ARROW_RAW);
    SvgCanvas canvas(SMALL_WIDTH, field.height + FOOT, "residuals of one picture");
    canvas.rect({0, 0}, field.width, field.height, "frame");
    draw_nodes(canvas, field, nodes);
    draw_scale(canvas, field, SCALE_BAR / 2);
    const std::string at = "/pictures/" + std::to_string(i);
    return html_figure(canvas.finish(), "<b>" + html_traced(report, at + "/number", 0) + "</b> " +
                                            html_words(report, at + "/image") + ": " +
                                            html_traced(report, at + "/residual_rms_px", 4) +
                                            " px RMS");
}

}  // namespace

std::string report_residuals(const ReportJson &report)
{
    Nodes all;
    std::string singles;
    const std::size_t count = report_has(report, "/pictures") ? report.at("pictures").size() : 0;
    for (std::size_t i = 0; i < count; i++) {
        const Nodes nodes = nodes_of(report.at("pictures")[i]);
        if (!nodes.empty()) {
            singles += one_picture(report, i, nodes);
            all.insert(all.end(), nodes.begin(), nodes.end());
        }
    }
    if (all.empty()) {
        return std::string();
    }
    return html_section("Residuals",
                        "<p>Measured less calculated place of the nodes: " +
                            html_traced(report, "/points_used", 0) + " nodes, RMS " +
                            html_traced(report, "/residual_rms_px", 4) + " px, mean " +
                            html_traced(report, "/residual_mean_px", 4) + " px, " +
                            html_traced(report, "/outliers", 0) + " outliers.</p>\n" +
                            "<div class=\"row\">\n" + all_nodes(report, all) +
                            all_means(report, all) + "</div>\n<h3>Picture by picture</h3>\n" +
                            "<div class=\"row small\">\n" + singles + "</div>\n");
}
