# SPDX-License-Identifier: Apache-2.0
"""Judging rows of `opms locate --json` by the truth of a picture.

The projection is written from docs/conventions.md and shares nothing with libopms."""
import math

HALF_SQUARE_M, PITCH_M, ORIGIN = 0.010, 0.030, 16
CORNERS = [(-1, -1), (1, -1), (1, 1), (-1, 1)]  # (X, Y), the order of corners_px


def project(camera, R_bar_camera, t_bar_camera, point):
    """Pixel of a point of the bar frame."""
    d = [p - t for p, t in zip(point, t_bar_camera)]
    xc, yc, zc = (sum(R_bar_camera[j][i] * d[j] for j in range(3)) for i in range(3))
    x, y = xc / zc, yc / zc
    r2 = x * x + y * y
    radial = 1 + camera["k1"] * r2 + camera["k2"] * r2 * r2
    xd = x * radial + 2 * camera["p1"] * x * y + camera["p2"] * (r2 + 2 * x * x)
    yd = y * radial + camera["p1"] * (r2 + 2 * y * y) + 2 * camera["p2"] * x * y
    return camera["fx"] * xd + camera["cx"], camera["fy"] * yd + camera["cy"]


def corners_px(truth, index):
    """Where the truth has the corners of a square."""
    return [project(truth["camera"], truth["R_bar_camera"], truth["t_bar_camera_m"],
                    (sx * HALF_SQUARE_M, (index - ORIGIN) * PITCH_M + sy * HALF_SQUARE_M, 0.0))
            for sx, sy in CORNERS]


def wrong_labels(row, truth):
    """Squares that lie nearer to another square's true place, or turned, by their corners."""
    wrong = []
    for square in row["squares"]:
        true = corners_px(truth, square["index"])
        side = min(math.dist(true[0], true[1]), math.dist(true[1], true[2]))
        worst = max(math.dist(a, b) for a, b in zip(true, square["corners_px"]))
        if worst > 0.3 * side:
            wrong.append(square["index"])
    return wrong


def position_error_mm(row, truth):
    return 1e3 * math.dist(row["t_ground_detector_m"], truth["t_ground_detector_m"])


def angle_error_deg(row, truth):
    """Angle of the rotation between the two orientations."""
    a, b = row["R_ground_detector"], truth["R_ground_detector"]
    # From the antisymmetric part: exact for small angles, where the trace is not.
    m = [[sum(a[k][i] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    sine = math.hypot(m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]) / 2
    return math.degrees(math.atan2(sine, (m[0][0] + m[1][1] + m[2][2] - 1) / 2))


def visible_squares(truth, margin_px=2.0):
    """Squares of which all corners lie well inside the picture (they may be covered)."""
    width, height = truth["image"]
    return [k for k in range(33)
            if all(margin_px <= u < width - margin_px and margin_px <= v < height - margin_px
                   for u, v in corners_px(truth, k))]
