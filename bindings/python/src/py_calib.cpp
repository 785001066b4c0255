/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms.calib: from points of a plane in several pictures to the camera. */
#include "py_handle.h"
#include "py_rows.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

namespace {

using namespace nb::literals;

using Sigmas = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Footprints = std::vector<opms_footprint_t>;

std::vector<opms_calib_point_t> gather(const PyPoints2 &target_m, const PyPoints2 &px,
                                       const Sigmas &sigma_px)
{
    const size_t count = target_m.shape(0);
    if (px.shape(0) != count || sigma_px.shape(0) != count) {
        throw nb::value_error("target_m, px and sigma_px must have the same length");
    }
    std::vector<opms_calib_point_t> points(count);
    for (size_t i = 0; i < count; ++i) {
        std::copy_n(target_m.data() + 2 * i, 2, points[i].target_m);
        std::copy_n(px.data() + 2 * i, 2, points[i].px);
        points[i].sigma_px = sigma_px.data()[i];
    }
    return points;
}

class Calibrator {
public:
    Calibrator(int32_t width_px, int32_t height_px, uint32_t pictures_max, uint32_t points_max,
               double cockle_sigma_m)
        : calibrator_([&](opms_calibrator_t **calibrator, opms_error_t *err) {
              opms_calib_options_t options;
              opms_calib_options_init(&options);
              options.width_px = width_px;
              options.height_px = height_px;
              options.pictures_max = pictures_max;
              options.points_max = points_max;
              options.cockle_sigma_m = cockle_sigma_m;
              return opms_calibrator_create(&options, calibrator, err);
          })
    {
    }

    uint32_t add(const PyPoints2 &target_m, const PyPoints2 &px, const Sigmas &sigma_px)
    {
        const std::vector<opms_calib_point_t> points = gather(target_m, px, sigma_px);
        /* More than the library ever takes is refused by it, not cut off here. */
        const auto count = static_cast<uint32_t>(
            std::min<size_t>(points.size(), OPMS_CALIB_POINTS_MAX + 1));
        uint32_t picture = 0;
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            return opms_calibrator_add(calibrator, points.data(), count, &picture, err);
        });
        return picture;
    }

    void use(uint32_t picture, bool used)
    {
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            return opms_calibrator_use(calibrator, picture, used ? 1 : 0, err);
        });
    }

    opms_calib_result_t solve()
    {
        opms_calib_result_t result = {};
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            return opms_calibrator_solve(calibrator, &result, err);
        });
        return result;
    }

    opms_calib_picture_t picture(uint32_t picture)
    {
        opms_calib_picture_t result = {};
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            return opms_calibrator_picture(calibrator, picture, &result, err);
        });
        return result;
    }

    std::tuple<PyRows<2>, PyRows<>> residuals(uint32_t picture)
    {
        std::vector<double> residuals_px, weights;
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            opms_calib_picture_t about;
            OPMS_PY_TRY(opms_calibrator_picture(calibrator, picture, &about, err));
            residuals_px.resize(2 * about.points);
            weights.resize(about.points);
            return opms_calibrator_residuals(calibrator, picture, residuals_px.data(),
                                             weights.data(), err);
        });
        PyRowsBuffer<2> residual_rows(weights.size());
        PyRowsBuffer<> weight_rows(weights.size());
        std::copy(residuals_px.begin(), residuals_px.end(), residual_rows.row(0));
        std::copy(weights.begin(), weights.end(), weight_rows.row(0));
        return {residual_rows.release(), weight_rows.release()};
    }

    std::vector<uint32_t> choose(uint32_t count)
    {
        count = std::min<uint32_t>(count, OPMS_CALIB_PICTURES_MAX);
        std::vector<uint32_t> chosen(count + 1);
        uint32_t chosen_count = 0;
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            return opms_calibrator_choose(calibrator, count, chosen.data(), &chosen_count, err);
        });
        chosen.resize(chosen_count);
        return chosen;
    }

    opms_camera_t camera(const Footprints &footprints)
    {
        opms_camera_t camera = {};
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            return opms_calibrator_camera(calibrator, footprints.data(),
                                          static_cast<uint32_t>(footprints.size()), &camera, err);
        });
        return camera;
    }

    opms_calib_foresight_t foresee(const opms_transform_t &target_camera,
                                   const PyPoints2 &target_m, double sigma_px,
                                   const Footprints &footprints)
    {
        opms_calib_view_t view = {};
        view.target_camera = target_camera;
        view.target_m = target_m.data();
        view.count = static_cast<uint32_t>(std::min<size_t>(target_m.shape(0), UINT32_MAX));
        view.footprint_count = static_cast<uint32_t>(footprints.size());
        view.footprints = footprints.data();
        view.sigma_px = sigma_px;
        opms_calib_foresight_t foresight = {};
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            return opms_calibrator_foresee(calibrator, &view, &foresight, err);
        });
        return foresight;
    }

    std::pair<opms_calib_lens_check_t, std::vector<opms_calib_mounting_check_t>>
    check(const opms_camera_t &camera, const Footprints &footprints)
    {
        opms_calib_lens_check_t lens = {};
        std::vector<opms_calib_mounting_check_t> mountings(footprints.size());
        calibrator_.run([&](opms_calibrator_t *calibrator, opms_error_t *err) {
            return opms_calibrator_check(calibrator, &camera, footprints.data(),
                                         static_cast<uint32_t>(footprints.size()), &lens,
                                         mountings.data(), err);
        });
        return {lens, mountings};
    }

