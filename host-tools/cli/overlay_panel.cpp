/* SPDX-License-Identifier: Apache-2.0 */
/* The panel beside the picture. Its unit is 1/1000 of its height, so that it looks alike at any
 * size. */
#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <filesystem>

#include <opencv2/imgproc.hpp>

#include "locate_row.hpp"
#include "overlay_parts.hpp"

namespace {

__attribute__((format(printf, 1, 2))) std::string text(const char *format, ...)
{
    char buffer[128];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(buffer, sizeof buffer, format, arguments);
    va_end(arguments);
    return buffer;
}

/** Writes downwards: a name at the left, a value in the middle, a remark at the right. */
class Column {
public:
    Column(cv::Mat &panel, double y) : canvas_(panel, panel.rows / 1000.0), y_(y) {}

    const Canvas &canvas() const { return canvas_; }
    double y() const { return y_; }
    void skip(double height) { y_ += height; }
    void title(const std::string &s)
    {
        y_ += 34;
        canvas_.text({24, y_}, s, px(11), colour::dim);
        y_ += 4;
    }
    void row(const std::string &name, const std::string &value, const std::string &remark = "")
    {
        y_ += 25;
        canvas_.text({24, y_}, name, px(11.5), colour::text);
        canvas_.text({130, y_}, value, px(11.5), colour::text, 2);
        canvas_.text({268, y_}, remark, px(11.5), colour::dim);
    }
    double px(double units) const { return units * canvas_.scale(); }

private:
    Canvas canvas_;
    double y_;
};

cv::Scalar state_colour(const LocateResult &result)
{
    switch (result.location.state) {
    case OPMS_BAR_LOCATED:
        return {70, 140, 40};
    case OPMS_BAR_AMBIGUOUS:
        return {20, 130, 210};
    case OPMS_BAR_ABSENT:
        break;
    }
    return {60, 50, 170};
}

void draw_banner(cv::Mat &panel, const LocateResult &result)
{
    const int height = panel.rows * 78 / 1000;
    panel(cv::Rect(0, 0, panel.cols, height)).setTo(state_colour(result));
    const Canvas canvas(panel, panel.rows / 1000.0);
    std::string state = result.state_name();
    std::transform(state.begin(), state.end(), state.begin(),
                   [](char c) { return static_cast<char>(c - 'a' + 'A'); });
    canvas.text({24, 52}, state, 30 * canvas.scale(), {255, 255, 255},
                std::max(2, panel.rows / 350));
}

void write_pose(Column &column, const opms_location_t &location)
{
    const PoseFigures f = pose_figures(location);
    column.title(f.of_detector ? "DETECTOR IN GROUND" : "CAMERA IN THE BAR'S FRAME");
    column.row("X", text("%.2f mm", f.position_mm[0]));
    column.row("Y", text("%.2f mm", f.position_mm[1]), text("sigma %.3f mm", f.sigma_mm));
    column.row("Z", text("%.2f mm", f.position_mm[2]));
    column.skip(6);
    column.row("psi (Z)", text("%.3f deg", f.angles_deg[0]));
    column.row("phi (Y)", text("%.3f deg", f.angles_deg[1]), text("sigma %.4f deg", f.sigma_deg));
    column.row("theta (X)", text("%.3f deg", f.angles_deg[2]));
}

void write_evidence(Column &column, const LocateResult &result)
{
    column.title("EVIDENCE");
    const opms_pose_result_t &pose = result.location.pose;
    if (!result.squares.empty()) {
        column.row("squares", text("%zu", result.squares.size()),
                   text("%d to %d", static_cast<int>(result.squares.front().index),
                        static_cast<int>(result.squares.back().index)));
    } else {
        column.row("squares", "none");
    }
    if (result.located()) {
        column.row("edges", text("%zu", result.edges.size()),
                   text("%u agree", static_cast<unsigned>(pose.edges_used)));
        column.row("residual", text("%.3f px", pose.residual_px));
        column.row("edge shift", text("%+.3f px", pose.edge_shift_px));
    }
    column.row("time", text("%.3f ms", 1e-3 * result.time.total_us));
}

void legend_text(Column &column, double &y, const std::string &s)
{
    column.canvas().text({92, y + 4}, s, column.px(10.5), colour::text);
    y += 24;
}

void draw_legend(Column &column, bool head, double magnification)
{
    column.title("LEGEND");
    const Canvas &canvas = column.canvas();
    double y = column.y() + 20;
    canvas.polygon({{30, y - 7}, {70, y - 7}, {70, y + 7}, {30, y + 7}}, true, colour::square, 2);
    legend_text(column, y, "square of the bar, as fitted");
    const cv::Scalar colours[3] = {colour::good, colour::fair, colour::bad};
    const char *const names[3] = {"edge within 2 sigma", "edge within 4 sigma",
                                  "edge that disagrees"};
    for (int i = 0; i < 3; i++) {
        canvas.dot({50, y}, column.px(4), colours[i]);
        legend_text(column, y, names[i]);
    }
    const double whisker = 0.1 * RESIDUAL_MAGNIFIED * magnification / canvas.scale();
    canvas.line({50 - whisker / 2, y}, {50 + whisker / 2, y}, colour::good, 2);
    legend_text(column, y, text("residual of 0.1 px (drawn %.0f x)", RESIDUAL_MAGNIFIED));
    const cv::Scalar axes[3] = {colour::axis_x, colour::axis_y, colour::axis_z};
    for (int i = 0; i < 3; i++) {
        canvas.arrow({26.0 + 18 * i, y + 6}, {38.0 + 18 * i, y - 6}, axes[i], 2);
    }
    legend_text(column, y, "axes X, Y, Z, 50 mm long");
    if (head) {
        for (int i = 0; i < 3; i++) {
            canvas.line({30.0 + 15 * i, y}, {40.0 + 15 * i, y}, colour::head, 3);
        }
        legend_text(column, y, "head of 200 mm, from the camera file");
    }
    column.skip(y - column.y());
}

}  // namespace

void overlay_draw_panel(cv::Mat panel, const OverlayScene &scene, double magnification)
{
    const LocateResult &result = scene.result;
    draw_banner(panel, result);
    Column column(panel, 84);
    column.row(std::filesystem::path(result.image).filename().string().substr(0, 40), "");
    if (result.located()) {
        write_pose(column, result.location);
    }
    write_evidence(column, result);
    draw_legend(column, scene.camera.has_detector_camera != 0, magnification);
    if (result.located()) {
        const int top = static_cast<int>(column.px(column.y() + 8));
        overlay_draw_plan(panel, cv::Rect(0, top, panel.cols, panel.rows - top), scene);
    }
}
