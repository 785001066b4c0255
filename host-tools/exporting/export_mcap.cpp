/* SPDX-License-Identifier: Apache-2.0 */
/* Topics: docs/export.md. Events, samples and pictures are woven among the poses by their times, so
 * that a player reads the file from front to back. */
#include "export_scan.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include <opms/version.h>

#include "camera_file.hpp"
#include "export_picture.hpp"
#include "foxglove_messages.hpp"
#include "foxglove_schemas.hpp"
#include "location_json.hpp"
#include "mcap_writer.hpp"
#include "scan_json.hpp"
#include "scan_times.hpp"

namespace opms_host {

namespace {

struct TimedMessage {
    std::uint64_t t_ns = 0;
    std::uint16_t channel = 0;
    std::string json;
};

class McapExport {
public:
    McapExport(ScanReader &scan, const ExportRequest &request, ExportReport &report,
               OutputFile &file)
        : scan_(scan), request_(request), report_(report), file_(file),
          times_(scan.summary().header),
          writer_(file, std::string("opms ") + opms_version())
    {
    }

    bool run(std::string &error)
    {
        take_camera();
        write_head();
        if (!learn_times(error) || !take_events(error) || !take_samples(error) ||
            (request_.with_pictures && !take_picture_paths(error))) {
            return false;
        }
        std::stable_sort(beside_.begin(), beside_.end(),
                         [](const TimedMessage &a, const TimedMessage &b) {
                             return a.t_ns < b.t_ns;
                         });
        if (!write_poses(error) || !write_other_pictures(error)) {
            return false;
        }
        write_beside(UINT64_MAX);
        writer_.finish();
        return true;
    }

private:
    void take_camera()
    {
        const std::string &text = scan_.summary().header.camera_file_text;
        CameraFile file;
        std::string why;
        if (!text.empty() && camera_file_parse(text.data(), text.size(), file, why)) {
            camera_ = file.camera;
        }
    }

    void write_head()
    {
        const ScanHeader &header = scan_.summary().header;
        const std::uint64_t begun_ns = times_.wall_ns(header.begun_host_ns);
        writer_.metadata("opms.scan", {{"name", header.name},
                                       {"mode", header.mode},
                                       {"begun", wall_time_text(header.begun_wall_ns)},
                                       {"box", header.box_name},
                                       {"source", header.source_name},
                                       {"source_model", header.source_model},
                                       {"bar", header.bar},
                                       {"versions", header.versions_json},
                                       {"settings", header.settings_json}});
        if (!header.camera_file_text.empty()) {
            writer_.attachment(
                header.camera_file_name.empty() ? "camera.yaml" : header.camera_file_name,
                "application/yaml", begun_ns, header.camera_file_text);
        }
        if (!camera_) {
            return;
        }
        beside_.push_back({begun_ns, channel("/camera/calibration", schema_camera_calibration()),
                           message_camera_calibration(begun_ns, camera_->lens)});
        if (camera_->has_detector_camera) {
            beside_.push_back({begun_ns, transform_channel(),
                               message_frame_transform(begun_ns, "detector", "camera",
                                                       camera_->detector_camera)});
        }
    }

    std::uint16_t channel(const std::string &topic, const McapSchema &schema)
    {
        const auto known = channels_.find(topic);
        if (known != channels_.end()) {
            return known->second;
        }
        return channels_[topic] = writer_.add_channel(topic, schema);
    }

    std::uint16_t transform_channel() { return channel("/tf", schema_frame_transform()); }

    bool learn_times(std::string &error)
    {
        return scan_.each_pose(
            [this](const PoseRecord &pose) {
                times_.learn(pose);
                return true;
            },
            error);
    }

    bool take_events(std::string &error)
    {
        return scan_.each_event(
            [this](const EventRecord &event) {
                const std::uint64_t t_ns = times_.wall_ns(event.t_host_ns);
                beside_.push_back(
                    {t_ns, channel("/opms/events", schema_log()), message_log(t_ns, event)});
                report_.events++;
                return true;
            },
            error);
    }

