# SPDX-License-Identifier: Apache-2.0
"""Figures over many pictures: errors, ratio to the limit, truth of the stated covariance."""

from __future__ import annotations

import numpy as np

from bench_locate_cli import Row

CHI2_3_95 = 7.815
CHI2_6_95 = 12.592


def rms(values) -> float:
    values = np.asarray(values, float)
    return float(np.sqrt(np.mean(values**2))) if values.size else float("nan")


def chi2(error: np.ndarray, covariance: np.ndarray) -> float:
    """error^T covariance^-1 error; infinite for a covariance that is none."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    if not np.isfinite(covariance).all() or (scale <= 0).any():
        return float("inf")
    normalised = covariance / np.outer(scale, scale)
    if np.linalg.eigvalsh(normalised)[0] <= 0:
        return float("inf")
    z = error / scale
    return float(z @ np.linalg.solve(normalised, z))


def chi2_cdf_6(x: np.ndarray) -> np.ndarray:
    return 1 - np.exp(-x / 2) * (1 + x / 2 + x * x / 8)


def summarise(rows: list[Row]) -> dict:
    located = [r for r in rows if r.located]
    position = np.array([r.position_mm for r in located])
    angle = np.array([r.angle_deg for r in located])
    axes = np.array([r.detector_error for r in located]).reshape(-1, 6)
    bounded = [r for r in located if r.limit is not None]
    limits = np.array([r.limit.position_mm for r in bounded])
    angle_limits = np.array([r.limit.angle_deg for r in bounded])
    times = np.array([r.time_us for r in located])
    visible = sum(r.visible_squares for r in rows)
    return {
        "pictures": len(rows),
        "located": len(located),
        "states": {s: sum(r.state == s for r in rows) for s in sorted({r.state for r in rows})},
        "wrong_labels": sum(r.wrong_labels for r in rows),
        "squares_of_visible": sum(r.squares for r in rows) / visible if visible else float("nan"),
        "position_rms_mm": rms(position),
        "position_median_mm": median(position),
        "position_max_mm": largest(position),
        "position_axis_rms_mm": [rms(axes[:, i]) * 1e3 for i in (3, 4, 5)],
        "position_axis_mean_mm": [float(v) * 1e3 for v in axes[:, 3:].mean(0)] if located else [],
        "angle_rms_deg": rms(angle),
        "angle_worst_axis_rms_deg": max((float(np.degrees(rms(axes[:, i]))) for i in range(3))),
        "angle_max_deg": largest(angle),
        "limit_position_rms_mm": rms(limits),
        "limit_angle_rms_deg": rms(angle_limits),
        "ratio_position": rms([r.position_mm for r in bounded]) / rms(limits)
        if len(limits) else float("nan"),
        "ratio_angle": rms([r.angle_deg for r in bounded]) / rms(angle_limits)
        if len(limits) else float("nan"),
        "edge_shift_px": median([r.edge_shift_px for r in located]),
        "residual_px": median([r.residual_px for r in located]),
        "time_median_us": median(times),
        "time_max_us": largest(times),
        "covariance_camera": coverage(located, "camera"),
        "covariance_detector": coverage(located, "detector"),
    }


def median(values) -> float:
    values = np.asarray(values, float)
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size else float("nan")


def largest(values) -> float:
    values = np.asarray(values, float)
    return float(values.max()) if values.size else float("nan")


def coverage(rows: list[Row], which: str) -> dict | None:
    """How often the truth lies inside the stated 95 % regions, by quartile of stated sigma."""
    usable = [r for r in rows if getattr(r, f"{which}_covariance") is not None]
    if not usable:
        return None
    errors = np.array([getattr(r, f"{which}_error") for r in usable])
    covariances = np.array([getattr(r, f"{which}_covariance") for r in usable])
    sigma = np.sqrt(np.trace(covariances[:, 3:, 3:], axis1=1, axis2=2))
    chi3 = np.array([chi2(e[3:], c[3:, 3:]) for e, c in zip(errors, covariances)])
    chi6 = np.array([chi2(e, c) for e, c in zip(errors, covariances)])
    quartiles = []
    for part in np.array_split(np.argsort(sigma, kind="stable"), 4):
        if not len(part):
            continue
        quartiles.append({
            "sigma_mm": [float(sigma[part].min()) * 1e3, float(sigma[part].max()) * 1e3],
            "count": len(part),
            "position_inside": float(np.mean(chi3[part] < CHI2_3_95)),
            "pose_inside": float(np.mean(chi6[part] < CHI2_6_95)),
            "mean_chi2_6_over_6": float(np.mean(chi6[part]) / 6),
        })
    return {"quartiles": quartiles, "mean_chi2_6_over_6": float(np.mean(chi6) / 6),
            "median_chi2_6": float(np.median(chi6)),
            "position_inside": float(np.mean(chi3 < CHI2_3_95)),
            "pose_inside": float(np.mean(chi6 < CHI2_6_95)),
            "chi2_6": chi6.tolist()}


def summary_markdown(s: dict) -> str:
    lines = ["| figure | value |", "|---|---|",
             f"| pictures, located | {s['pictures']}, {s['located']} {s['states']} |",
             f"| wrong labels | {s['wrong_labels']} |",
             f"| squares reported of those wholly in the picture | {s['squares_of_visible']:.3f} |",
             f"| detector position RMS, median, max | {s['position_rms_mm']:.3f}, "
             f"{s['position_median_mm']:.3f}, {s['position_max_mm']:.3f} mm |",
             f"| RMS along X, Y, Z | {triple(s['position_axis_rms_mm'], '.3f')} mm |",
             f"| mean (truth - found) along X, Y, Z | {triple(s['position_axis_mean_mm'])} mm |",
             f"| angle RMS (vector), worst axis, max | {s['angle_rms_deg']:.4f}, "
             f"{s['angle_worst_axis_rms_deg']:.4f}, {s['angle_max_deg']:.4f} deg |",
             f"| limit: position, angle RMS | {s['limit_position_rms_mm']:.4f} mm, "
             f"{s['limit_angle_rms_deg']:.4f} deg |",
             f"| ratio to the limit: position, angle | {s['ratio_position']:.2f}, "
             f"{s['ratio_angle']:.2f} |",
             f"| edge shift, residual (median) | {s['edge_shift_px']:+.3f}, "
             f"{s['residual_px']:.3f} px |",
             f"| time median, max | {s['time_median_us']:.0f}, {s['time_max_us']:.0f} us |"]
    return "\n".join(lines)


def triple(values: list[float], form: str = "+.3f") -> str:
    return ", ".join(format(v, form) for v in values)


def coverage_markdown(title: str, c: dict | None) -> str:
    if c is None:
        return f"{title}: no covariance stated"
    lines = [f"{title}: mean chi2_6/6 = {c['mean_chi2_6_over_6']:.2f}, median chi2_6 = "
             f"{c['median_chi2_6']:.2f} (5.35 expected); inside 95 %: position "
             f"{100 * c['position_inside']:.1f} %, pose {100 * c['pose_inside']:.1f} %", "",
             "| stated sigma, mm | pictures | position inside 95 % | pose inside 95 % "
             "| mean chi2_6/6 |", "|---|---|---|---|---|"]
    for q in c["quartiles"]:
        lines.append(f"| {q['sigma_mm'][0]:.3f} to {q['sigma_mm'][1]:.3f} | {q['count']} | "
                     f"{100 * q['position_inside']:.1f} % | {100 * q['pose_inside']:.1f} % | "
                     f"{q['mean_chi2_6_over_6']:.2f} |")
    return "\n".join(lines)


def rows_markdown(rows: list[Row]) -> str:
    lines = ["| picture | tilt | state | squares | wrong | dX dY dZ mm | mm | deg | limit mm | "
             "ratio | chi2_6/6 camera, detector | shift px | residual px | us |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        head = (f"| {r.image} | {r.tilt_deg:g} | {r.state} | {r.squares}/{r.visible_squares} | "
                f"{r.wrong_labels} | ")
        if not r.located:
            lines.append(head + f"{r.reason[:60]} |" + " |" * 8)
            continue
        limit = r.limit.position_mm if r.limit else float("nan")
        chi = [chi2(e, c) / 6 if c is not None else float("nan")
               for e, c in ((r.camera_error, r.camera_covariance),
                            (r.detector_error, r.detector_covariance))]
        lines.append(head + f"{triple(r.detector_error[3:] * 1e3)} | {r.position_mm:.3f} | "
                     f"{r.angle_deg:.4f} | {limit:.3f} | {r.position_mm / limit:.1f} | "
                     f"{chi[0]:.2f}, {chi[1]:.2f} | {r.edge_shift_px:+.3f} | "
                     f"{r.residual_px:.3f} | {r.time_us:.0f} |")
    return "\n".join(lines)


def row_to_json(row: Row) -> dict:
    data = {"image": row.image, "state": row.state, "reason": row.reason, "squares": row.squares,
            "visible_squares": row.visible_squares, "wrong_labels": row.wrong_labels,
            "tilt_deg": row.tilt_deg, "saturated": row.saturated}
    if row.located:
        data |= {"camera_error": row.camera_error.tolist(),
                 "detector_error": row.detector_error.tolist(),
                 "position_mm": row.position_mm, "angle_deg": row.angle_deg,
                 "edge_shift_px": row.edge_shift_px, "residual_px": row.residual_px,
                 "time_us": row.time_us}
    if row.limit is not None:
        data |= {"limit_position_mm": row.limit.position_mm,
                 "limit_angle_deg": row.limit.angle_deg}
    return data
