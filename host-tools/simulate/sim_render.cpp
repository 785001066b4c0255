/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures are made tile by tile; only tiles that the pattern or a prop touches are computed on
 * fine cells, the others are ground alone. */
#include <algorithm>
#include <cmath>

#include "sim_blur.hpp"
#include "sim_outline.hpp"
#include "sim_random.hpp"
#include "sim_raster.hpp"
#include "sim_scenery.hpp"
#include "simulate/simulate.hpp"

namespace opms::simulate
{
namespace
{

constexpr int TILE_PX = 32;
constexpr double PIECE_MM = 60; /* a sheet is cut into pieces, so that few tiles touch each */
constexpr int STEPS_MIN = 16, STEPS_MAX = 128;
constexpr double MM = 1e-3;

struct DrawnProp {
    Outline outline;
    double level;
};

/** What the camera sees at one instant. */
struct Instant {
    std::vector<Outline> sheet, black;
    std::vector<DrawnProp> props;
    cv::Mat light, glow;
};

std::vector<Rect> pieces(const Rect &sheet)
{
    const int across = static_cast<int>(std::ceil((sheet.x1 - sheet.x0) / PIECE_MM));
    const int along = static_cast<int>(std::ceil((sheet.y1 - sheet.y0) / PIECE_MM));
    const auto x = [&](int i) { return sheet.x0 + (sheet.x1 - sheet.x0) * i / across; };
    const auto y = [&](int j) { return sheet.y0 + (sheet.y1 - sheet.y0) * j / along; };
    std::vector<Rect> all;
    for (int i = 0; i < across; ++i) {
        for (int j = 0; j < along; ++j) {
            all.push_back({x(i), y(j), x(i + 1), y(j + 1)});
        }
    }
    return all;
}

/** All that stays the same while a scene is rendered. */
class Painter
{
  public:
    explicit Painter(const Scene &scene)
        : scene_(scene), projector_(scene.camera), scenery_(scene), blur_(scene.look.blur_px),
          side_((TILE_PX + 2 * blur_.reach_px()) * blur_.per_px()), raster_(side_, blur_.per_px()),
          sheet_(pieces(scene.pattern.sheet)), grass_(make_grass(scene)), head_(make_head(scene))
    {
    }

    cv::Mat paint(const Pose &ground_camera)
    {
        const Instant now = look(ground_camera);
        cv::Mat picture = blur_.apply(now.glow);
        for (int y = 0; y < picture.rows; y += TILE_PX) {
            for (int x = 0; x < picture.cols; x += TILE_PX) {
                paint_tile(now, x, y, picture);
            }
        }
        return picture;
    }

  private:
    using Touched = std::vector<const Outline *>;

    Instant look(const Pose &ground_camera) const
    {
        Instant now;
        scenery_.view(ground_camera, now.light, now.glow);
        const Pose camera_ground = ground_camera.inverse();
        const Pose camera_bar = camera_ground * ground_bar(scene_);
        if (camera_bar.inverse().t[2] > 0) { /* else its back is seen */
            add_rects(camera_bar, sheet_, now.sheet);
            add_rects(camera_bar, scene_.pattern.black, now.black);
        }
        add_props(camera_ground, grass_, now.props);
        add_props(scene_.camera.detector_camera.inverse(), head_, now.props);
        return now;
    }

    void add_rects(const Pose &camera_bar, const std::vector<Rect> &rects,
                   std::vector<Outline> &out) const
    {
        for (const Rect &r : rects) {
            const auto at = [&](double x, double y) {
                return camera_bar * cv::Vec3d(x * MM, y * MM, 0);
            };
            Outline outline = projector_.outline(
                {at(r.x0, r.y0), at(r.x1, r.y0), at(r.x1, r.y1), at(r.x0, r.y1)});
            if (!outline.empty()) {
                out.push_back(std::move(outline));
            }
        }
    }