    bool take_samples(std::string &error)
    {
        return scan_.each_sensor(
            [this](const SensorRecord &sample) {
                const std::uint64_t t_ns = times_.wall_ns(sample);
                beside_.push_back({t_ns,
                                   channel("/sensors/" + sample.sensor, schema_opms_sensor()),
                                   message_sensor(t_ns, sample)});
                report_.sensor_samples++;
                return true;
            },
            error);
    }

    bool take_picture_paths(std::string &error)
    {
        return scan_.each_picture(
            [this](const PictureRow &picture) {
                pictures_[picture.number] = picture.path;
                return true;
            },
            error);
    }

    void write_beside(std::uint64_t until_ns)
    {
        while (beside_written_ < beside_.size() && beside_[beside_written_].t_ns <= until_ns) {
            TimedMessage &message = beside_[beside_written_++];
            writer_.message(message.channel, message.t_ns, message.json);
            message.json = std::string();
        }
    }

    void write_picture(std::uint64_t number, std::uint64_t t_ns)
    {
        const auto place = pictures_.find(number);
        if (place == pictures_.end()) {
            return;
        }
        const std::string path = place->second;
        pictures_.erase(place);
        const ScanHeader &header = scan_.summary().header;
        std::string png, why;
        if (!export_picture_png(path, header.width_px, header.height_px, png, why)) {
            report_.problems.push_back(why);
            return;
        }
        writer_.message(channel("/camera/image", schema_compressed_image()), t_ns,
                        message_compressed_image(t_ns, png));
        report_.pictures++;
    }

    /** The pose where the detector is known, else that of the camera over the bar. */
    void write_transforms(const PoseRecord &pose, std::uint64_t t_ns)
    {
        const opms_location_t &location = pose.location;
        if (location.state != OPMS_BAR_LOCATED) {
            return;
        }
        const bool of_detector = location.has_ground_detector != 0;
        const char *parent = of_detector ? "ground" : "bar";
        const char *child = of_detector ? "detector" : "camera";
        const opms_transform_t &transform =
            of_detector ? location.ground_detector.transform : location.pose.bar_camera.transform;
        writer_.message(channel(std::string("/opms/") + child, schema_pose_in_frame()), t_ns,
                        message_pose_in_frame(t_ns, parent, transform));
        writer_.message(transform_channel(), t_ns,
                        message_frame_transform(t_ns, parent, child, transform));
    }

    bool write_poses(std::string &error)
    {
        return scan_.each_pose(
            [this](const PoseRecord &pose) {
                const std::uint64_t t_ns = times_.wall_ns(pose);
                write_beside(t_ns);
                write_picture(pose.number, t_ns);
                writer_.message(channel("/opms/pose", schema_opms_pose()), t_ns,
                                json_line(pose_json(pose)));
                write_transforms(pose, t_ns);
                report_.poses++;
                return !file_.failed();
            },
            error);
    }

    /** Those without a pose: of a scan that took pictures only, or that was cut off. */
    bool write_other_pictures(std::string &error)
    {
        return pictures_.empty() ||
               scan_.each_frame(
                   [this](const FrameRecord &frame) {
                       write_picture(frame.number, times_.wall_ns(frame.arrival_host_ns));
                       return !file_.failed();
                   },
                   error);
    }

    ScanReader &scan_;
    const ExportRequest &request_;
    ExportReport &report_;
    OutputFile &file_;
    ScanTimes times_;
    McapWriter writer_;
    std::optional<opms_camera_t> camera_;
    std::map<std::string, std::uint16_t> channels_;
    std::map<std::uint64_t, std::string> pictures_;
    std::vector<TimedMessage> beside_; /**< events, samples, and what is said once */
    std::size_t beside_written_ = 0;
};

}  // namespace

bool export_mcap(ScanReader &scan, const ExportRequest &request, ExportReport &report,
                 std::string &error)
{
    const auto file = OutputFile::open(request.out, request.may_replace, error);
    if (!file || !McapExport(scan, request, report, *file).run(error) || !file->finish(error)) {
        return false;
    }
    report.files.push_back(request.out);
    return true;
}

}  // namespace opms_host
