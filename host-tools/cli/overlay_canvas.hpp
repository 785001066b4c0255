/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Antialiased drawing at subpixel places, and the colours of the overlay. */
#ifndef OPMS_CLI_OVERLAY_CANVAS_HPP
#define OPMS_CLI_OVERLAY_CANVAS_HPP

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace colour {
const cv::Scalar background(30, 27, 24);
const cv::Scalar text(235, 235, 235);
const cv::Scalar dim(160, 155, 150);
const cv::Scalar halo(15, 15, 15);
const cv::Scalar square(255, 200, 0);
const cv::Scalar good(95, 215, 95);
const cv::Scalar fair(40, 200, 255);
const cv::Scalar bad(70, 70, 255);
const cv::Scalar head(255, 120, 230);
const cv::Scalar axis_x(70, 70, 255);
const cv::Scalar axis_y(95, 215, 95);
const cv::Scalar axis_z(255, 150, 60);
}  // namespace colour

/** A region of a picture with its own scale; coordinates are pixels with (0, 0) at the centre of
 * the top left one, as everywhere in opms. */
class Canvas {
public:
    /** @param mat  Drawn on. @param scale  Pixels of mat for one unit. */
    Canvas(cv::Mat &mat, double scale) : mat_(mat), scale_(scale) {}

    double scale() const { return scale_; }
    /** Whether a point lies on the canvas. */
    bool holds(const cv::Point2d &p) const;

    /* Widths, heights and radii are in pixels of the matrix. */
    void line(const cv::Point2d &a, const cv::Point2d &b, const cv::Scalar &c, int width) const;
    void polygon(const std::vector<cv::Point2d> &points, bool closed, const cv::Scalar &c,
                 int width) const;
    void arrow(const cv::Point2d &a, const cv::Point2d &b, const cv::Scalar &c, int width) const;
    void dot(const cv::Point2d &p, double radius, const cv::Scalar &c) const;
    void fill(const std::vector<cv::Point2d> &points, const cv::Scalar &c) const;
    /** Text with its centre at a point and a dark halo. @param height of a capital. */
    void label(const cv::Point2d &centre, const std::string &s, double height,
               const cv::Scalar &c) const;
    /** Text whose baseline begins at a point. @return its width in units. */
    double text(const cv::Point2d &baseline, const std::string &s, double height,
                const cv::Scalar &c, int weight = 1) const;

private:
    cv::Point fixed(const cv::Point2d &p) const;
    cv::Mat &mat_;
    double scale_;
};

/** Colour of an edge by its residual in units of its own sigma. */
cv::Scalar residual_colour(double residual_over_sigma);

#endif