    void add_props(const Pose &camera_frame, const std::vector<Prop> &props,
                   std::vector<DrawnProp> &out) const
    {
        for (const Prop &prop : props) {
            std::vector<cv::Vec3d> corners;
            for (const cv::Vec3d &corner : prop.corners) {
                corners.push_back(camera_frame * corner);
            }
            Outline outline = projector_.outline(corners);
            if (!outline.empty()) {
                out.push_back({std::move(outline), prop.level});
            }
        }
    }

    /** The square that the cells of a tile cover. */
    cv::Rect2d reach_of(int x, int y) const
    {
        const double margin = blur_.reach_px() + 0.5;
        const double size = TILE_PX + 2 * blur_.reach_px();
        return {x - margin, y - margin, size, size};
    }

    static bool meets(const cv::Rect2d &a, const cv::Rect2d &b)
    {
        return a.x <= b.x + b.width && b.x <= a.x + a.width && a.y <= b.y + b.height &&
               b.y <= a.y + a.height;
    }

    void cover(const std::vector<Outline> &outlines, const cv::Rect2d &reach,
               std::vector<float> &out)
    {
        raster_.clear({reach.x, reach.y});
        for (const Outline &outline : outlines) {
            if (meets(outline.box, reach)) {
                raster_.add(outline);
            }
        }
        raster_.cover(out);
    }

    void paint_tile(const Instant &now, int x, int y, cv::Mat &picture)
    {
        const cv::Rect2d reach = reach_of(x, y);
        const auto touches = [&](const Outline &o) { return meets(o.box, reach); };
        const bool has_sheet = std::any_of(now.sheet.begin(), now.sheet.end(), touches);
        const bool has_props = std::any_of(now.props.begin(), now.props.end(),
                                           [&](const DrawnProp &p) { return touches(p.outline); });
        if (!has_sheet && !has_props) {
            return;
        }
        interpolate(now.glow, x, y, cells_);
        interpolate(now.light, x, y, light_);
        if (has_sheet) {
            lay_pattern(now, reach);
        }
        for (const DrawnProp &prop : now.props) {
            if (touches(prop.outline)) {
                lay_prop(prop, reach);
            }
        }
        blur_.reduce(cells_, TILE_PX, picture.ptr<float>(y) + x, picture.step1(),
                     std::min(TILE_PX, picture.rows - y), std::min(TILE_PX, picture.cols - x));
    }

    void lay_pattern(const Instant &now, const cv::Rect2d &reach)
    {
        cover(now.sheet, reach, covered_);
        cover(now.black, reach, inked_);
        const auto white = static_cast<float>(scene_.look.white);
        const auto ink = static_cast<float>(scene_.look.black) - white;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            cells_[i] =
                cells_[i] * (1 - covered_[i]) + light_[i] * (white * covered_[i] + ink * inked_[i]);
        }
    }

    void lay_prop(const DrawnProp &prop, const cv::Rect2d &reach)
    {
        raster_.clear({reach.x, reach.y});
        raster_.add(prop.outline);
        raster_.cover(covered_);
        const auto level = static_cast<float>(prop.level);
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            const float part = std::clamp(covered_[i], 0.0F, 1.0F);
            cells_[i] += part * (level * light_[i] - cells_[i]);
        }
    }

