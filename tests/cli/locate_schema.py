# SPDX-License-Identifier: Apache-2.0
"""What a row of schema opms.locate/1 must look like (docs/locate.md)."""
import math

ALWAYS = ["schema", "image", "state"]
SEEN = ["squares", "time_us"]
POSE = ["R_bar_camera", "t_bar_camera_m", "covariance", "edge_shift_px", "residual_px"]
DETECTOR = ["R_ground_detector", "t_ground_detector_m", "covariance_ground_detector",
            "covariance_includes"]
INCLUDES = ["image", "intrinsics", "detector_camera"]


def _numbers(value, *shape):
    if not shape:
        return isinstance(value, (int, float)) and math.isfinite(value)
    return (isinstance(value, list) and len(value) == shape[0] and
            all(_numbers(item, *shape[1:]) for item in value))


def _square_problems(squares):
    if [s["index"] for s in squares] != sorted({s["index"] for s in squares}):
        yield "squares are not in the order of their indices, each once"
    for square in squares:
        if set(square) != {"index", "corners_px"}:
            yield f"a square has the keys {sorted(square)}"
        elif not 0 <= square["index"] <= 32 or not _numbers(square["corners_px"], 4, 2):
            yield f"square {square['index']} is malformed"


def _time_problems(time):
    if list(time) != ["detect", "pose", "total"] or not all(_numbers(v) for v in time.values()):
        yield "time_us is not {detect, pose, total}"
    elif time["total"] < time["detect"] + time["pose"] or min(time.values()) < 0:
        yield f"time_us does not add up: {time}"


def _pose_problems(row, has_detector):
    shapes = {"R_bar_camera": (3, 3), "t_bar_camera_m": (3,), "covariance": (6, 6),
              "edge_shift_px": (), "residual_px": (), "R_ground_detector": (3, 3),
              "t_ground_detector_m": (3,), "covariance_ground_detector": (6, 6)}
    for key in POSE + (DETECTOR[:3] if has_detector else []):
        if not _numbers(row[key], *shapes[key]):
            yield f"{key} has not the shape {shapes[key]}, or is not finite"
    for key in ["covariance"] + (["covariance_ground_detector"] if has_detector else []):
        if any(row[key][i][i] <= 0 for i in range(6)):
            yield f"{key} has a variance that is not positive"
    if has_detector and [i for i in INCLUDES if i in row["covariance_includes"]] != \
            row["covariance_includes"]:
        yield f"covariance_includes is {row['covariance_includes']}"


def row_problems(row, has_detector=True):
    """Everything that is wrong with a row, as texts."""
    state = row.get("state")
    wanted = ALWAYS + (["reason"] if state == "error" else SEEN)
    if state == "located":
        wanted = wanted + POSE + (DETECTOR if has_detector else [])
    if set(row) != set(wanted):
        yield f"keys missing or too many: {sorted(set(row) ^ set(wanted))}"
        return
    if row["schema"] != "opms.locate/1":
        yield f"schema is {row['schema']}"
    if state not in ("located", "absent", "ambiguous", "error"):
        yield f"state is {state}"
    if state == "error":
        return
    yield from _square_problems(row["squares"])
    yield from _time_problems(row["time_us"])
    if state == "located":
        yield from _pose_problems(row, has_detector)
