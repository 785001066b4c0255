/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The project's own renderer: pictures of the marker bar and of the calibration grid, with their
 * truth. It judges libopms and therefore shares no code with it; its projection, its patterns and
 * its camera file reader are its own.
 *
 * Use: fill a Scene (a Camera, a Pattern, where the camera is, how it looks, how it moves), call
 * render(), then write_picture(). Everything that is random follows from Scene::seed.
 *
 * Frames and units are docs/conventions.md's: R_a_b and t_a_b take b to a, metres, pixel (0, 0) is
 * the centre of the top left pixel. Patterns are in millimetres, as their definition is. */
#ifndef OPMS_SIMULATE_SIMULATE_HPP
#define OPMS_SIMULATE_SIMULATE_HPP

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace opms::simulate
{

constexpr double PI = 3.14159265358979323846;
constexpr double RAD = PI / 180;

/** Takes coordinates in one frame to another: p_a = R p_b + t. */
struct Pose {
    cv::Matx33d R = cv::Matx33d::eye();
    cv::Vec3d t{0, 0, 0};

    cv::Vec3d operator*(const cv::Vec3d &p) const
    {
        return R * p + t;
    }
    Pose operator*(const Pose &other) const
    {
        return {R * other.R, R * other.t + t};
    }
    Pose inverse() const
    {
        return {R.t(), -(R.t() * t)};
    }
};

/** Right-handed rotation by the length of @p w about its direction. */
cv::Matx33d rotation(const cv::Vec3d &w);

/** Pinhole and four-parameter Seidel lens, and where the camera is mounted. The default is the
 * HOPE camera of docs/conventions.md. */
struct Camera {
    std::string name = "hope";
    int width = 1024, height = 768;
    double fx = 585.0, fy = 585.0, cx = 517.3, cy = 379.6;
    double k1 = -0.118, k2 = 0.031, p1 = 0.0011, p2 = -0.0007;
    Pose detector_camera = hope_mounting();

    static Pose hope_mounting();
};

/** Throws std::runtime_error that names the file and the field. */
Camera read_camera(const std::string &path);
void write_camera(const std::string &path, const Camera &camera);

/** Picture of normalised coordinates x/z, y/z. */
cv::Vec2d distort(const Camera &camera, const cv::Vec2d &normalised);
/** The inverse of distort(); false where the lens model has folded and no such ray exists. */
bool undistort(const Camera &camera, const cv::Vec2d &px, cv::Vec2d &normalised);
/** Radius in normalised coordinates up to which distort() is one to one in every direction. */
double fold_radius(const Camera &camera);

/** An axis-parallel rectangle in the plane of the pattern, mm. */
struct Rect {
    double x0, y0, x1, y1;
};

/** A printed sheet: white in its outline, black in disjoint rectangles. */
struct Pattern {
    std::string name;
    Rect sheet{};
    std::vector<Rect> black;
    std::vector<Rect> targets; /**< what "visible" counts: the bar's squares */
};

/** "hope33", "apriltag33", "a0-25" or "evaluation" (the grid with a bar on it). Every black edge
 * is moved outwards by @p gain_mm, as ink that runs does; negative: inwards. Throws
 * std::invalid_argument for another name. */
Pattern make_pattern(const std::string &name, double gain_mm = 0);

/** How the scene looks and what the sensor makes of it. Levels are of an 8 bit picture. */
struct Look {
    double black = 40, white = 190;
    double gain = 1;           /**< on everything before the noise; what passes 255 is cut */
    double blur_px = 0.692219; /**< Gaussian of the optics; the pixel's own square is added */
    double noise_read = 3;     /**< standard deviation */
    double noise_shot = 0;     /**< variance a grey level */
    double ground = 110, ground_contrast = 15; /**< mean and standard deviation of the soil */
    double light_gradient = 0;                 /**< relative change of the light a metre */
    double shadow = 1; /**< light on the far side of a shadow's edge; 1 = none */
    double penumbra_mm = 10;
    int grass = 0;               /**< blades about the bar */
    double head_diameter_mm = 0; /**< the detector's own head, dark; 0 = not drawn */
    int bits = 8;
};

/** Gaussian of the optics that makes @p total_px together with the square pixel's own
 * 1/sqrt(12); throws std::invalid_argument below that. */
double optics_blur(double total_px);
double total_blur(double optics_px);

/** The detector's motion about mid-exposure, in the ground frame, about its own origin. */
struct Motion {
    cv::Vec3d velocity_m_s{0, 0, 0};
    cv::Vec3d rotation_rad_s{0, 0, 0};
    double shutter_s = 0;
    int steps = 0; /**< pictures that are averaged; 0 = as many as half a pixel each asks for */
};

struct Scene {
    Camera camera;
    Pattern pattern;
    double tilt_rad = 0;
    Pose ground_camera; /**< at mid-exposure */
    Look look;
    Motion motion;
    std::uint64_t seed = 1;
};

Pose ground_bar(const Scene &scene);
Pose bar_camera(const Scene &scene);
Pose ground_detector(const Scene &scene);
/** The camera at @p t_s after mid-exposure. */
Pose ground_camera_at(const Scene &scene, double t_s);

/** Targets of the pattern with all corners at least @p margin_px inside the picture. */
int count_visible(const Scene &scene, double margin_px = 4);

/** Light on the pixels before noise, cut and rounding, CV_32F, in 8 bit grey levels. */
cv::Mat render_light(const Scene &scene);
/** Noise, cut and rounding; 16 bit pictures hold 257 times the 8 bit level. */
cv::Mat expose(const cv::Mat &light, const Look &look, std::uint64_t seed);
/** The picture: render_light(), then expose(). */
cv::Mat render(const Scene &scene);

/** Where random poses come from. A range is lowest, highest. */
struct PoseRange {
    cv::Vec2d x_m{0.15, 0.55}, y_m{-0.5, 0.5}, z_m{0, 0.115};
    cv::Vec3d attitude_deg{0, 0, 0}; /**< psi, phi, theta: each even within plus or minus */
    cv::Vec2d camera_roll_deg{0, 0}; /**< about the optical axis; the detector turns with it */
    /** With a distance, the camera looks at a point of the bar instead, from this far ... */
    cv::Vec2d distance_m{0, 0};
    /** ... this far off the normal of its face ... */
    cv::Vec2d incidence_deg{0, 0};
    /** ... in this direction about the normal, 0 = from the operator's side ... */
    cv::Vec2d azimuth_deg{0, 360};
    /** ... at a point this far along the bar. */
    cv::Vec2d along_m{-0.45, 0.45};
};

/** A camera pose in @p range, in the ground frame, for Scene::seed and the given try. */
Pose sample_pose(const Scene &scene, const PoseRange &range, int attempt);
/** Step @p index of a calibration lift: the first is level on the default footprint, the others
 * rise to 0.2 m and turn. */
Pose sample_lift(const Scene &scene, int index, int count);
/** Camera poses from a JSON file: a truth file or a list of objects with R_bar_camera and
 * t_bar_camera_m, or R_ground_detector and t_ground_detector_m. */
std::vector<Pose> read_poses(const std::string &path, const Scene &scene);

/** The truth as JSON text, in the form that every tool of the project reads. @p kind is "bar" or
 * "grid". */
std::string truth_json(const Scene &scene, const std::string &kind);
/** Writes FOLDER/NAME.png and FOLDER/NAME.json; throws std::runtime_error naming the file. */
void write_picture(const std::string &folder, const std::string &name, const std::string &kind,
                   const Scene &scene, const cv::Mat &picture);

} // namespace opms::simulate
#endif
