/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which column holds which field: once for each kind of record, for writing and for reading.
 *
 * columns(visit, record) names the columns in their order; `visit` lists them, binds them, or reads
 * them (column_visitors.hpp). RecordTable<Record> names table and order. */
#ifndef OPMS_RECORDING_RECORD_COLUMNS_HPP
#define OPMS_RECORDING_RECORD_COLUMNS_HPP

#include <cmath>
#include <cstdint>
#include <type_traits>

#include <opms/pair.h>

#include "column_names.hpp"
#include "scan_records.hpp"

namespace opms_host {

template <typename Record> struct RecordTable;
template <> struct RecordTable<TriggerRecord> {
    static constexpr const char *name = "triggers", *key = "id";
};
template <> struct RecordTable<FrameRecord> {
    static constexpr const char *name = "frames", *key = "number";
};
template <> struct RecordTable<PairRecord> {
    static constexpr const char *name = "pairs", *key = "id";
};
template <> struct RecordTable<PoseRecord> {
    static constexpr const char *name = "poses", *key = "number";
};
template <> struct RecordTable<EventRecord> {
    static constexpr const char *name = "events", *key = "id";
};
template <> struct RecordTable<ClockRecord> {
    static constexpr const char *name = "clock_samples", *key = "id";
};
template <> struct RecordTable<BoxReportRecord> {
    static constexpr const char *name = "box_reports", *key = "id";
};
template <> struct RecordTable<SensorRecord> {
    static constexpr const char *name = "sensor_samples", *key = "id";
};

/** @p Record is const where @p visit only looks. */
template <typename Record, typename Plain>
using IfRecord = std::enable_if_t<std::is_same_v<std::remove_const_t<Record>, Plain>>;

template <typename Visit, typename Record, IfRecord<Record, TriggerRecord> * = nullptr>
void columns(Visit &visit, Record &record)
{
    auto &report = record.report;
    visit("number", report.trigger_number);
    visit("flags", report.flags);
    visit("boot_id", report.boot_id);
    visit("session_id", report.session_id);
    visit("report_number", report.report_number);
    visit("time_us", report.time.us);
    visit("time_cycles", report.time.cycles);
    visit("start_us", report.start_edge.us);
    visit("start_cycles", report.start_edge.cycles);
    visit("first_run_number", report.first_run_number);
    visit("strobe_for_trigger", report.strobe_for_trigger);
    visit("strobe_delay_cycles", report.strobe_delay_cycles);
    visit("strobe_length_cycles", report.strobe_length_cycles);
    visit("gap_0_us", report.gap_us[0]);
    visit("gap_1_us", report.gap_us[1]);
    visit("dropped", report.dropped);
    visit("from_history", record.from_history);
    visit("arrival_host_ns", record.arrival_host_ns);
}

template <typename Visit, typename Record, IfRecord<Record, FrameRecord> * = nullptr>
void columns(Visit &visit, Record &record)
{
    visit("number", record.number);
    visit("frame_id", record.frame_id);
    visit("camera_time_ticks", record.camera_time_ticks);
    visit("arrival_host_ns", record.arrival_host_ns);
    visit("flags", record.flags);
    visit("exposure_us", record.exposure_us);
    visit("gain_db", record.gain_db);
    visit("white_level", record.white_level);
}

template <typename Visit, typename Record, IfRecord<Record, PairRecord> * = nullptr>
void columns(Visit &visit, Record &record)
{
    auto &result = record.result;
    visit("sequence", result.sequence);
    visit.state("trigger_state", result.trigger_state, TRIGGER_STATES);
    visit.state("frame_state", result.frame_state, FRAME_STATES);
    visit("witnesses", result.witnesses);
    visit("against", result.against);
    visit("known", result.known);
    visit("boot_id", result.boot_id);
    visit("session_id", result.session_id);
    visit("trigger_count", result.trigger_count);
    visit("trigger_number", result.trigger_number);
    visit("frame_number", result.frame_number);
    visit("trigger_box_ns", result.trigger_box_ns);
    visit("start_edge_box_ns", result.start_edge_box_ns);
    visit("start_delay_ns", result.start_delay_ns);
    visit("exposure_ns", result.exposure_ns);
    visit("mid_exposure_box_ns", result.mid_exposure_box_ns);
    visit("camera_residual_ns", result.camera_residual_ns);
    visit("arrival_delay_ns", result.arrival_delay_ns);
    visit("id_residual", result.id_residual);
    visit("frame_id", result.frame.frame_id);
    visit("camera_time_ticks", result.frame.camera_time_ticks);
    visit("arrival_host_ns", result.frame.arrival_host_ns);
    visit("frame", result.frame.tag);
    visit("frame_flags", result.frame.flags);
    visit("t_host_ns", record.t_host_ns);
}

/** What a person would ask for, computed from the location; not read back. */
template <typename Visit> void shown_columns(Visit &visit, const PoseRecord &record)
{
    const opms_location_t &location = record.location;
    const bool located = location.state == OPMS_BAR_LOCATED;
    const bool placed = located && location.has_ground_detector != 0;
    const double *R = location.ground_detector.transform.R;
    const double *t = location.ground_detector.transform.t_m;
    const double *covariance = location.ground_detector.covariance;
    const double *camera = location.pose.bar_camera.transform.t_m;
    visit.shown("x_m", placed, t[0]);
    visit.shown("y_m", placed, t[1]);
    visit.shown("z_m", placed, t[2]);
    visit.shown("psi_rad", placed, std::atan2(R[3], R[0]));
    visit.shown("phi_rad", placed, std::atan2(-R[6], std::hypot(R[7], R[8])));
    visit.shown("theta_rad", placed, std::atan2(R[7], R[8]));
    visit.shown("sigma_x_m", placed, std::sqrt(covariance[21]));
    visit.shown("sigma_y_m", placed, std::sqrt(covariance[28]));
    visit.shown("sigma_z_m", placed, std::sqrt(covariance[35]));
    visit.shown("camera_x_m", located, camera[0]);
    visit.shown("camera_y_m", located, camera[1]);
    visit.shown("camera_z_m", located, camera[2]);
    visit.shown("squares", true, static_cast<std::int64_t>(record.squares.size()));
    visit.shown("edges", true, static_cast<std::int64_t>(record.edges.size()));
    visit.shown("edge_shift_px", located, location.pose.edge_shift_px);
    visit.shown("residual_px", located, location.pose.residual_px);
}

template <typename Visit, typename Record, IfRecord<Record, PoseRecord> * = nullptr>
void columns(Visit &visit, Record &record)
{
    visit("number", record.number);
    visit.state("state", record.location.state, BAR_STATES);
    visit.state("frame_state", record.frame_state, FRAME_STATES);
    visit("trigger_number", record.trigger_number);
    visit.where("t_scan_ns", record.has_time, record.t_scan_ns);
    visit("is_mid_exposure", record.is_mid_exposure);
    visit("t_host_ns", record.t_host_ns);
    visit("known", record.known);
    visit("light_squares", record.light.squares);
    visit("light_white", record.light.white);
    visit("light_white_high", record.light.white_high);
    visit("light_black", record.light.black);
    visit("light_saturated", record.light.saturated);
    visit("light_picture_white", record.light.picture_white);
    visit("light_picture_black", record.light.picture_black);
    visit("next_exposure_us", record.exposure.exposure_us);
    visit("next_gain_db", record.exposure.gain_db);
    visit.state("exposure_state", record.exposure.state, EXPOSURE_STATES);
    visit("blur_limited", record.exposure.blur_limited);
    visit.state("blur", record.blur, BLUR_VERDICTS);
    visit("blur_y_px", record.blur_px[0]);
    visit("blur_x_px", record.blur_px[1]);
    visit("arrival_host_ns", record.arrival_host_ns);
    visit("located_host_ns", record.located_host_ns);
    visit("published_host_ns", record.published_host_ns);
    shown_columns(visit, record);
}

template <typename Visit, typename Record, IfRecord<Record, EventRecord> * = nullptr>
void columns(Visit &visit, Record &record)
{
    visit("t_host_ns", record.t_host_ns);
    visit.state("severity", record.severity, SEVERITIES);
    visit("code", record.code);
    visit("text", record.text);
    visit("data_json", record.data_json);
}

template <typename Visit, typename Record, IfRecord<Record, ClockRecord> * = nullptr>
void columns(Visit &visit, Record &record)
{
    visit("sent_host_ns", record.trip.sent_host_ns);
    visit("received_box_ns", record.trip.received_box_ns);
    visit("sent_box_ns", record.trip.sent_box_ns);
    visit("arrived_host_ns", record.trip.arrived_host_ns);
    visit("wall_ns", record.wall_ns);
}

template <typename Visit, typename Record, IfRecord<Record, BoxReportRecord> * = nullptr>
void columns(Visit &visit, Record &record)
{
    visit("arrival_host_ns", record.arrival_host_ns);
    visit.bytes("bytes", record.bytes);
}

template <typename Visit, typename Record, IfRecord<Record, SensorRecord> * = nullptr>
void columns(Visit &visit, Record &record)
{
    visit("sensor", record.sensor);
    visit("number", record.number);
    visit.where("t_scan_ns", record.has_time, record.t_scan_ns);
    visit("t_bound_ns", record.t_bound_ns);
    visit("arrival_host_ns", record.arrival_host_ns);
    visit.blob("sample", record.values);
    visit("data_json", record.data_json);
    visit.shown("value", !record.values.empty(), record.values.empty() ? 0 : record.values[0]);
}

}  // namespace opms_host
#endif
