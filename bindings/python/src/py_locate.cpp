/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms.Locator: from a picture to the detector's pose in one call. */
#include "py_handle.h"

#include <vector>

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>

namespace {

using namespace nb::literals;

struct Location {
    opms_location_t value;
    nb::object squares, edges, residuals_px;
};

class Locator {
public:
    Locator(const opms_camera_t &camera, double bar_tilt_rad, int32_t min_square_px)
        : locator_([&](opms_locator_t **locator, opms_error_t *err) {
              opms_locator_options_t options;
              opms_locator_options_init(&options);
              options.bar_tilt_rad = bar_tilt_rad;
              options.bar.min_square_px = min_square_px;
              return opms_locator_create(&camera, &options, locator, err);
          })
    {
    }

    Location locate(const PyImage &image, const PyRoi &roi, const opms_transform_t *hint,
                    uint16_t white_level)
    {
        const opms_image_t view = py_image(image, white_level);
        const opms_roi_t region = py_roi(roi);
        return run([&](opms_locator_t *locator, opms_location_t *location, opms_error_t *err) {
            return opms_locator_locate(locator, &view, &region, hint, location, err);
        });
    }

    Location solve(nb::handle edges)
    {
        const PyEdges in(edges);
        return run([&](opms_locator_t *locator, opms_location_t *location, opms_error_t *err) {
            return opms_locator_solve(locator, in.data(), in.count(), location, err);
        });
    }

private:
    /** Copies of what the handle keeps only until its next call. */
    struct Details {
        std::vector<opms_square_t> squares;
        std::vector<opms_edge_t> edges;
        std::vector<double> residuals_px;
        bool has_residuals = false;
    };

    static Details copy_details(const opms_locator_t *locator)
    {
        Details details;
        uint32_t count = 0;
        const opms_square_t *squares = opms_locator_squares(locator, &count);
        details.squares.assign(squares, squares + count);
        const opms_edge_t *edges = opms_locator_edges(locator, &count);
        details.edges.assign(edges, edges + count);
        if (const double *residuals_px = opms_locator_residuals_px(locator)) {
            details.residuals_px.assign(residuals_px, residuals_px + count);
            details.has_residuals = true;
        }
        return details;
    }

    template <class Call> Location run(const Call &call)
    {
        Location location = {};
        Details details;
        locator_.run([&](opms_locator_t *locator, opms_error_t *err) {
            OPMS_PY_TRY(call(locator, &location.value, err));
            details = copy_details(locator);
            return OPMS_OK;
        });
        location.squares = py_squares(details.squares.data(), details.squares.size());
        location.edges = py_edges(details.edges.data(), details.edges.size());
        location.residuals_px =
            details.has_residuals
                ? py_doubles(details.residuals_px.data(), details.residuals_px.size())
                : nb::none();
        return location;
    }

    PyHandle<opms_locator_t, opms_locator_destroy> locator_;
};

bool located(const Location &self)
{
    return self.value.state == OPMS_BAR_LOCATED;
}

void bind_location(nb::module_ &module)
{
    nb::class_<Location>(module, "Location", "Everything one picture gives.")
        .def_prop_ro(
            "state", [](const Location &self) { return self.value.state; },
            "A BarState; LOCATED only when the pose is found, too.")
        .def_prop_ro(
            "bar", [](Location &self) -> opms_bar_summary_t & { return self.value.bar; },
            nb::rv_policy::reference_internal, "The picture of the bar as a whole.")
        .def_prop_ro(
            "pose",
            [](Location &self) { return located(self) ? &self.value.pose : nullptr; },
            nb::rv_policy::reference_internal, nb::sig("def pose(self) -> PoseResult | None"),
            "Pose of the camera in the bar frame; None where state is not LOCATED.")
        .def_prop_ro(
            "ground_detector",
            [](Location &self) {
                return located(self) && self.value.has_ground_detector
                           ? &self.value.ground_detector
                           : nullptr;
            },
            nb::rv_policy::reference_internal,
            nb::sig("def ground_detector(self) -> Pose | None"),
            R"(Pose of the detector in the ground frame.

None where state is not LOCATED or the camera has no detector_camera.)")
        .def_prop_ro(
            "covariance_includes",
            [](const Location &self) {
                return static_cast<PyCovariance>(self.value.covariance_includes);
            },
            "What the covariance of ground_detector holds.")
        .def_prop_ro(
            "followed", [](const Location &self) { return self.value.followed != 0; },
            "The hint was taken up.")
        .def_prop_ro(
            "squares", [](const Location &self) { return self.squares; },
            nb::sig("def squares(self) -> numpy.typing.NDArray[numpy.void]"),
            "Squares by rising index, (N,) of opms.SQUARE_DTYPE; see BarDetection.squares.")
        .def_prop_ro(
            "edges", [](const Location &self) { return self.edges; },
            nb::sig("def edges(self) -> numpy.typing.NDArray[numpy.void]"),
            "Measured edges, (N,) of opms.EDGE_DTYPE; see BarDetection.edges.")
        .def_prop_ro(
            "residuals_px", [](const Location &self) { return self.residuals_px; },
            nb::sig("def residuals_px(self) -> numpy.typing.NDArray[numpy.float64] | None"),
            "Signed distance of each edge from the solution, (N,); None where there is none.");
}

} // namespace

void py_bind_locate(nb::module_ &module)
{
    bind_location(module);
    nb::class_<Locator>(module, "Locator", R"(Finds the bar and solves for the pose.

Calls from several threads on one locator are taken one after the other; different locators run in
parallel.)")
        .def(nb::init<const opms_camera_t &, double, int32_t>(), "camera"_a, nb::kw_only(),
             "bar_tilt_rad"_a = 0.0, "min_square_px"_a = 7, R"(For pictures of one camera.

bar_tilt_rad: positive where the printed face is turned away from the operator. min_square_px: as
in BarDetector. Raises Error (ERR_ARG, ERR_DOMAIN, ERR_MEMORY).)")
        .def("locate", &Locator::locate, "image"_a, nb::kw_only(), "roi"_a = nb::none(),
             "hint"_a = nb::none(), "white_level"_a = 0,
             nb::sig("def locate(self, image: numpy.typing.NDArray[numpy.uint8] | "
                     "numpy.typing.NDArray[numpy.uint16], *, "
                     "roi: tuple[int, int, int, int] | None = None, "
                     "hint: Transform | None = None, white_level: int = 0) -> Location"),
             R"(Locate the bar in one picture.

image: (height, width), uint8 or uint16, rows at any distance, read in place without a copy; do not
change it meanwhile. roi: (x_px, y_px, width_px, height_px) in which squares are sought. hint:
the expected camera-to-bar pose, e.g. pose.bar_camera.transform of the last picture; a wrong one
does no harm. white_level: grey level at saturation, 0 for 255 or 65535.
Raises Error (ERR_ARG); "no bar" is no error but a state. Releases the GIL.)")
        .def("solve", &Locator::solve, "edges"_a,
             nb::sig("def solve(self, edges: numpy.typing.NDArray[numpy.void]) -> Location"),
             R"(Solve for the pose from edges found elsewhere, e.g. another kind of bar.

edges: (N,) of opms.EDGE_DTYPE. Raises Error (ERR_ARG, index of the edge). Releases the GIL.)");
}