private:
    PyHandle<opms_calibrator_t, opms_calibrator_destroy> calibrator_;
};

void bind_pictures(nb::class_<Calibrator> &bound)
{
    bound
        .def("add", &Calibrator::add, "target_m"_a, "px"_a, "sigma_px"_a,
             R"(Add a picture; returns its index: 0, 1, ... in the order of the calls.

target_m: (N, 2), the points' (X, Y) in the target's plane in metres; px: (N, 2), where they are
seen, (u, v); sigma_px: (N,), standard deviation of each coordinate, > 0. N is at least 4.
Raises Error: ERR_ARG (index of the point), ERR_CAPACITY, or ERR_DOMAIN where the points are no
view of a plane; nothing was added then. Releases the GIL.)")
        .def("use", &Calibrator::use, "picture"_a, "used"_a,
             R"(Switch a picture off or on again; it takes effect with the next solution.

Raises Error (ERR_ARG).)")
        .def("picture", &Calibrator::picture, "picture"_a,
             "What became of one picture in the last solution. Raises Error (ERR_ARG).")
        .def("residuals", &Calibrator::residuals, "picture"_a,
             R"(Residuals and weights of one picture's points in the last solution.

Returns (N, 2) in px, measured less model, NaN where the picture is not used; and (N,) robust
weights, 0 to 1, below one quarter for an outlier. Raises Error (ERR_ARG).)");
}

void bind_answers(nb::class_<Calibrator> &bound)
{
    bound
        .def("solve", &Calibrator::solve,
             R"(Solve for the camera from all pictures that are switched on.

The next solution starts from the last one. Raises Error: ERR_DOMAIN where fewer than 3 pictures
can be used or nothing fits them, ERR_CONVERGE. Releases the GIL.)")
        .def("choose", &Calibrator::choose, "count"_a,
             R"(Indices of the pictures that together fix the lens best, best first.

Fewer than count where fewer are used. Raises Error (ERR_DOMAIN before a solution).)")
        .def("camera", &Calibrator::camera, "footprints"_a,
             R"(The camera on its detector, from pictures on footprints, with its covariances.

footprints: at least one, of pictures that the last solution used. Without any,
opms.Camera(result.lens, covariance_intrinsics=result.covariance) is the camera by itself.
Raises Error: ERR_ARG (index of the footprint), ERR_DOMAIN before a solution.)")
        .def("foresee", &Calibrator::foresee, "target_camera"_a, "target_m"_a, nb::kw_only(),
             "sigma_px"_a = 0.0, "footprints"_a = Footprints(),
             R"(Foresee what one more picture would do, before it is taken.

target_camera: camera to target, from where it would be taken; target_m: (N, 2), the target's
points, of which those in the picture count; sigma_px: of a point's coordinate, 0 for that of the
pictures so far; footprints: as for camera(), where the place on the detector matters.
Raises Error: ERR_ARG, ERR_DOMAIN before a solution. Releases the GIL.)")
        .def("check", &Calibrator::check, "camera"_a, "footprints"_a = Footprints(),
             R"(Does a camera that was calibrated before still hold?

camera: as it was calibrated; with footprints it needs detector_camera. Returns what the pictures
say of its lens, and for each footprint what that picture says of its mounting. A solution of this
calibrator is lost. Raises Error: ERR_ARG (index of the footprint), ERR_DOMAIN where no picture is
seen by such a lens at all. Releases the GIL.)");
}

} // namespace

void py_bind_calib(nb::module_ &module)
{
    py_bind_calib_results(module);
    nb::class_<Calibrator> bound(module, "Calibrator", R"(Solves one camera; holds all memory.

Calls from several threads on one calibrator are taken one after the other; different calibrators
run in parallel.)");
    bound.def(nb::init<int32_t, int32_t, uint32_t, uint32_t, double>(), "width_px"_a,
              "height_px"_a, nb::kw_only(), "pictures_max"_a = 64, "points_max"_a = 1485,
              "cockle_sigma_m"_a = 0.0, R"(For pictures of one size, 16 to 16384 px each way.

pictures_max: 3 to 1024; points_max: in one picture, 4 to 8192; cockle_sigma_m: how far the target
may be off a plane (standard deviation at half its size), which is then estimated; 0: it is a
plane. Raises Error (ERR_ARG, ERR_MEMORY).)");
    bind_pictures(bound);
    bind_answers(bound);
}
