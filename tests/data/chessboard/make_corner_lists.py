# SPDX-License-Identifier: Apache-2.0
"""Find the corners in OpenCV's own calibration pictures, and what OpenCV makes of them.

    make_corner_lists.py FOLDER     (needs opencv-python; FOLDER holds left01.jpg ... right14.jpg)

The pictures ship with OpenCV as samples/data, and in Debian's package opencv-doc. The lists are
kept beside this script as left.txt and right.txt: the tests need neither pictures nor OpenCV.
"""
import sys
from pathlib import Path

import cv2
import numpy as np

HERE = Path(__file__).resolve().parent
COLUMNS, ROWS = 9, 6  # inner corners
# A square is the unit of length; only the distances would change.
SQUARE_M = 0.025
EXACT = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 1000, 1e-14)
REFINE = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 100, 1e-4)
HALF_WINDOW_PX = (5, 5)
HEADER = """\
# Chessboard corners of OpenCV's calibration pictures {side}*.jpg (OpenCV samples/data; Copyright
# OpenCV Foundation and contributors; Apache-2.0 and BSD-3-Clause), found by OpenCV {version}:
# findChessboardCorners and cornerSubPix. Written by make_corner_lists.py.
# size: width and height of the pictures, px
# board: corners along X and along Y, distance in m; listed by rising X, then rising Y
# opencv: fx fy cx cy k1 k2 p1 p2 and the RMS length of the residuals in px, by calibrateCamera with
#   k3 = 0 on these corners
# picture: its name, then the corners (u, v) in px
"""


def find_corners(path):
    grey = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if grey is None:
        raise SystemExit(f"{path}: no picture")
    found, corners = cv2.findChessboardCorners(grey, (COLUMNS, ROWS))
    if not found:
        return grey.shape[::-1], None
    refined = cv2.cornerSubPix(grey, corners, HALF_WINDOW_PX, (-1, -1), REFINE)
    # Kept to 1e-4 px, so OpenCV solves with what is kept.
    return grey.shape[::-1], np.round(refined.reshape(-1, 2).astype(float), 4)


def board_points():
    j, i = np.mgrid[0:ROWS, 0:COLUMNS]
    return np.stack([i.ravel(), j.ravel(), 0 * i.ravel()], axis=1) * SQUARE_M


def calibrate(corners, size):
    target = [board_points().astype(np.float32)] * len(corners)
    seen = [c.astype(np.float32).reshape(-1, 1, 2) for c in corners]
    rms, matrix, distortion, _, _ = cv2.calibrateCamera(
        target, seen, size, None, None, flags=cv2.CALIB_FIX_K3, criteria=EXACT)
    k1, k2, p1, p2 = distortion.ravel()[:4]
    return [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], k1, k2, p1, p2, rms]


def write_list(side, folder):
    names, lists, sizes = [], [], set()
    for path in sorted(folder.glob(f"{side}[0-9][0-9].jpg")):
        size, corners = find_corners(path)
        if corners is None:
            print(f"{path.name}: no chessboard", file=sys.stderr)
            continue
        names.append(path.stem)
        lists.append(corners)
        sizes.add(size)
    if len(sizes) != 1:
        raise SystemExit(f"{folder}: {len(sizes)} sizes of pictures {side}*.jpg, not one")
    size = sizes.pop()
    lines = [HEADER.format(side=side, version=cv2.__version__)
             + f"size {size[0]} {size[1]}", f"board {COLUMNS} {ROWS} {SQUARE_M}",
             "opencv " + " ".join(f"{value:.10g}" for value in calibrate(lists, size))]
    for name, corners in zip(names, lists):
        lines += [f"picture {name}"] + [f"{u:.4f} {v:.4f}" for u, v in corners]
    (HERE / f"{side}.txt").write_text("\n".join(lines) + "\n")
    print(f"{side}: {len(names)} pictures")


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    for side in ("left", "right"):
        write_list(side, Path(sys.argv[1]))


if __name__ == "__main__":
    main()
