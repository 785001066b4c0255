/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms.Transform, Pose, Camera, PoseResult and the pose calls. */
#include "py_convert.h"

#include <algorithm>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

namespace {

using namespace nb::literals;

template <class Array> void copy_out(const Array &from, double *to)
{
    std::copy_n(from.data(), from.size(), to);
}

void bind_transform(nb::module_ &module)
{
    nb::class_<opms_transform_t>(module, "Transform",
                                 R"(A rigid transform that takes coordinates in b to those in a.

A value: it never changes, any thread may use it.)")
        .def(
            "__init__",
            [](opms_transform_t *self, const PyMatrix3 &R, const PyVector3 &t_m) {
                new (self) opms_transform_t();
                copy_out(R, self->R);
                copy_out(t_m, self->t_m);
            },
            "R"_a, "t_m"_a, "R: (3, 3) rotation R_a_b; t_m: (3,) translation t_a_b in metres.")
        .def_prop_ro(
            "R", [](opms_transform_t &self) { return py_view<3, 3>(self, self.R); },
            "Rotation R_a_b, (3, 3), read only.")
        .def_prop_ro(
            "t_m", [](opms_transform_t &self) { return py_view<3>(self, self.t_m); },
            "Translation t_a_b in metres, (3,), read only.");

    nb::class_<opms_pose_t>(module, "Pose", "A pose with its uncertainty.")
        .def_ro("transform", &opms_pose_t::transform, "The pose itself.")
        .def_prop_ro(
            "covariance", [](opms_pose_t &self) { return py_view<6, 6>(self, self.covariance); },
            R"(Covariance of (w, d), (6, 6), read only, in rad and m.

R_true = R Exp(w), t_true = t + d.)");
}

void init_camera(opms_camera_t *self, const opms_lens_t &lens,
                 const std::optional<PyMatrix3> &R_detector_camera,
                 const std::optional<PyVector3> &t_detector_camera_m,
                 const std::optional<PyMatrix8> &covariance_intrinsics,
                 const std::optional<PyMatrix6> &covariance_detector_camera,
                 const std::optional<PyMatrix68> &covariance_detector_camera_intrinsics)
{
    if (R_detector_camera.has_value() != t_detector_camera_m.has_value()) {
        throw nb::value_error("R_detector_camera and t_detector_camera_m need each other");
    }
    if (covariance_detector_camera && !R_detector_camera) {
        throw nb::value_error("covariance_detector_camera needs R_detector_camera");
    }
    if (covariance_detector_camera_intrinsics &&
        !(covariance_detector_camera && covariance_intrinsics)) {
        throw nb::value_error("covariance_detector_camera_intrinsics needs covariance_intrinsics "
                              "and covariance_detector_camera");
    }
    new (self) opms_camera_t();
    self->lens = lens;
    if (R_detector_camera) {
        self->has_detector_camera = 1;
        copy_out(*R_detector_camera, self->detector_camera.R);
        copy_out(*t_detector_camera_m, self->detector_camera.t_m);
    }
    if (covariance_intrinsics) {
        self->has_covariance_intrinsics = 1;
        copy_out(*covariance_intrinsics, self->covariance_intrinsics);
    }
    if (covariance_detector_camera) {
        self->has_covariance_detector_camera = 1;
        copy_out(*covariance_detector_camera, self->covariance_detector_camera);
    }
    if (covariance_detector_camera_intrinsics) {
        self->has_covariance_detector_camera_intrinsics = 1;
        copy_out(*covariance_detector_camera_intrinsics,
                 self->covariance_detector_camera_intrinsics);
    }
}

void check_camera(const opms_camera_t &camera)
{
    opms_error_t err = {};
    if (opms_camera_check(&camera, &err) != OPMS_OK) {
        py_raise(err);
    }
}

void bind_camera(nb::module_ &module)
{
    nb::class_<opms_camera_t>(module, "Camera",
                              R"(A camera as calibrated: its lens and its place on the detector.

A value: it never changes, any thread may use it. opms.load_camera() reads one from a file.)")
        .def("__init__", &init_camera, "lens"_a, nb::kw_only(),
             "R_detector_camera"_a = nb::none(), "t_detector_camera_m"_a = nb::none(),
             "covariance_intrinsics"_a = nb::none(), "covariance_detector_camera"_a = nb::none(),
             "covariance_detector_camera_intrinsics"_a = nb::none(),
             R"(R_detector_camera: (3, 3) and t_detector_camera_m: (3,) take the camera's frame
to the detector's. covariance_intrinsics: (8, 8) in the order fx fy cx cy k1 k2 p1 p2;
covariance_detector_camera: (6, 6) of (w, d) as in Pose.covariance;
covariance_detector_camera_intrinsics: (6, 8), that of the latter with the former.)")
        .def("check", &check_camera,
             "Check lens, rotation and covariances. Raises Error (ERR_ARG or ERR_DOMAIN).")
        .def_ro("lens", &opms_camera_t::lens, "The lens.")
        .def_prop_ro(
            "detector_camera",
            [](opms_camera_t &self) {
                return self.has_detector_camera ? &self.detector_camera : nullptr;
            },
            nb::rv_policy::reference_internal,
            nb::sig("def detector_camera(self) -> Transform | None"),
            "Camera to detector, or None.")
        .def_prop_ro(
            "covariance_intrinsics",
            [](opms_camera_t &self) {
                using Array = decltype(py_view<8, 8>(self, self.covariance_intrinsics));
                return self.has_covariance_intrinsics
                           ? std::optional<Array>(py_view<8, 8>(self, self.covariance_intrinsics))
                           : std::nullopt;
            },
            "Covariance of fx fy cx cy k1 k2 p1 p2, (8, 8), or None.")
        .def_prop_ro(
            "covariance_detector_camera",
            [](opms_camera_t &self) {
                using Array = decltype(py_view<6, 6>(self, self.covariance_detector_camera));
                return self.has_covariance_detector_camera
                           ? std::optional<Array>(
                                 py_view<6, 6>(self, self.covariance_detector_camera))
                           : std::nullopt;
            },
            "Covariance of (w, d) of the camera on the detector, (6, 6), or None.")
        .def_prop_ro(
            "covariance_detector_camera_intrinsics",
            [](opms_camera_t &self) {
                using Array =
                    decltype(py_view<6, 8>(self, self.covariance_detector_camera_intrinsics));
                return self.has_covariance_detector_camera_intrinsics
                           ? std::optional<Array>(
                                 py_view<6, 8>(self, self.covariance_detector_camera_intrinsics))
                           : std::nullopt;
            },
            "Covariance of (w, d) of the camera on the detector with the intrinsics, (6, 8), "
            "or None.");
}

void bind_result(nb::module_ &module)
{
    nb::enum_<opms_pose_state_t>(module, "PoseState", nb::is_arithmetic(),
                                 "Outcome of pose_solve().")
        .value("NONE", OPMS_POSE_NONE, "Too few edges, or none that agree.")
        .value("FOUND", OPMS_POSE_FOUND)
        .value("AMBIGUOUS", OPMS_POSE_AMBIGUOUS, "Both solutions of a plane fit alike.");

    nb::class_<opms_pose_result_t>(module, "PoseResult",
                                   "Result of pose_solve(); valid where state is FOUND.")
        .def_ro("state", &opms_pose_result_t::state, "A PoseState.")
        .def_ro("edges_used", &opms_pose_result_t::edges_used,
                "Edges with a robust weight above one half.")
        .def_ro("bar_camera", &opms_pose_result_t::bar_camera,
                "Camera to bar; the covariance is from the image noise alone.")
        .def_ro("edge_shift_px", &opms_pose_result_t::edge_shift_px,
                "Common outward shift of all edges of the black squares.")
        .def_ro("residual_px", &opms_pose_result_t::residual_px,
                "Weighted RMS of the used edges' distances from the solution.")
        .def_ro("chi2_dof", &opms_pose_result_t::chi2_dof,
                "Mean squared residual of the used edges in units of their sigmas.")
        .def_ro("chi2_other", &opms_pose_result_t::chi2_other,
                "Excess of chi2 of the other planar solution; large is good.")
        .def_prop_ro(
            "intrinsics_jacobian",
            [](opms_pose_result_t &self) { return py_view<6, 8>(self, self.intrinsics_jacobian); },
            "d(w, d)/d(fx fy cx cy k1 k2 p1 p2), (6, 8), read only.");
}

std::pair<opms_pose_result_t, nb::object> pose_solve(const opms_lens_t &lens, nb::handle edges)
{
    const PyEdges in(edges);
    opms_pose_result_t result = {};
    opms_error_t err = {};
    opms_status_t status;
    std::vector<double> residuals_px(std::min<uint32_t>(in.count(), OPMS_BAR_EDGES_MAX));
    {
        nb::gil_scoped_release release;
        status = opms_pose_solve(&lens, in.data(), in.count(), residuals_px.data(), &result, &err);
    }
    if (status != OPMS_OK) {
        py_raise(err);
    }
    nb::object residuals = result.state == OPMS_POSE_FOUND
                               ? py_doubles(residuals_px.data(), residuals_px.size())
                               : nb::none();
    return {result, residuals};
}

std::pair<opms_pose_t, PyCovariance> pose_detector(const opms_pose_result_t &bar_camera,
                                                 const opms_camera_t &camera, double bar_tilt_rad)
{
    opms_pose_t pose = {};
    uint32_t includes = 0;
    opms_error_t err = {};
    if (opms_pose_detector(&bar_camera, &camera, bar_tilt_rad, &pose, &includes, &err) != OPMS_OK) {
        py_raise(err);
    }
    return {pose, static_cast<PyCovariance>(includes)};
}

} // namespace

