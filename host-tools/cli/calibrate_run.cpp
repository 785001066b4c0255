/* SPDX-License-Identifier: Apache-2.0 */
#include "calibrate_run.hpp"

#include <algorithm>

#include "calibrate_points.hpp"
#include "text_table.hpp"

namespace {

constexpr std::size_t PICTURES_LEAST = 3;
/* With more strangers than this it is open which pictures are those of the camera. */
constexpr double STRANGERS_MOST = 0.25;
constexpr const char *UNSOLVED_ADVICE =
    ". Was the detector tilted by 15 degrees or more to different sides, is the grid flat, and are "
    "all pictures of one camera?";

void fail(CalibrateResult &result, CalibrateState state, const std::string &reason)
{
    result.state = state;
    result.reason = reason;
}

std::size_t usable_count(const CalibrateResult &result)
{
    return static_cast<std::size_t>(
        std::count_if(result.pictures.begin(), result.pictures.end(),
                      [](const CalibratePicture &p) { return p.left_out.empty(); }));
}

std::string size_text(const GridPicture &picture)
{
    return text_format("%d x %d px", static_cast<int>(picture.width_px),
                       static_cast<int>(picture.height_px));
}

std::string too_few_text(std::size_t count)
{
    return text_format("%zu usable picture%s; at least 3 are needed, and a dozen is good", count,
                       count == 1 ? "" : "s");
}

/** All pictures read, and of one size? */
bool check_read(CalibrateResult &result)
{
    const GridPicture *first = nullptr;
    for (const CalibratePicture &picture : result.pictures) {
        const GridPicture &grid = picture.grid;
        if (!grid.reason.empty()) {
            fail(result, CalibrateState::bad_pictures, grid.image + ": " + grid.reason);
            return false;
        }
        first = first ? first : &grid;
        if (grid.width_px != first->width_px || grid.height_px != first->height_px) {
            fail(result, CalibrateState::bad_pictures,
                 "pictures of mixed sizes: " + grid.image + " is " + size_text(grid) + ", but " +
                     first->image + " is " + size_text(*first));
            return false;
        }
    }
    if (usable_count(result) < PICTURES_LEAST) {
        fail(result, CalibrateState::bad_pictures, too_few_text(usable_count(result)));
        return false;
    }
    return true;
}

CalibratorHandle make_calibrator(const CalibrateJob &job, CalibrateResult &result)
{
    opms_calib_options_t options;
    opms_calib_options_init(&options);
    options.width_px = result.pictures.front().grid.width_px;
    options.height_px = result.pictures.front().grid.height_px;
    options.cockle_sigma_m = job.cockle_sigma_m;
    options.pictures_max = static_cast<uint32_t>(usable_count(result));
    opms_calibrator_t *calibrator = nullptr;
    opms_error_t error = {};
    if (opms_calibrator_create(&options, &calibrator, &error) != OPMS_OK) {
        fail(result, CalibrateState::bad_pictures, error.message);
    }
    return CalibratorHandle(calibrator);
}

void add_pictures(opms_calibrator_t *calibrator, CalibrateResult &result)
{
    for (CalibratePicture &picture : result.pictures) {
        if (!picture.left_out.empty()) {
            continue;
        }
        const std::vector<opms_calib_point_t> points = calibrate_points(picture.grid);
        uint32_t index = 0;
        opms_error_t error = {};
        if (opms_calibrator_add(calibrator, points.data(), static_cast<uint32_t>(points.size()),
                                &index, &error) == OPMS_OK) {
            picture.index = index;
        } else {
            picture.left_out = error.message;
        }
    }
}

std::string use_text(opms_calib_use_t use)
{
    return use == OPMS_CALIB_NO_PLANE ? "its nodes are no view of a plane"
                                      : "it does not fit the camera of the other pictures";
}

/** Take over what became of each picture; those that do not fit are named. */
void sort_out(const opms_calibrator_t *calibrator, CalibrateResult &result,
              const CalibrateTalk &talk)
{
    for (CalibratePicture &picture : result.pictures) {
        if (!picture.index) {
            continue;
        }
        opms_calibrator_picture(calibrator, *picture.index, &picture.solved, nullptr);
        picture.weights.resize(picture.grid.nodes.size());
        picture.residuals_px.resize(2 * picture.weights.size());
        opms_calibrator_residuals(calibrator, *picture.index, picture.residuals_px.data(),
                                  picture.weights.data(), nullptr);
        if (picture.solved.use != OPMS_CALIB_USED) {
            picture.left_out = use_text(picture.solved.use);
            talk(picture.grid.image + ": left out: " + picture.left_out);
        }
    }
}

bool solve(opms_calibrator_t *calibrator, CalibrateResult &result, const CalibrateTalk &talk)
{
    const std::size_t count = usable_count(result);
    opms_error_t error = {};
    if (opms_calibrator_solve(calibrator, &result.calib, &error) != OPMS_OK) {
        fail(result, CalibrateState::unsolved, std::string(error.message) + UNSOLVED_ADVICE);
        return false;
    }
    result.has_solution = true;
    sort_out(calibrator, result, talk);
    const std::size_t strangers = count - usable_count(result);
    if (static_cast<double>(strangers) > STRANGERS_MOST * static_cast<double>(count)) {
        fail(result, CalibrateState::undetermined,
             text_format("%zu of %zu pictures do not fit the camera of the others: are they of two "
                         "cameras, or was the lens touched in between?", strangers, count));
        return false;
    }
    return true;
}

/** The footprints whose pictures are in the solution. */
std::vector<opms_footprint_t> usable_footprints(const CalibrateJob &job, CalibrateResult &result)
{
    std::vector<opms_footprint_t> usable;
    for (const FootprintPlace &place : job.footprints) {
        for (const CalibratePicture &picture : result.pictures) {
            if (picture.used() && picture.grid.image == place.image) {
                usable.push_back({*picture.index, place.x_m, place.y_m, place.yaw_rad,
                                  job.footprint_sigma_m, job.footprint_sigma_rad});
                result.footprints.push_back(place);
                break;
            }
        }
    }
    return usable;
}

std::vector<opms_footprint_t> placed_exactly(std::vector<opms_footprint_t> footprints)
{
    for (opms_footprint_t &footprint : footprints) {
        footprint.sigma_m = footprint.sigma_rad = 0;
    }
    return footprints;
}

/** The camera on the detector. @return false with why not in @p result. */
bool place_camera(const opms_calibrator_t *calibrator,
                  const std::vector<opms_footprint_t> &footprints, opms_camera_t &camera,
                  CalibrateResult &result)
{
    opms_error_t error = {};
    if (opms_calibrator_camera(calibrator, footprints.data(),
                               static_cast<uint32_t>(footprints.size()), &camera,
                               &error) != OPMS_OK) {
        fail(result, CalibrateState::unsolved, error.message);
        return false;
    }
    return true;
}

void place_cameras(const opms_calibrator_t *calibrator, const CalibrateJob &job,
                   const std::vector<opms_footprint_t> &footprints, CalibrateResult &result)
{
    if (footprints.empty()) {
        fail(result, CalibrateState::bad_pictures,
             "no picture on the footprint can be used (" + job.footprints.front().image +
                 "): where the camera sits on the detector stays unknown. Take it again, with the "
                 "marker in sight");
        return;
    }
    if (!place_camera(calibrator, footprints, result.camera, result) ||
        !place_camera(calibrator, placed_exactly(footprints), result.placed, result)) {
        return;
    }
    result.state = CalibrateState::calibrated;
    result.expected = expected_over(result.camera, result.placed, expected_working_volume());
}

/** The picture to take next, told from the first that was used. */
void advise(const opms_calibrator_t *calibrator, const std::vector<opms_footprint_t> &footprints,
            CalibrateResult &result)
{
    const auto first = std::find_if(result.pictures.begin(), result.pictures.end(),
                                    [](const CalibratePicture &p) { return p.used(); });
    result.next = calibrate_advice(calibrator, *first->index, placed_exactly(footprints));
    if (result.next) {
        std::optional<double> total_m;
        if (result.expected && result.expected->places_seen > 0) {
            total_m = result.expected->total().position_rms_m();
        }
        result.next_words = calibrate_advice_words(*result.next, total_m);
    }
}

}  // namespace

CalibrateResult calibrate_run(const CalibrateJob &job, const CalibrateTalk &talk)
{
    CalibrateResult result;
    result.pictures = calibrate_read(job, talk);
    if (!check_read(result)) {
        return result;
    }
    const CalibratorHandle calibrator = make_calibrator(job, result);
    if (!calibrator) {
        return result;
    }
    add_pictures(calibrator.get(), result);
    if (usable_count(result) < PICTURES_LEAST) {
        fail(result, CalibrateState::bad_pictures, too_few_text(usable_count(result)));
        return result;
    }
    if (!solve(calibrator.get(), result, talk)) {
        return result;
    }
    talk(text_format("solved: %u pictures, %u nodes, %u outliers, residual %.3f px RMS",
                     result.calib.pictures_used, result.calib.points_used, result.calib.outliers,
                     result.calib.residual_rms_px));
    const std::vector<opms_footprint_t> footprints = usable_footprints(job, result);
    if (result.calib.warnings & CALIBRATE_OPEN) {
        fail(result, CalibrateState::undetermined,
             "the pictures do not fix the camera: tilt it in other ways between them");
    } else {
        place_cameras(calibrator.get(), job, footprints, result);
    }
    advise(calibrator.get(), footprints, result);
    return result;
}
