/* SPDX-License-Identifier: Apache-2.0 */
#include "made_records.hpp"

#include <cstring>

namespace made {

using namespace opms_host;

namespace {

/** The next numbers of record n. */
class Reals {
public:
    explicit Reals(std::uint64_t n) : n_(n) {}
    double next() { return real(n_, k_++); }
    template <std::size_t N> void fill(double (&values)[N])
    {
        for (double &value : values) {
            value = next();
        }
    }

private:
    std::uint64_t n_, k_ = 0;
};

opms_location_t location(std::uint64_t n)
{
    Reals reals(n);
    opms_location_t l{};
    l.state = OPMS_BAR_LOCATED;
    l.has_ground_detector = 1;
    l.covariance_includes = 7;
    l.followed = static_cast<std::uint32_t>(n % 2);
    l.bar.state = OPMS_BAR_LOCATED;
    l.bar.square_count = 5;
    l.bar.edge_count = static_cast<std::uint32_t>(n);
    l.bar.followed = static_cast<std::uint32_t>(n % 2);
    l.bar.label_margin = reals.next();
    reals.fill(l.bar.blur_px);
    l.bar.noise = reals.next();
    l.bar.contrast = reals.next();
    l.bar.white_fraction_saturated = reals.next();
    l.pose.state = OPMS_POSE_FOUND;
    l.pose.edges_used = static_cast<std::uint32_t>(n + 1);
    reals.fill(l.pose.bar_camera.transform.R);
    reals.fill(l.pose.bar_camera.transform.t_m);
    reals.fill(l.pose.bar_camera.covariance);
    l.pose.edge_shift_px = reals.next();
    l.pose.residual_px = reals.next();
    l.pose.chi2_dof = reals.next();
    l.pose.chi2_other = reals.next();
    reals.fill(l.pose.intrinsics_jacobian);
    reals.fill(l.ground_detector.transform.R);
    reals.fill(l.ground_detector.transform.t_m);
    reals.fill(l.ground_detector.covariance);
    return l;
}

opms_edge_t edge(std::uint64_t n, std::size_t i)
{
    opms_edge_t e{};
    e.square = static_cast<std::int32_t>(i % 33);
    e.side = static_cast<std::int32_t>(i % 4);
    double *const fields[] = {&e.bar_m[0], &e.bar_m[1],  &e.px[0],     &e.px[1],
                              &e.normal[0], &e.normal[1], &e.sigma_px, &e.shift_gain};
    for (std::size_t k = 0; k < 8; k++) {
        *fields[k] = real(n + i, k);
    }
    return e;
}

opms_square_t square(std::uint64_t n, std::size_t i)
{
    opms_square_t s{};
    s.index = static_cast<std::int32_t>(i);
    s.edges = static_cast<std::uint32_t>(4 * i);
    for (std::size_t k = 0; k < 8; k++) {
        s.corners_px[k / 2][k % 2] = real(n + 100 * i, k);
    }
    return s;
}

}  // namespace

double real(std::uint64_t n, std::uint64_t k)
{
    return static_cast<double>((n * 7919 + k * 104729) % 1000003) / 64.0 - 7812.0;
}

ScanHeader header(const std::string &name)
{
    ScanHeader h;
    h.name = name;
    h.begun_wall_ns = 1795356187000000000;
    h.begun_host_ns = 12345;
    h.mode = "position";
    h.camera_file_text = "model: \xc3\xa9\nlines: 'two'\n";
    h.camera_file_name = "camera.yaml";
    h.box_name = "simulated";
    h.source_name = "simulated";
    h.source_model = "none";
    h.has_box = true;
    h.box_identity.firmware_version[1] = 3;
    h.box_identity.capabilities = 5;
    std::memcpy(h.box_identity.git_hash, "0123456789abcdef0123", 21);
    for (std::uint8_t i = 0; i < 8; i++) {
        h.box_identity.unique_id[i] = static_cast<std::uint8_t>(0xA0 + i);
    }
    opms_wire_default_settings(&h.box_settings);
    h.camera_profile.has_frame_id = 1;
    h.camera_profile.frame_id_bits = 16;
    h.camera_profile.camera_tick_hz = 1000000000;
    h.camera_profile.start_delay_ns = -5;
    h.boot_id = 0xFFFFFFFFU;
    h.session_id = 5;
    h.width_px = 1024;
    h.height_px = 768;
    h.bar_tilt_rad = 0.25;
    h.bar = "hope33";
    h.versions_json = "{\"opms\":\"0.3.0\"}";
    h.settings_json = "{}";
    return h;
}

FrameRecord frame(std::uint64_t n)
{
    FrameRecord r;
    r.number = n;
    r.frame_id = n % 3 == 0 ? UINT64_MAX - n : n + 100;
    r.camera_time_ticks = n * 1000003;
    r.arrival_host_ns = static_cast<std::int64_t>(n * 16000000);
    r.flags = static_cast<std::uint32_t>(n % 8);
    r.exposure_us = n % 5 == 0 ? NOT_KNOWN : real(n, 1);
    r.gain_db = real(n, 2);
    r.white_level = n % 2 ? 4095 : 0;
    return r;
}

TriggerRecord trigger(std::uint64_t n)
{
    const auto small = static_cast<std::uint32_t>(n);
    TriggerRecord r;
    r.report.flags = OPMS_TRIGGER_RUN;
    r.report.boot_id = 0xFFFFFFFFU;
    r.report.session_id = 5;
    r.report.report_number = 2 * small;
    r.report.trigger_number = small;
    r.report.time = {n * 16667, static_cast<std::uint8_t>(n % 125)};
    r.report.start_edge = {1000, 3};
    r.report.first_run_number = 1;
    r.report.strobe_for_trigger = small - 1;
    r.report.strobe_delay_cycles = 3 * small;
    r.report.strobe_length_cycles = 4 * small;
    r.report.gap_us[0] = small + 1;
    r.report.gap_us[1] = small + 2;
    r.report.dropped = static_cast<std::uint16_t>(n % 7);
    r.from_history = n % 4 == 0;
    r.arrival_host_ns = static_cast<std::int64_t>(n * 16000000 + 1);
    return r;
}

PairRecord pair(std::uint64_t n)
{
    const auto time = static_cast<std::int64_t>(n * 1000000);
    PairRecord r;
    r.result.sequence = n - 1;
    r.result.trigger_state = n % 4 == 3 ? OPMS_TRIGGER_UNCERTAIN : OPMS_TRIGGER_PAIRED;
    r.result.frame_state = n % 4 == 3 ? OPMS_FRAME_UNCERTAIN : OPMS_FRAME_PAIRED;
    r.result.witnesses = static_cast<std::uint32_t>(n % 32);
    r.result.against = static_cast<std::uint32_t>(n % 5);
    r.result.known = 0x1FFF;
    r.result.boot_id = 0xFFFFFFFFU;
    r.result.session_id = 5;
    r.result.trigger_count = 1;
    r.result.trigger_number = n;
    r.result.frame_number = n + 100;
    r.result.trigger_box_ns = time;
    r.result.start_edge_box_ns = 1000024;
    r.result.start_delay_ns = 11;
    r.result.exposure_ns = 13;
    r.result.mid_exposure_box_ns = time + 17;
    r.result.camera_residual_ns = -19;
    r.result.arrival_delay_ns = 23;
    r.result.id_residual = -static_cast<std::int64_t>(n);
    r.result.frame = {n + 100, n * 1000003, time + 29, n, 0, 0};
    r.t_host_ns = time + 31;
    return r;
}

std::shared_ptr<const PoseRecord> pose(std::uint64_t n, std::size_t edges)
{
    auto r = std::make_shared<PoseRecord>();
    const auto time = static_cast<std::int64_t>(n * 1000000);
    r->number = n;
    r->frame_state = OPMS_FRAME_PAIRED;
    r->known = 0x7F;
    r->trigger_number = n;
    r->has_time = n % 6 != 0;
    r->is_mid_exposure = n % 2 == 0;
    r->t_scan_ns = r->has_time ? time - 5000000 : 0;
    r->t_host_ns = time + 1;
    r->has_hint = n % 2 == 0;
    if (r->has_hint) {
        Reals reals(n + 7);
        reals.fill(r->hint.R);
        reals.fill(r->hint.t_m);
    }
    r->location = location(n);
    for (std::size_t i = 0; i < 5; i++) {
        r->squares.push_back(square(n, i));
    }
    for (std::size_t i = 0; i < edges; i++) {
        r->edges.push_back(edge(n, i));
        r->residuals_px.push_back(real(n + i, 9));
    }
    r->light = {5, 0, 0.75, 0.8, 0.1, 0.001, 0.5, 0.05};
    r->exposure = {real(n, 3), real(n, 4), OPMS_EXPOSURE_MOVING, 1};
    r->blur = BlurVerdict::motion;
    r->blur_px = {real(n, 5), real(n, 6)};
    r->arrival_host_ns = time + 2;
    r->located_host_ns = time + 3;
    r->published_host_ns = time + 4;
    return r;
}

EventRecord event(std::uint64_t n)
{
    EventRecord r;
    r.t_host_ns = static_cast<std::int64_t>(n);
    r.severity = static_cast<Severity>(n % 3);
    r.code = "made." + std::to_string(n);
    r.text = "the " + std::to_string(n) + ". event, with 'quotes'";
    r.data_json = n % 2 ? "{\"n\":" + std::to_string(n) + "}" : "";
    return r;
}

ClockRecord clock(std::uint64_t n)
{
    const auto time = static_cast<std::int64_t>(n * 1000);
    ClockRecord r;
    r.trip = {time, time + 1, time + 2, time + 3};
    r.wall_ns = 1795356187000000000 + time;
    return r;
}

BoxReportRecord box_report(std::uint64_t n)
{
    BoxReportRecord r;
    for (std::size_t i = 0; i < r.bytes.size(); i++) {
        r.bytes[i] = static_cast<std::uint8_t>(n + 3 * i);
    }
    r.arrival_host_ns = static_cast<std::int64_t>(n);
    return r;
}

SensorRecord sensor(std::uint64_t n)
{
    SensorRecord r;
    r.sensor = n % 2 ? "metal" : "radar";
    r.number = n;
    r.has_time = n % 3 != 0;
    r.t_scan_ns = r.has_time ? static_cast<std::int64_t>(n * 7) : 0;
    r.t_bound_ns = static_cast<std::int64_t>(n % 1000);
    r.arrival_host_ns = static_cast<std::int64_t>(n * 9);
    for (std::uint64_t k = 0; k < n % 4; k++) {
        r.values.push_back(real(n, k));
    }
    r.data_json = n % 2 ? "{}" : "";
    return r;
}

ScanEnd end(const std::string &reason)
{
    ScanEnd e;
    e.ended_wall_ns = 1795356199000000000;
    e.ended_host_ns = 99;
    e.reason = reason;
    e.has_summary = true;
    e.summary.state = OPMS_PAIR_LOCKED;
    e.summary.sums_hold = 1;
    e.summary.counters.triggers = 41;
    e.summary.counters.boots_seen = 2;
    e.summary.clock.state = OPMS_CLOCK_FITTED;
    e.summary.clock.drift_ppm = -1.5;
    std::strcpy(e.summary.line, "LOCKED, 41 triggers");
    e.source.delivered = 43;
    e.source.buffers = 16;
    return e;
}

FramePtr picture(std::uint64_t n, std::int32_t width_px, std::int32_t height_px, bool is_16_bit)
{
    const auto width = static_cast<std::size_t>(width_px);
    const auto height = static_cast<std::size_t>(height_px);
    const std::size_t stride = (width + 5) * (is_16_bit ? 2 : 1); /* rows with a gap after them */
    auto bytes = std::make_shared<std::vector<std::uint8_t>>(stride * height, std::uint8_t{0xEE});
    for (std::size_t y = 0; y < height; y++) {
        for (std::size_t x = 0; x < width; x++) {
            const auto level = static_cast<std::uint8_t>(3 * x + 5 * y + 11 * n);
            if (is_16_bit) {
                const auto wide = static_cast<std::uint16_t>(level * 257);
                std::memcpy(bytes->data() + y * stride + 2 * x, &wide, 2);
            } else {
                (*bytes)[y * stride + x] = level;
            }
        }
    }
    auto frame_made = std::make_shared<Frame>();
    frame_made->image.pixels = bytes->data();
    frame_made->image.width_px = width_px;
    frame_made->image.height_px = height_px;
    frame_made->image.stride_bytes = static_cast<ptrdiff_t>(stride);
    frame_made->image.format = is_16_bit ? OPMS_PIXEL_GREY16 : OPMS_PIXEL_GREY8;
    frame_made->memory = bytes;
    return frame_made;
}

}  // namespace made