void py_bind_pose(nb::module_ &module)
{
    nb::enum_<PyCovariance>(module, "Covariance", nb::is_flag(), "What a covariance holds.")
        .value("IMAGE", static_cast<PyCovariance>(OPMS_COVARIANCE_IMAGE))
        .value("INTRINSICS", static_cast<PyCovariance>(OPMS_COVARIANCE_INTRINSICS))
        .value("DETECTOR_CAMERA", static_cast<PyCovariance>(OPMS_COVARIANCE_DETECTOR_CAMERA));
    bind_transform(module);
    bind_camera(module);
    bind_result(module);
    module.def("pose_solve", &pose_solve, "lens"_a, "edges"_a,
               nb::sig("def pose_solve(lens: Lens, edges: numpy.typing.NDArray[numpy.void]) -> "
                       "tuple[PoseResult, numpy.typing.NDArray[numpy.float64] | None]"),
               R"(Pose of the camera in the bar frame from measured edges.

edges: (N,) of opms.EDGE_DTYPE, at least 8 on 2 squares for a pose. Returns the result and, where
its state is FOUND, the signed distance of each edge from the solution in px, (N,).
Raises Error (ERR_ARG, index of the edge). Pure, any thread; releases the GIL.)");
    module.def("pose_detector", &pose_detector, "bar_camera"_a, "camera"_a, "bar_tilt_rad"_a = 0.0,
               R"(Pose of the detector in the ground frame from that of the camera in the bar frame.

bar_camera: a result whose state is FOUND. camera: with detector_camera. bar_tilt_rad: positive
where the printed face is turned away from the operator. Returns the pose, detector to ground, and
what its covariance holds. Raises Error (ERR_ARG). Pure, any thread.)");
}
