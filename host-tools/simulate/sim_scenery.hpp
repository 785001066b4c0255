/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What is about the pattern: soil, light, grass, the detector's own head. */
#ifndef OPMS_SIMULATE_SIM_SCENERY_HPP
#define OPMS_SIMULATE_SIM_SCENERY_HPP

#include <array>
#include <vector>

#include "simulate/simulate.hpp"

namespace opms::simulate
{

/** Soil and light of one seed. Both belong to the ground plane: the bar gets the light of the
 * ground that is seen in the same direction. */
class Scenery
{
  public:
    explicit Scenery(const Scene &scene);

    /** Pictures at pixel spacing, CV_32F: @p light relative to plain light, @p glow the ground's
     * grey level in that light. */
    void view(const Pose &ground_camera, cv::Mat &light, cv::Mat &glow) const;

  private:
    static constexpr int LATTICE = 256;
    static constexpr int RAY_STEP = 8; /* rays are computed this far apart, else interpolated */

    void make_rays();
    void view_row(const Pose &ground_camera, int row, float *light, float *glow) const;
    double soil(double x, double y, double px_m) const;
    double light_at(double x, double y) const;

    Camera camera_;
    Look look_;
    static constexpr std::array<double, 4> SCALES_M = {0.40, 0.12, 0.036, 0.011};

    std::vector<float> lattice_;
    std::array<cv::Vec2d, SCALES_M.size()> offsets_; /**< no place is a node of all scales */
    std::vector<cv::Vec2d> rays_;
    int rays_across_ = 0;
    cv::Vec2d gradient_, shadow_point_, shadow_normal_;
};

/** Something flat in front of pattern and ground. */
struct Prop {
    std::vector<cv::Vec3d> corners; /**< m, in the frame that its list is in */
    double level;
};

/** Blades about the bar, in the ground frame. */
std::vector<Prop> make_grass(const Scene &scene);
/** The search head, in the detector's frame; empty where it is not drawn. */
std::vector<Prop> make_head(const Scene &scene);

} // namespace opms::simulate
#endif
