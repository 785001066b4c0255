# SPDX-License-Identifier: Apache-2.0
"""Judging nodes and calibrations of grid pictures by their truth.

The projection and the small linear algebra are written from docs/conventions.md and share nothing
with libopms."""
import math

from truth import project

PITCH_M, CENTRE = 0.025, 50
HALF_LINES = (16, 22)  # lines on either side of the centre, along X and along Y
LENS = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")


def node_px(truth, label):
    """Where the truth has a node; `bar` means `grid` in these files."""
    x, y = ((n - CENTRE) * PITCH_M for n in label)
    return project(truth["camera"], truth["R_bar_camera"], truth["t_bar_camera_m"], (x, y, 0.0))


def in_front(truth, label):
    """Whether a node is ahead of the camera: behind it the projection means nothing."""
    d = [p - t for p, t in zip([(n - CENTRE) * PITCH_M for n in label] + [0.0],
                               truth["t_bar_camera_m"])]
    return sum(truth["R_bar_camera"][j][2] * d[j] for j in range(3)) > 0.1


def nodes_in_sight(truth, margin_px):
    """Labels of the nodes that lie in the picture, this far from its border."""
    width, height = truth["image"]
    labels = [(CENTRE + i, CENTRE + j) for i in range(-HALF_LINES[0], HALF_LINES[0] + 1)
              for j in range(-HALF_LINES[1], HALF_LINES[1] + 1)]
    seen = []
    for label in labels:
        if in_front(truth, label):
            u, v = node_px(truth, label)
            if margin_px <= u <= width - 1 - margin_px and margin_px <= v <= height - 1 - margin_px:
                seen.append(label)
    return seen


def node_errors_px(row, truth):
    """Distance of each node from its truth."""
    return [math.dist(n["px"], node_px(truth, n["label"])) for n in row["nodes"]]


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def solve(matrix, vector):
    """x of A x = b, by elimination with pivoting."""
    n = len(vector)
    rows = [list(row) + [b] for row, b in zip(matrix, vector)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda r: abs(rows[r][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for r in range(k + 1, n):
            factor = rows[r][k] / rows[k][k]
            rows[r] = [a - factor * b for a, b in zip(rows[r], rows[k])]
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - sum(rows[k][c] * x[c] for c in range(k + 1, n))) / rows[k][k]
    return x


def chi2(error, covariance):
    """Squared Mahalanobis length; scaled first, since px and 1/px^4 stand side by side."""
    scale = [math.sqrt(covariance[i][i]) for i in range(len(error))]
    e = [a / s for a, s in zip(error, scale)]
    c = [[v / (si * sj) for v, sj in zip(row, scale)] for row, si in zip(covariance, scale)]
    return sum(a * b for a, b in zip(e, solve(c, e)))


def rotation_vector(R, R_true):
    """w of R_true = R Exp(w), for small w."""
    d = [[sum(R[k][i] * R_true[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    w = [(d[2][1] - d[1][2]) / 2, (d[0][2] - d[2][0]) / 2, (d[1][0] - d[0][1]) / 2]
    sine = math.sqrt(sum(x * x for x in w))
    return [x * (math.asin(sine) / sine if sine > 0 else 1.0) for x in w]
