/* SPDX-License-Identifier: Apache-2.0 */
/* NAME.png and NAME.json in the form of the project's pictures with truth, the poses in place of
 * the truth; camera.yaml; poses.json, the list. Filled aside, then renamed. */
#include "export_scan.hpp"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "camera_file.hpp"
#include "export_picture.hpp"
#include "json_values.hpp"
#include "location_json.hpp"
#include "pose_values.hpp"
#include "scan_json.hpp"
#include "scan_times.hpp"

namespace opms_host {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double DEG = 180 / 3.14159265358979323846;

/** A folder that gets its name when it is complete. */
class FolderAside {
public:
    ~FolderAside()
    {
        if (!aside_.empty()) {
            std::error_code ignored;
            fs::remove_all(aside_, ignored);
        }
    }

    bool open(const std::string &path, std::string &error)
    {
        std::error_code code;
        path_ = fs::absolute(path, code).lexically_normal();
        if (!path_.has_filename()) {
            path_ = path_.parent_path();
        }
        const bool is_free = !fs::exists(path_, code) ||
                             (fs::is_directory(path_, code) && fs::is_empty(path_, code));
        if (!is_free) {
            error = path + ": is there already and is no empty folder";
            return false;
        }
        const std::string pattern = path_.string() + ".part-XXXXXX";
        std::vector<char> name(pattern.begin(), pattern.end());
        name.push_back('\0');
        if (::mkdtemp(name.data()) == nullptr) {
            error = path + ": " + std::strerror(errno);
            return false;
        }
        aside_ = name.data();
        fs::permissions(aside_, fs::perms::group_read | fs::perms::group_exec |
                                    fs::perms::others_read | fs::perms::others_exec,
                        fs::perm_options::add, code);
        return true;
    }

    bool write(const std::string &name, const std::string &bytes, std::string &error)
    {
        const fs::path path = aside_ / name;
        std::ofstream file(path, std::ios::binary);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (!file) {
            error = (path_ / name).string() + ": " + std::strerror(errno) +
                    "; nothing of the folder was kept";
        }
        return static_cast<bool>(file);
    }

