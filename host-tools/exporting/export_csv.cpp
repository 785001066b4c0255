/* SPDX-License-Identifier: Apache-2.0 */
#include "export_scan.hpp"

#include <algorithm>
#include <filesystem>

#include "csv_row.hpp"
#include "location_json.hpp"
#include "output_file.hpp"
#include "pose_track.hpp"
#include "scan_json.hpp"
#include "scan_times.hpp"

namespace opms_host {

namespace {

/* Position, quaternion, angles, sigmas. */
constexpr std::size_t POSE_FIELDS = 3 + 4 + 3 + 3 + 3;

const std::vector<std::string> POSE_NAMES = {
    "x_mm",          "y_mm",          "z_mm",          "qx",           "qy",           "qz",
    "qw",            "psi_deg",       "phi_deg",       "theta_deg",    "sigma_x_mm",
    "sigma_y_mm",    "sigma_z_mm",    "sigma_rx_deg",  "sigma_ry_deg", "sigma_rz_deg"};

std::string poses_heading()
{
    std::vector<std::string> names = {"picture",   "t_scan_s", "mid_exposure", "t_utc_s",
                                      "frame_id",  "trigger",  "pair",         "state",
                                      "pose_of"};
    names.insert(names.end(), POSE_NAMES.begin(), POSE_NAMES.end());
    const std::vector<std::string> last = {"squares", "edge_shift_px", "residual_px", "blur"};
    names.insert(names.end(), last.begin(), last.end());
    return csv_heading(names);
}

void add_pose(CsvRow &row, const double t_m[3], const Quaternion &q, const PoseSigmas &sigmas)
{
    double R[9];
    quaternion_to_matrix(q, R);
    for (int i = 0; i < 3; i++) {
        row.number(1e3 * t_m[i]);
    }
    row.number(q.x).number(q.y).number(q.z).number(q.w);
    for (const double angle : angles_deg_from_matrix(R)) {
        row.number(angle);
    }
    for (const double sigma : sigmas.position_mm) {
        row.number(sigma);
    }
    for (const double sigma : sigmas.rotation_deg) {
        row.number(sigma);
    }
}

const char *blur_name(BlurVerdict verdict)
{
    return verdict == BlurVerdict::unknown ? "" : blur_verdict_name(verdict);
}

/** Frame ids by the pictures' numbers, which rise by one. */
class FrameIds {
public:
    void add(const FrameRecord &frame)
    {
        if (ids_.size() < frame.number) {
            ids_.resize(frame.number);
        }
        ids_[frame.number - 1] = {frame.frame_id, (frame.flags & OPMS_FRAME_NO_ID) == 0};
    }
    void write(CsvRow &row, std::uint64_t number) const
    {
        if (number == 0 || number > ids_.size() || !ids_[number - 1].second) {
            row.empty();
        } else {
            row.integer(ids_[number - 1].first);
        }
    }

private:
    std::vector<std::pair<std::uint64_t, bool>> ids_;
};

std::string pose_line(const PoseRecord &pose, const ScanTimes &times, const FrameIds &ids)
{
    CsvRow row;
    row.integer(pose.number);
    pose.has_time ? row.seconds(pose.t_scan_ns) : row.empty();
    row.integer(pose.has_time && pose.is_mid_exposure ? 1 : 0);
    row.seconds(static_cast<std::int64_t>(times.wall_ns(pose)));
    ids.write(row, pose.number);
    pose.trigger_number > 0 ? row.integer(pose.trigger_number) : row.empty();
    row.text(opms_frame_state_name(pose.frame_state)).text(json_bar_state(pose.location.state));
    if (pose.location.state != OPMS_BAR_LOCATED) {
        row.empty(1 + POSE_FIELDS).integer(pose.location.bar.square_count).empty(2);
        return row.text(blur_name(pose.blur)).line();
    }
    const opms_pose_t &from = pose_of(pose.location);
    row.text(pose.location.has_ground_detector ? "detector in ground" : "camera in bar");
    add_pose(row, from.transform.t_m, quaternion_from_matrix(from.transform.R),
             pose_sigmas(from));
    row.integer(pose.location.bar.square_count);
    row.number(pose.location.pose.edge_shift_px).number(pose.location.pose.residual_px);
    return row.text(blur_name(pose.blur)).line();
}

std::string sensors_heading(std::size_t values)
{
    std::vector<std::string> names = {"sensor", "number", "t_scan_s", "t_bound_s", "t_utc_s"};
    names.insert(names.end(), POSE_NAMES.begin(), POSE_NAMES.end());
    names.push_back("pose_gap_s");
    for (std::size_t i = 0; i < values; i++) {
        names.push_back("value_" + std::to_string(i));
    }
    names.push_back("data");
    return csv_heading(names);
}

std::string sensor_line(const SensorRecord &sample, std::size_t values, const ScanTimes &times,
                        PoseTrack &track, std::int64_t most_gap_ns)
{
    CsvRow row;
    row.text(sample.sensor);
    sample.number > 0 ? row.integer(sample.number) : row.empty();
    sample.has_time ? row.seconds(sample.t_scan_ns) : row.empty();
    sample.t_bound_ns > 0 ? row.seconds(sample.t_bound_ns) : row.empty();
    row.seconds(static_cast<std::int64_t>(times.wall_ns(sample)));
    TrackPose pose;
    if (sample.has_time && track.at(sample.t_scan_ns, most_gap_ns, pose)) {
        add_pose(row, pose.t_m, pose.rotation, pose.sigmas);
        row.seconds(pose.gap_ns);
    } else {
        row.empty(POSE_FIELDS + 1);
    }
    for (const double value : sample.values) {
        row.number(value);
    }
    row.empty(values - sample.values.size());
    return row.text(sample.data_json).line();
}

bool write_poses(ScanReader &scan, OutputFile &file, ScanTimes &times, PoseTrack &track,
                 ExportReport &report, std::string &error)
{
    FrameIds ids;
    if (!scan.each_frame(
            [&](const FrameRecord &frame) {
                ids.add(frame);
                return true;
            },
            error)) {
        return false;
    }
    file.write(poses_heading());
    return scan.each_pose(
        [&](const PoseRecord &pose) {
            times.learn(pose);
            track.add(pose);
            file.write(pose_line(pose, times, ids));
            report.poses++;
            return !file.failed();
        },
        error);
}

bool write_sensors(ScanReader &scan, const ExportRequest &request, const ScanTimes &times,
                   PoseTrack &track, ExportReport &report, OutputFile &file, std::string &error)
{
    std::size_t values = 0;
    if (!scan.each_sensor(
            [&](const SensorRecord &sample) {
                values = std::max(values, sample.values.size());
                return true;
            },
            error)) {
        return false;
    }
    file.write(sensors_heading(values));
    return scan.each_sensor(
        [&](const SensorRecord &sample) {
            file.write(sensor_line(sample, values, times, track, request.most_gap_ns));
            report.sensor_samples++;
            return !file.failed();
        },
        error);
}

}  // namespace

std::string export_csv_sensors_path(const std::string &out)
{
    std::filesystem::path path(out);
    const std::string extension = path.extension().string();
    return path.replace_filename(path.stem().string() + "-sensors" + extension).string();
}

bool export_csv(ScanReader &scan, const ExportRequest &request, ExportReport &report,
                std::string &error)
{
    ScanTimes times(scan.summary().header);
    PoseTrack track;
    const auto poses = OutputFile::open(request.out, request.may_replace, error);
    if (!poses || !write_poses(scan, *poses, times, track, report, error)) {
        return false;
    }
    std::unique_ptr<OutputFile> sensors;
    const std::string sensors_path = export_csv_sensors_path(request.out);
    if (scan.summary().sensor_samples > 0) {
        sensors = OutputFile::open(sensors_path, request.may_replace, error);
        if (!sensors ||
            !write_sensors(scan, request, times, track, report, *sensors, error)) {
            return false;
        }
    }
    if (!poses->seal(error) || (sensors && !sensors->finish(error)) || !poses->finish(error)) {
        return false;
    }
    report.files.push_back(request.out);
    if (sensors) {
        report.files.push_back(sensors_path);
    }
    return true;
}

}  // namespace opms_host
