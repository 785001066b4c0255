/* SPDX-License-Identifier: Apache-2.0 */
/* The library says how far the pictures are from what the file states; here is what that means. */
#include "calibrate_check.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate_points.hpp"
#include "text_table.hpp"

namespace {

using opms_host::CameraFile;

/* A lens is only called good by pictures that would have shown this much. */
constexpr double SHARP_FOCAL = 0.005, SHARP_CENTRE_PARTS = 0.005;
/* Nodes this much worse than at the calibration are no witnesses for a lens. */
constexpr double NOISE_MANY = 4, NOISE_LEAST_PX = 0.1;
/* Standard deviations of a lens: relative focal length, centre in parts of the width, k1, k2, p. */
struct LensSigmas {
    double focal, centre_parts, k1, k2, p;
};
/* What warmth and the sheet's paper do is no one's touch, and no position suffers from it. */
constexpr LensSigmas BREATHING = {0.0002, 0.0001, 0.0003, 0.0003, 0.00003};
/* Of a lens from elsewhere, without a covariance: what a careful calibration reaches. */
constexpr LensSigmas ASSUMED = {0.0007, 0.0007, 0.003, 0.01, 0.0003};
/* How level and how high the head stands on a flat sheet, each time that it is laid there. */
constexpr double LEVEL_SIGMA_RAD = 0.0009, HEIGHT_SIGMA_M = 0.0002;
constexpr uint32_t PICTURES_ALONE = 3;
constexpr double DEG = 180 / 3.14159265358979323846, MM_PER_M = 1e3;

void conclude(CheckResult &result, CheckVerdict verdict, const std::string &reason,
              const std::string &advice)
{
    result.verdict = verdict;
    result.reason = reason;
    result.advice = advice;
}

bool check_pictures(const CameraFile &file, CheckResult &result)
{
    const opms_lens_t &lens = file.camera.lens;
    std::size_t usable = 0;
    for (const CalibratePicture &picture : result.pictures) {
        const GridPicture &grid = picture.grid;
        if (!grid.reason.empty()) {
            conclude(result, CheckVerdict::bad_pictures, grid.image + ": " + grid.reason, "");
            return false;
        }
        if (grid.width_px != lens.width_px || grid.height_px != lens.height_px) {
            conclude(result, CheckVerdict::bad_pictures,
                     grid.image + text_format(": is %d x %d px, but the camera file is for %d x %d",
                                              static_cast<int>(grid.width_px),
                                              static_cast<int>(grid.height_px),
                                              static_cast<int>(lens.width_px),
                                              static_cast<int>(lens.height_px)), "");
            return false;
        }
        usable += picture.left_out.empty() ? 1 : 0;
    }
    if (usable == 0) {
        conclude(result, CheckVerdict::bad_pictures, "no picture can be used: " +
                 result.pictures.front().grid.image + ": " + result.pictures.front().left_out,
                 "Take one with the grid and its marker in sight.");
    }
    return usable != 0;
}

CalibratorHandle add_pictures(const CameraFile &file, CheckResult &result)
{
    opms_calib_options_t options;
    opms_calib_options_init(&options);
    options.width_px = file.camera.lens.width_px;
    options.height_px = file.camera.lens.height_px;
    options.pictures_max =
        std::max(PICTURES_ALONE, static_cast<uint32_t>(result.pictures.size()));
    opms_calibrator_t *made = nullptr;
    opms_error_t error = {};
    if (opms_calibrator_create(&options, &made, &error) != OPMS_OK) {
        conclude(result, CheckVerdict::bad_pictures, error.message, "");
        return nullptr;
    }
    CalibratorHandle calibrator(made);
    for (CalibratePicture &picture : result.pictures) {
        if (!picture.left_out.empty()) {
            continue;
        }
        const std::vector<opms_calib_point_t> points = calibrate_points(picture.grid);
        uint32_t index = 0;
        if (opms_calibrator_add(made, points.data(), static_cast<uint32_t>(points.size()), &index,
                                &error) == OPMS_OK) {
            picture.index = index;
        } else {
            picture.left_out = error.message;
        }
    }
    return calibrator;
}

/** Footprints whose pictures can be used, in the order of result.mountings. */
std::vector<opms_footprint_t> usable_footprints(const CalibrateJob &job, CheckResult &result,
                                                const CalibrateTalk &talk)
{
    std::vector<opms_footprint_t> usable;
    for (const FootprintPlace &place : job.footprints) {
        const auto found =
            std::find_if(result.pictures.begin(), result.pictures.end(),
                         [&](const CalibratePicture &p) { return p.grid.image == place.image; });
        if (found == result.pictures.end() || !found->used()) {
            talk(place.image + ": is not used, so its footprint does not count");
            continue;
        }
        usable.push_back({*found->index, place.x_m, place.y_m, place.yaw_rad,
                          job.footprint_sigma_m, job.footprint_sigma_rad});
        result.mountings.push_back({place.image, {}});
    }
    return usable;
}

void add_lens_sigmas(const LensSigmas &by, opms_camera_t &camera)
{
    const double centre = by.centre_parts * camera.lens.width_px;
    const double sigmas[8] = {by.focal * camera.lens.fx_px, by.focal * camera.lens.fy_px, centre,
                              centre, by.k1, by.k2, by.p, by.p};
    for (int i = 0; i < 8; i++) {
        camera.covariance_intrinsics[9 * i] += sigmas[i] * sigmas[i];
    }
}

/** Add the outer product of a direction of (w, d) with itself. */
void add_direction(const double (&direction)[6], double sigma, opms_camera_t &camera)
{
    for (int i = 0; i < 36; i++) {
        camera.covariance_detector_camera[i] +=
            sigma * sigma * direction[i / 6] * direction[i % 6];
    }
}

/** The head leaned about X and about Y, and stood higher, at the calibration and stands so now: a
 * lean e turns the camera by -R^T e and moves it by t x e. */
void add_standing(opms_camera_t &camera)
{
    const double twice = std::sqrt(2.0);
    const double *const R = camera.detector_camera.R, *const t = camera.detector_camera.t_m;
    const double about_x[6] = {-R[0], -R[1], -R[2], 0, t[2], -t[1]};
    const double about_y[6] = {-R[3], -R[4], -R[5], -t[2], 0, t[0]};
    const double up[6] = {0, 0, 0, 0, 0, 1};
    add_direction(about_x, twice * LEVEL_SIGMA_RAD, camera);
    add_direction(about_y, twice * LEVEL_SIGMA_RAD, camera);
    add_direction(up, twice * HEIGHT_SIGMA_M, camera);
    camera.has_covariance_detector_camera = 1;
}

/** The file's camera with what may differ though nothing was touched, and with an assumed
 * covariance of its lens where it states none. */
opms_camera_t stated_camera(const CameraFile &file, CheckResult &result)
{
    opms_camera_t camera = file.camera;
    result.lens_assumed = !camera.has_covariance_intrinsics;
    add_lens_sigmas(result.lens_assumed ? ASSUMED : BREATHING, camera);
    camera.has_covariance_intrinsics = 1;
    if (camera.has_detector_camera) {
        add_standing(camera);
    }
    return camera;
}

bool ask(opms_calibrator_t *calibrator, const CameraFile &file, const CalibrateJob &job,
         CheckResult &result, const CalibrateTalk &talk)
{
    const opms_camera_t camera = stated_camera(file, result);
    const std::vector<opms_footprint_t> footprints = usable_footprints(job, result, talk);
    std::vector<opms_calib_mounting_check_t> mountings(footprints.size());
    opms_error_t error = {};
    if (opms_calibrator_check(calibrator, &camera, footprints.data(),
                              static_cast<uint32_t>(footprints.size()), &result.lens,
                              mountings.data(), &error) != OPMS_OK) {
        conclude(result, CheckVerdict::cannot_tell, error.message,
                 "Is this a picture of the grid a0-25, and the camera file that of this camera?");
        return false;
    }
    for (std::size_t i = 0; i < mountings.size(); i++) {
        result.mountings[i].figures = mountings[i];
    }
    result.has_lens = true;
    for (CalibratePicture &picture : result.pictures) {
        if (picture.index) {
            opms_calibrator_picture(calibrator, *picture.index, &picture.solved, nullptr);
            picture.left_out = picture.solved.use == OPMS_CALIB_USED
                                   ? "" : "it is no view of the grid through such a lens";
        }
    }
    return true;
}

/** What the pictures say by themselves, where they fix a camera. */
void ask_alone(opms_calibrator_t *calibrator, CheckResult &result)
{
    opms_calib_result_t alone;
    if (result.lens.pictures_used >= PICTURES_ALONE &&
        opms_calibrator_solve(calibrator, &alone, nullptr) == OPMS_OK &&
        (alone.warnings & CALIBRATE_OPEN) == 0) {
        result.alone = alone;
    }
}

/** RMS by which the stated lens misses the nodes, beyond what any lens misses. */
double misfit_px(const opms_calib_lens_check_t &lens)
{
    return std::sqrt(std::fmax(0.0, lens.residual_rms_px * lens.residual_rms_px -
                                        lens.residual_free_rms_px * lens.residual_free_rms_px));
}

bool is_noisy(const CameraFile &file, const opms_calib_lens_check_t &lens)
{
    const double usual = file.residual_rms_px.value_or(NOISE_LEAST_PX);
    return lens.residual_free_rms_px > std::fmax(NOISE_LEAST_PX, NOISE_MANY * usual);
}

bool is_sharp(const CameraFile &file, const opms_calib_lens_check_t &lens)
{
    const double centre = SHARP_CENTRE_PARTS * file.camera.lens.width_px;
    return lens.shows_focal < SHARP_FOCAL && lens.shows_centre_px[0] < centre &&
           lens.shows_centre_px[1] < centre;
}

const CheckMounting *worst_mounting(const CheckResult &result)
{
    const auto worst = std::max_element(result.mountings.begin(), result.mountings.end(),
                                        [](const CheckMounting &a, const CheckMounting &b) {
                                            return a.figures.chi2 < b.figures.chi2;
                                        });
    return worst == result.mountings.end() ? nullptr : &*worst;
}

std::string offset_text(const opms_calib_mounting_check_t &mounting)
{
    const double *const w = mounting.change, *const d = mounting.change + 3;
    return text_format("%.2f deg and %.1f mm", DEG * std::hypot(w[0], w[1], w[2]),
                       MM_PER_M * std::hypot(d[0], d[1], d[2]));
}

/** The new focal length, where the pictures know it by themselves. */
std::string focal_text(const CameraFile &file, const CheckResult &result)
{
    return result.alone ? text_format("; its focal length is %.2f px, not %.2f",
                                      result.alone->lens.fx_px, file.camera.lens.fx_px)
                        : std::string();
}

void judge(const CameraFile &file, CheckResult &result)
{
    const opms_calib_lens_check_t &lens = result.lens;
    const CheckMounting *const mounting = worst_mounting(result);
    if (lens.chi2 > OPMS_CALIB_CHI2_LENS) {
        conclude(result, CheckVerdict::lens_touched,
                 text_format("the lens is not the stated one: it misses the nodes by %.3f px RMS "
                             "more than it may", misfit_px(lens)) + focal_text(file, result),
                 "Fix focus and lens, and calibrate again.");
    } else if (mounting != nullptr && mounting->figures.chi2 > OPMS_CALIB_CHI2_MOUNTING) {
        conclude(result, CheckVerdict::camera_moved,
                 "the lens holds, but the camera sits " + offset_text(mounting->figures) +
                     " off its stated place on the detector (" + mounting->image + ")",
                 "Was the head on its marks, level and turned right? Then fix the camera and "
                 "calibrate again.");
    } else if (is_noisy(file, lens)) {
        conclude(result, CheckVerdict::cannot_tell,
                 text_format("the nodes lie %.3f px RMS off any lens, which hides a small change",
                             lens.residual_free_rms_px),
                 "Lay the grid flat, light it evenly, hold still, and take other pictures.");
    } else if (!is_sharp(file, lens)) {
        conclude(result, CheckVerdict::cannot_tell,
                 text_format("nothing speaks against the lens, but these pictures would not show a "
                             "change of focal length below %.2f %% or of the centre below %.1f px",
                             100 * lens.shows_focal,
                             std::fmax(lens.shows_centre_px[0], lens.shows_centre_px[1])),
                 "Add pictures with the detector tilted by 15 degrees and more to different "
                 "sides, the grid reaching into the corners.");
    } else {
        conclude(result, CheckVerdict::valid,
                 mounting != nullptr ? "lens and mounting are as stated"
                                     : "the lens is as stated; of the mounting nothing is known "
                                       "without a picture on the footprint (--footprint)", "");
    }
}

}  // namespace

const char *check_verdict_name(CheckVerdict verdict)
{
    switch (verdict) {
    case CheckVerdict::valid:
        return "valid";
    case CheckVerdict::lens_touched:
        return "lens_touched";
    case CheckVerdict::camera_moved:
        return "camera_moved";
    case CheckVerdict::cannot_tell:
        return "cannot_tell";
    case CheckVerdict::bad_pictures:
        break;
    }
    return "error";
}

CheckResult calibrate_check(const CameraFile &file, const CalibrateJob &job,
                            const CalibrateTalk &talk)
{
    CheckResult result;
    result.pictures = calibrate_read(job, talk);
    if (!check_pictures(file, result)) {
        return result;
    }
    const CalibratorHandle calibrator = add_pictures(file, result);
    if (calibrator && ask(calibrator.get(), file, job, result, talk)) {
        ask_alone(calibrator.get(), result);
        judge(file, result);
    }
    return result;
}
