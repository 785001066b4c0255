/* SPDX-License-Identifier: Apache-2.0 */
/* Cameras of OpenCV, judged by OpenCV's own FileStorage, and of Kalibr. */
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include <opencv2/core.hpp>

#include "camera_file.hpp"
#include "camera_file_write.hpp"

namespace {

namespace fs = std::filesystem;
using opms_host::CameraFile;
using opms_host::CameraFormat;

int failures = 0;

void expect(bool good, const char *what, const std::string &detail = "")
{
    if (!good) {
        std::fprintf(stderr, "FAILED: %s %s\n", what, detail.c_str());
        failures++;
    }
}

std::string bytes_of(const fs::path &path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
}

CameraFile parsed(const std::string &text, const std::string &cam = "")
{
    CameraFile file;
    std::string error;
    expect(opms_host::camera_file_parse(text.data(), text.size(), file, error, cam), "is read",
           error);
    return file;
}

std::string refusal_of(const std::string &text, const std::string &cam = "")
{
    CameraFile file;
    std::string error;
    expect(!opms_host::camera_file_parse(text.data(), text.size(), file, error, cam),
           "is refused", text);
    return error;
}

void expect_refused(const std::string &text, const char *word, const std::string &cam = "")
{
    const std::string error = refusal_of(text, cam);
    expect(error.find(word) != std::string::npos, word, error);
}

std::string replaced(std::string text, const std::string &from, const std::string &to)
{
    const std::size_t at = text.find(from);
    expect(at != std::string::npos, "the text to change is there", from);
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/** Numbers without a short decimal form. */
CameraFile some_camera()
{
    std::mt19937_64 random(77);
    std::uniform_real_distribution<double> even(-1.0, 1.0);
    CameraFile file;
    opms_camera_t &camera = file.camera;
    camera.lens = {1024, 768, 585 + even(random), 586 + even(random), 517 + even(random),
                   380 + even(random), 0.1 * even(random), 0.01 * even(random),
                   1e-3 * even(random), 1e-5 * even(random)};
    const double c = std::cos(0.3), s = std::sin(0.3);
    camera.detector_camera = {{c, 0, s, 0, 1, 0, -s, 0, c}, {even(random), even(random), 0.4}};
    for (int i = 0; i < 8; i++) {
        camera.covariance_intrinsics[9 * i] = 1e-4 / 3;
    }
    for (int i = 0; i < 6; i++) {
        camera.covariance_detector_camera[7 * i] = 1e-8 / 7;
    }
    camera.covariance_detector_camera_intrinsics[11] = 1e-7 / 3;
    camera.has_covariance_intrinsics = camera.has_detector_camera = 1;
    camera.has_covariance_detector_camera = camera.has_covariance_detector_camera_intrinsics = 1;
    file.name = "front <left> & \"right\" \\ 'x'";
    file.grid = "a0-25";
    file.footprint = opms_host::Footprint{0.35, 0.1 / 3, -0.2};
    file.residual_rms_px = 0.1 / 3;
    file.date = "2026-01-31T23:59:59Z";
    file.extras.push_back({"T_cam_imu", "T_cam_imu", "[[1.0, 0.5], [0.25, 1.0]]"});
    file.extras.push_back({"rostopic", "rostopic", "\"/cam0/image_raw\""});
    file.opms_extras.push_back({"serial", "serial", "\"007\""});
    return file;
}

std::string extras_text(const CameraFile &file)
{
    std::string text;
    for (const opms_host::CameraExtra &extra : file.extras) {
        text += extra.key + "=" + extra.value + ";";
    }
    for (const opms_host::CameraExtra &extra : file.opms_extras) {
        text += "opms." + extra.key + "=" + extra.value + ";";
    }
    return text;
}

void check_same(const CameraFile &a, const CameraFile &b)
{
    expect(std::memcmp(&a.camera, &b.camera, sizeof a.camera) == 0, "the camera is the same");
    expect(a.name == b.name && a.grid == b.grid && a.date == b.date, "the texts are the same",
           b.name);
    expect(a.residual_rms_px == b.residual_rms_px && b.footprint &&
               a.footprint->y_m == b.footprint->y_m, "the history is the same");
}

void every_format_gives_the_same_bits_back(const fs::path &folder)
{
    const CameraFile file = some_camera();
    for (const CameraFormat format : {CameraFormat::ros, CameraFormat::opencv_yaml,
                                      CameraFormat::opencv_xml, CameraFormat::kalibr}) {
        const std::string path = (folder / "round.any").string();
        std::string error;
        std::vector<std::string> notes;
        expect(opms_host::camera_file_write(path, file, error, format, &notes), "is written",
               error);
        CameraFile again;
        expect(opms_host::camera_file_read(path, again, error), "is read", error);
        expect(again.format == format, "its format is told by its content", error);
        check_same(file, again);
        expect(notes.empty() && extras_text(again) == extras_text(file), "unknown fields survive",
               extras_text(again));
        fs::remove(path);
    }
}

cv::Mat column(const CameraFile &file)
{
    const opms_lens_t &lens = file.camera.lens;
    return (cv::Mat_<double>(5, 1) << lens.k1, lens.k2, lens.p1, lens.p2, 0);
}

cv::Mat matrix(const CameraFile &file)
{
    const opms_lens_t &lens = file.camera.lens;
    return (cv::Mat_<double>(3, 3) << lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0,
            1);
}

bool equal(const cv::Mat &a, const cv::Mat &b)
{
    return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

void opencv_reads_what_is_written(const fs::path &folder)
{
    const CameraFile file = some_camera();
    for (const CameraFormat format : {CameraFormat::opencv_yaml, CameraFormat::opencv_xml}) {
        const bool xml = format == CameraFormat::opencv_xml;
        const std::string path = (folder / (xml ? "ours.xml" : "ours.yml")).string();
        std::string error;
        expect(opms_host::camera_file_write(path, file, error, format), "is written", error);
        cv::FileStorage storage(path, cv::FileStorage::READ);
        cv::Mat k, d;
        storage["camera_matrix"] >> k;
        storage["distortion_coefficients"] >> d;
        expect(equal(k, matrix(file)) && equal(d, column(file)), "OpenCV has the same lens", path);
        expect(static_cast<int>(storage["image_width"]) == 1024, "OpenCV has the width");
        expect(static_cast<std::string>(storage["camera_name"]) == file.name, "and the name",
               static_cast<std::string>(storage["camera_name"]));
        const cv::FileNode t = storage["opms"]["t_detector_camera_m"];
        expect(t.size() == 3 && static_cast<double>(t[1]) == file.camera.detector_camera.t_m[1],
               "and the mounting");
        expect(static_cast<std::string>(storage["opms"]["serial"]) == "007", "and texts as texts");
        expect(static_cast<double>(storage["T_cam_imu"][1][0]) == 0.25, "and lists of lists");
    }
}

/** As OpenCV's calibration sample writes it. */
void opencv_writes(const std::string &path, const cv::Mat &distortion, bool older)
{
    cv::FileStorage storage(path, cv::FileStorage::WRITE);
    storage << "calibration_time" << "Sun 31 Jan 2026 23:59:59 UTC" << "nframes" << 12;
    storage << (older ? "image_Width" : "image_width") << 1024;
    storage << (older ? "image_Height" : "image_height") << 768;
    storage.writeComment("flags: +fix_k3", false);
    storage << "flags" << 128;
    storage << (older ? "Camera_Matrix" : "camera_matrix") << matrix(some_camera());
    storage << (older ? "Distortion_Coefficients" : "distortion_coefficients") << distortion;
    storage << "avg_reprojection_error" << 0.1 / 3;
    storage << "extrinsic_parameters" << cv::Mat::eye(2, 6, CV_64F);
}

void what_opencv_writes_is_read(const fs::path &folder)
{
    for (const char *name : {"theirs.yml", "theirs.xml"}) {
        for (const bool older : {false, true}) {
            const std::string path = (folder / name).string();
            const CameraFile file = some_camera();
            opencv_writes(path, column(file), older);
            const CameraFile again = parsed(bytes_of(path));
            expect(std::memcmp(&again.camera.lens, &file.camera.lens, sizeof file.camera.lens) == 0,
                   "the lens is OpenCV's", path);
            expect(extras_text(again).find("extrinsic_parameters={rows: 2, cols: 6, dt:") !=
                       std::string::npos, "the rest is kept", extras_text(again));
        }
    }
}

/** Each coefficient that the camera file has no place for is named; zeros are none. */
void a_coefficient_too_many_is_named(const fs::path &folder)
{
    const char *const names[14] = {"k1", "k2", "p1", "p2", "k3", "k4", "k5",
                                   "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"};
    for (const int count : {4, 5, 8, 12, 14}) {
        const std::string path = (folder / "many.yml").string();
        cv::Mat d = cv::Mat::zeros(1, count, CV_64F);
        d.at<double>(0) = -0.1;
        opencv_writes(path, d, false);
        expect(parsed(bytes_of(path)).camera.lens.k1 == -0.1, "zeros are accepted");
        if (count > 4) {
            d.at<double>(count - 1) = 0.01;
            opencv_writes(path, d, false);
            const std::string word = std::string("has ") + names[count - 1] + " other than 0";
            expect_refused(bytes_of(path), word.c_str());
        }
    }
    const std::string theirs = bytes_of(folder / "theirs.yml");
    expect_refused(replaced(theirs, "nframes:", "fisheye_model: 1\nnframes:"), "fisheye");
}

constexpr const char *CHAIN = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.118, 0.031, 0.0011, -0.0007]
  distortion_model: radtan
  intrinsics: [585.0, 586.0, 517.3, 379.6]
  resolution: [1024, 768]
  rostopic: /cam0/image_raw
  T_cam_imu:
  - [1.0, 0.0, 0.0, 0.25]
  - [0.0, 1.0, 0.0, 0.5]
  - [0.0, 0.0, 1.0, 0.75]
  - [0.0, 0.0, 0.0, 1.0]
)";

void a_chain_of_kalibr_is_read_and_all_of_it_kept(const fs::path &folder)
{
    const CameraFile file = parsed(CHAIN);
    const opms_lens_t &lens = file.camera.lens;
    expect(lens.width_px == 1024 && lens.fx_px == 585 && lens.fy_px == 586 && lens.cx_px == 517.3 &&
               lens.cy_px == 379.6 && lens.k2 == 0.031 && lens.p1 == 0.0011 && lens.p2 == -0.0007,
           "the lens is Kalibr's");
    expect(file.name == "cam0" && file.format == CameraFormat::kalibr, "so is its name");
    const std::string path = (folder / "chain.yaml").string();
    std::string error;
    for (const CameraFormat format : {CameraFormat::opencv_xml, CameraFormat::kalibr}) {
        expect(opms_host::camera_file_write(path, file, error, format), "is written", error);
        expect(bytes_of(path).find(format == CameraFormat::kalibr
                                       ? "T_cam_imu: [[1.0, 0.0, 0.0, 0.25]"
                                       : "<T_cam_imu>") != std::string::npos,
               "the transform is kept", bytes_of(path));
        fs::remove(path);
    }
}

void one_of_several_cameras_must_be_chosen()
{
    const std::string two =
        CHAIN + replaced(replaced(CHAIN, "cam0:", "cam1:"), "[585.0,", "[400.0,");
    expect_refused(two, "holds 2 cameras (cam0, cam1)");
    expect(parsed(two, "cam1").camera.lens.fx_px == 400, "the one that was asked for");
    expect_refused(two, "holds no camera 'cam2', but cam0, cam1", "cam2");
    expect_refused(bytes_of("/dev/null"), "is not a camera file");
}

void other_models_of_kalibr_are_refused_by_name()
{
    expect_refused(replaced(CHAIN, "radtan", "equidistant"), "equidistant");
    expect_refused(replaced(CHAIN, "pinhole", "omni"), "omni");
    expect_refused(replaced(CHAIN, "[1024, 768]", "[1024]"), "cam0.resolution has 1 numbers");
    expect_refused(replaced(CHAIN, "[1024, 768]", "[1024, 76.5]"), "whole numbers");
    expect_refused(replaced(CHAIN, "[585.0,", "[0.0,"), "focal length");
    expect(parsed(replaced(replaced(CHAIN, "radtan", "none"), "[-0.118, 0.031, 0.0011, -0.0007]",
                           "[]")).camera.lens.k1 == 0, "no distortion is none");
}

void broken_xml_says_what_and_where(const fs::path &folder)
{
    const std::string good = bytes_of(folder / "theirs.xml");
    expect_refused(good.substr(0, good.size() / 2), "line ");
    expect_refused(replaced(good, "</opencv_storage>", "</storage>"), "closed by another name");
    expect_refused(replaced(good, "<nframes>12", "<nframes>&twelve;"), "&twelve;");
    expect_refused(replaced(good, "<opencv_storage>", "<!DOCTYPE a [<!ENTITY b \"c\">]>"),
                   "document types");
    expect_refused("<?xml version=\"1.0\"?><svg></svg>", "not OpenCV's <opencv_storage>");
    std::string deep = "<opencv_storage>";
    for (int i = 0; i < 5000; i++) {
        deep += "<a>";
    }
    expect_refused(deep, "nested too deeply");
}

}  // namespace

int main()
{
    const fs::path folder =
        fs::temp_directory_path() / ("opms-formats-" + std::to_string(std::random_device{}()));
    fs::create_directory(folder);
    every_format_gives_the_same_bits_back(folder);
    opencv_reads_what_is_written(folder);
    what_opencv_writes_is_read(folder);
    a_coefficient_too_many_is_named(folder);
    a_chain_of_kalibr_is_read_and_all_of_it_kept(folder);
    one_of_several_cameras_must_be_chosen();
    other_models_of_kalibr_are_refused_by_name();
    broken_xml_says_what_and_where(folder);
    fs::remove_all(folder);
    return failures == 0 ? 0 : 1;
}