    /** A picture at pixel spacing on the cells of a tile, linear between the pixels, beyond the
     * border as on it. */
    void interpolate(const cv::Mat &picture, int x, int y, std::vector<float> &out)
    {
        const auto side = static_cast<std::size_t>(side_);
        const int per_px = blur_.per_px(), reach = blur_.reach_px();
        const int wide = TILE_PX + 2 * reach + 2;
        std::vector<float> line(static_cast<std::size_t>(wide));
        out.resize(side * side);
        const auto row_at = [&](int row) {
            return picture.ptr<float>(std::clamp(row, 0, picture.rows - 1));
        };
        for (std::size_t j = 0; j < side; ++j) {
            const double at = y - reach - 0.5 + (static_cast<double>(j) + 0.5) / per_px;
            const int above = static_cast<int>(std::floor(at));
            const auto down = static_cast<float>(at - above);
            const float *upper = row_at(above), *lower = row_at(above + 1);
            for (int i = 0; i < wide; ++i) {
                const int column = std::clamp(x - reach - 1 + i, 0, picture.cols - 1);
                line[static_cast<std::size_t>(i)] =
                    upper[column] + down * (lower[column] - upper[column]);
            }
            for (std::size_t i = 0; i < side; ++i) {
                const float across =
                    (static_cast<float>(i) + 0.5F) / static_cast<float>(per_px) + 0.5F;
                const auto left = static_cast<std::size_t>(across);
                out[j * side + i] = line[left] + (across - static_cast<float>(left)) *
                                                     (line[left + 1] - line[left]);
            }
        }
    }

    const Scene &scene_;
    Projector projector_;
    Scenery scenery_;
    Blur blur_;
    int side_;
    Raster raster_;
    std::vector<Rect> sheet_;
    std::vector<Prop> grass_, head_;
    std::vector<float> cells_, light_, covered_, inked_;
};

/** The farthest that a corner of the pattern moves in the picture while the shutter is open. */
double path_px(const Scene &scene)
{
    const Projector projector(scene.camera);
    const Pose bar = ground_bar(scene);
    const Pose before = ground_camera_at(scene, -scene.motion.shutter_s / 2).inverse() * bar;
    const Pose after = ground_camera_at(scene, scene.motion.shutter_s / 2).inverse() * bar;
    double longest = 0;
    for (const Rect &r : scene.pattern.targets) {
        const cv::Vec3d corner(r.x0 * MM, r.y0 * MM, 0);
        cv::Vec2d from, to;
        if (projector.point(before * corner, from) && projector.point(after * corner, to)) {
            longest = std::max(longest, cv::norm(to - from));
        }
    }
    return longest;
}

int steps_of(const Scene &scene)
{
    const Motion &m = scene.motion;
    if (m.shutter_s <= 0 || (cv::norm(m.velocity_m_s) == 0 && cv::norm(m.rotation_rad_s) == 0)) {
        return 1;
    }
    return m.steps > 0
               ? m.steps
               : std::clamp(static_cast<int>(std::ceil(2 * path_px(scene))), STEPS_MIN, STEPS_MAX);
}

} // namespace

cv::Mat render_light(const Scene &scene)
{
    const int steps = steps_of(scene);
    Painter painter(scene);
    cv::Mat sum = cv::Mat::zeros(scene.camera.height, scene.camera.width, CV_32F);
    for (int i = 0; i < steps; ++i) {
        const double part = (i + 0.5) / steps - 0.5;
        sum +=
            painter.paint(ground_camera_at(scene, steps > 1 ? part * scene.motion.shutter_s : 0));
    }
    return sum * (scene.look.gain / steps);
}

cv::Mat expose(const cv::Mat &light, const Look &look, std::uint64_t seed)
{
    Random random(seed, Stream::NOISE);
    const bool wide = look.bits == 16;
    const double unit = wide ? 257 : 1, top = wide ? 65535 : 255;
    const double read = look.noise_read * look.noise_read;
    cv::Mat picture(light.rows, light.cols, wide ? CV_16U : CV_8U);
    for (int y = 0; y < light.rows; ++y) {
        const float *from = light.ptr<float>(y);
        for (int x = 0; x < light.cols; ++x) {
            const double level = from[x];
            const double sigma = std::sqrt(read + look.noise_shot * std::max(level, 0.0));
            const double value = unit * (level + sigma * random.normal());
            const double cut = std::clamp(std::floor(value + 0.5), 0.0, top);
            if (wide) {
                picture.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(cut);
            } else {
                picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(cut);
            }
        }
    }
    return picture;
}

cv::Mat render(const Scene &scene)
{
    return expose(render_light(scene), scene.look, scene.seed);
}

} // namespace opms::simulate
