/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The two halves of an overlay. */
#ifndef OPMS_CLI_OVERLAY_PARTS_HPP
#define OPMS_CLI_OVERLAY_PARTS_HPP

#include "overlay.hpp"
#include "overlay_canvas.hpp"

/** A residual of one pixel is drawn this many pixels of the picture long. */
constexpr double RESIDUAL_MAGNIFIED = 100;
/** Radius of the search head that is drawn. */
constexpr double HEAD_RADIUS_M = 0.1;

/** Squares, labels, edge points, axes and the head, in pixels of the picture. */
void overlay_draw_marks(const Canvas &canvas, const OverlayScene &scene);

/** State, figures, legend and the view from above; @p panel is a part of the overlay.
 * @param magnification  of the picture beside it. */
void overlay_draw_panel(cv::Mat panel, const OverlayScene &scene, double magnification);

/** The bar and the detector seen from above. @param area  pixels of @p panel. */
void overlay_draw_plan(cv::Mat &panel, const cv::Rect &area, const OverlayScene &scene);

#endif