    bool finish(std::string &error)
    {
        std::error_code code;
        sync();
        fs::rename(aside_, path_, code); /* replaces an empty folder */
        if (code) {
            error = path_.string() + ": " + code.message();
            return false;
        }
        aside_.clear();
        return true;
    }

private:
    /** All files at once: one by one would take a disk's turn for each picture. */
    void sync() const
    {
        const int descriptor = ::open(aside_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (descriptor >= 0) {
            ::syncfs(descriptor);
            ::close(descriptor);
        }
    }

    fs::path path_, aside_;
};

Json lens_json(const opms_lens_t &lens)
{
    return {{"fx", lens.fx_px}, {"fy", lens.fy_px}, {"cx", lens.cx_px}, {"cy", lens.cy_px},
            {"k1", lens.k1},    {"k2", lens.k2},    {"p1", lens.p1},    {"p2", lens.p2}};
}

void add_transform(Json &row, const std::string &name, const opms_transform_t &transform)
{
    row["R_" + name] = json_matrix(transform.R, 3, 3);
    row["t_" + name + "_m"] = json_vector(transform.t_m, 3);
}

/** R_ground_bar = Ry(-tilt). */
Json ground_bar(double tilt_rad)
{
    const double c = std::cos(tilt_rad), s = std::sin(tilt_rad);
    const double R[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
    return json_matrix(R, 3, 3);
}

std::string picture_name(std::uint64_t number)
{
    char name[40];
    std::snprintf(name, sizeof name, "picture_%06llu", static_cast<unsigned long long>(number));
    return name;
}

class PicturesExport {
public:
    PicturesExport(ScanReader &scan, ExportReport &report, FolderAside &folder)
        : scan_(scan), header_(scan.summary().header), report_(report), folder_(folder),
          times_(header_)
    {
    }

    bool run(std::string &error)
    {
        const std::string &text = header_.camera_file_text;
        CameraFile file;
        std::string why;
        if (!text.empty()) {
            if (!folder_.write("camera.yaml", text, error)) {
                return false;
            }
            if (camera_file_parse(text.data(), text.size(), file, why)) {
                camera_ = file.camera;
            }
        }
        return take_paths(error) && write_with_poses(error) && write_others(error) &&
               folder_.write("poses.json", list_.dump(1) + "\n", error);
    }

private:
    bool take_paths(std::string &error)
    {
        return scan_.each_picture(
            [this](const PictureRow &picture) {
                paths_[picture.number] = picture.path;
                return true;
            },
            error);
    }

    /** @return Whether it could be used; else it is among the problems. False with @p error where
     * it cannot be written. */
    bool write_picture(std::uint64_t number, const std::string &path, bool &usable,
                       std::string &error)
    {
        std::string png, why;
        usable = export_picture_png(path, header_.width_px, header_.height_px, png, why);
        if (!usable) {
            report_.problems.push_back(why);
            return true;
        }
        report_.pictures++;
        return folder_.write(picture_name(number) + ".png", png, error);
    }

    /** The pose in the form of a truth file, so that what reads those reads this. */
    Json pose_file(const PoseRecord &pose) const
    {
        const opms_location_t &location = pose.location;
        Json row = {{"kind", "bar"}, {"image", {header_.width_px, header_.height_px}}};
        if (camera_) {
            row["camera"] = lens_json(camera_->lens);
        }
        row["bar"] = header_.bar;
        row["bar_tilt_deg"] = header_.bar_tilt_rad * DEG;
        row["R_ground_bar"] = ground_bar(header_.bar_tilt_rad);
        add_transform(row, "bar_camera", location.pose.bar_camera.transform);
        if (camera_ && camera_->has_detector_camera) {
            add_transform(row, "detector_camera", camera_->detector_camera);
        }
        if (location.has_ground_detector) {
            add_transform(row, "ground_detector", location.ground_detector.transform);
        }
        row["scan"] = list_row(pose);
        return row;
    }

    Json list_row(const PoseRecord &pose) const
    {
        Json row = pose_json(pose);
        row["image"] = picture_name(pose.number) + ".png";
        row["t_utc_s"] = static_cast<double>(times_.wall_ns(pose)) * 1e-9;
        return row;
    }

    bool write_pose(const PoseRecord &pose, const std::string &path, std::string &error)
    {
        bool usable = false;
        if (!write_picture(pose.number, path, usable, error) || !usable) {
            return error.empty();
        }
        list_.push_back(list_row(pose));
        report_.poses++;
        return pose.location.state != OPMS_BAR_LOCATED ||
               folder_.write(picture_name(pose.number) + ".json", pose_file(pose).dump(1) + "\n",
                             error);
    }

    bool write_with_poses(std::string &error)
    {
        std::string failed;
        const bool read = scan_.each_pose(
            [&](const PoseRecord &pose) {
                const auto place = paths_.find(pose.number);
                if (place == paths_.end()) {
                    return true;
                }
                const std::string path = place->second;
                paths_.erase(place);
                return write_pose(pose, path, failed);
            },
            error);
        error = failed.empty() ? error : failed;
        return read && failed.empty();
    }

    /** Pictures without a pose. */
    bool write_others(std::string &error)
    {
        for (const auto &[number, path] : paths_) {
            bool usable = false;
            if (!write_picture(number, path, usable, error)) {
                return false;
            }
            if (usable) {
                list_.push_back({{"image", picture_name(number) + ".png"}, {"picture", number}});
            }
        }
        return true;
    }

    ScanReader &scan_;
    const ScanHeader &header_;
    ExportReport &report_;
    FolderAside &folder_;
    ScanTimes times_;
    std::optional<opms_camera_t> camera_;
    std::map<std::uint64_t, std::string> paths_;
    Json list_ = Json::array();
};

}  // namespace

bool export_pictures(ScanReader &scan, const ExportRequest &request, ExportReport &report,
                     std::string &error)
{
    FolderAside folder;
    if (!folder.open(request.out, error) || !PicturesExport(scan, report, folder).run(error) ||
        !folder.finish(error)) {
        return false;
    }
    report.files.push_back(request.out);
    return true;
}

}  // namespace opms_host
