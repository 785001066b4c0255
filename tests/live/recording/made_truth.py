# SPDX-License-Identifier: Apache-2.0
"""What made_records.cpp hands over, by the same formulas, as rows of scan.sqlite.

Each table: the columns to look at, and what they hold for the n-th record. Layouts of the BLOBs are
those that docs/recording.md states."""
import functools
import math
import struct

FIRST_FOR = {"events": 10, "clock_samples": 20, "box_reports": 60}  # every so many frames


def real(n, k):
    return ((n * 7919 + k * 104729) % 1000003) / 64.0 - 7812.0


def signed(n):
    return n - (1 << 64) if n >= 1 << 63 else n


def frames(n):
    frame_id = (1 << 64) - 1 - n if n % 3 == 0 else n + 100
    return (n, signed(frame_id), n * 1000003, n * 16000000, n % 8,
            None if n % 5 == 0 else real(n, 1), real(n, 2), 4095 if n % 2 else 0)


def triggers(n):
    return (n, n * 16667000 + n % 125 * 8, 2, 0xFFFFFFFF, 5, 2 * n, n * 16667, n % 125, 1000, 3, 1,
            n - 1, 3 * n, 4 * n, n + 1, n + 2, n % 7, int(n % 4 == 0), n * 16000000 + 1)


def pairs(n):
    t = n * 1000000
    state = "UNCERTAIN" if n % 4 == 3 else "PAIRED"
    return (n - 1, state, state, n % 32, n % 5, 0x1FFF, 0xFFFFFFFF, 5, 1, n, n + 100, t, 1000024,
            11, 13, t + 17, -19, 23, -n, n + 100, n * 1000003, t + 29, n, 0, t + 31)


def poses(n):
    t = n * 1000000
    # Where the numbers of the location begin, in the order of its layout.
    camera_t, ground_R, ground_t, ground_covariance = 6 + 9, 106, 106 + 9, 106 + 12

    def sigma(i):
        variance = real(n, ground_covariance + 7 * i)
        return math.sqrt(variance) if variance >= 0 else None
    R = [real(n, ground_R + k) for k in range(9)]
    return (n, "located", "PAIRED", n, None if n % 6 == 0 else t - 5000000, int(n % 2 == 0), t + 1,
            *(real(n, ground_t + k) for k in range(3)),
            math.atan2(R[3], R[0]), math.atan2(-R[6], math.hypot(R[7], R[8])),
            math.atan2(R[7], R[8]), sigma(3), sigma(4), sigma(5),
            *(real(n, camera_t + k) for k in range(3)),
            real(n, 54), real(n, 55), 5, 0.75, real(n, 3), "moving", 1, "motion",
            real(n, 5), real(n, 6), t + 2, t + 3, t + 4)


@functools.lru_cache(maxsize=None)
def locations(n, edges):
    reals = [real(n, k) for k in range(154)]
    location = struct.pack("<8I6d2I148d", 1, 1, 7, n % 2, 1, 5, n, n % 2, *reals[:6], 1, n + 1,
                           *reals[6:])
    squares = b"".join(struct.pack("<iI8d", i, 4 * i, *(real(n + 100 * i, k) for k in range(8)))
                       for i in range(5))
    rows = b"".join(struct.pack("<2i8d", i % 33, i % 4, *(real(n + i, k) for k in range(8)))
                    for i in range(edges))
    residuals = struct.pack(f"<{edges}d", *(real(n + i, 9) for i in range(edges)))
    hint = None if n % 2 else struct.pack("<12d", *(real(n + 7, k) for k in range(12)))
    return (n, location, squares, rows, residuals, hint)


def events(n):
    return (n, ("info", "warning", "error")[n % 3], f"made.{n}",
            f"the {n}. event, with 'quotes'", f'{{"n":{n}}}' if n % 2 else "")


def clock_samples(n):
    t = n * 1000
    return (t, t + 1, t + 2, t + 3, 1795356187000000000 + t)


def box_reports(n):
    return (n, bytes((n + 3 * i) % 256 for i in range(64)))


def sensor_samples(n):
    values = [real(n, k) for k in range(n % 4)]
    return ("metal" if n % 2 else "radar", n, n * 7 if n % 3 else None, n % 1000, n * 9,
            values[0] if values else None, struct.pack(f"<{len(values)}d", *values),
            "{}" if n % 2 else "")


def grey(n, x, y):
    """Works on numbers and on NumPy's grids."""
    return (3 * x + 5 * y + 11 * n) % 256


COLUMNS = {
    "frames": "number, frame_id, camera_time_ticks, arrival_host_ns, flags, exposure_us, gain_db, "
              "white_level",
    "triggers": "number, time_box_ns, flags, boot_id, session_id, report_number, time_us, "
                "time_cycles, start_us, start_cycles, first_run_number, strobe_for_trigger, "
                "strobe_delay_cycles, strobe_length_cycles, gap_0_us, gap_1_us, dropped, "
                "from_history, arrival_host_ns",
    "pairs": "sequence, trigger_state, frame_state, witnesses, against, known, boot_id, "
             "session_id, trigger_count, trigger_number, frame_number, trigger_box_ns, "
             "start_edge_box_ns, start_delay_ns, exposure_ns, mid_exposure_box_ns, "
             "camera_residual_ns, arrival_delay_ns, id_residual, frame_id, camera_time_ticks, "
             "arrival_host_ns, frame, frame_flags, t_host_ns",
    "poses": "number, state, frame_state, trigger_number, t_scan_ns, is_mid_exposure, t_host_ns, "
             "x_m, y_m, z_m, psi_rad, phi_rad, theta_rad, sigma_x_m, sigma_y_m, sigma_z_m, "
             "camera_x_m, camera_y_m, camera_z_m, edge_shift_px, residual_px, squares, "
             "light_white, next_exposure_us, exposure_state, blur_limited, blur, blur_y_px, "
             "blur_x_px, arrival_host_ns, located_host_ns, published_host_ns",
    "locations": "number, location, squares, edges, residuals_px, hint",
    "events": "t_host_ns, severity, code, text, data_json",
    "clock_samples": "sent_host_ns, received_box_ns, sent_box_ns, arrived_host_ns, wall_ns",
    "box_reports": "arrival_host_ns, bytes",
    "sensor_samples": "sensor, number, t_scan_ns, t_bound_ns, arrival_host_ns, value, sample, "
                      "data_json",
}


def row(table, n, edges):
    return locations(n, edges) if table == "locations" else globals()[table](n)


def numbers(table, frames_made):
    """Which n a table holds once that many frames were made."""
    step = FIRST_FOR.get(table, 1)
    return range(step, frames_made + 1, step)
