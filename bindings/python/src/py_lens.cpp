/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms.Lens: rays to pixels and back, many at a time. */
#include "py_convert.h"
#include "py_rows.h"

#include <cstdio>

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

namespace {

opms_lens_t make_lens(int32_t width_px, int32_t height_px, double fx_px, double fy_px,
                      double cx_px, double cy_px, double k1, double k2, double p1, double p2)
{
    return {width_px, height_px, fx_px, fy_px, cx_px, cy_px, k1, k2, p1, p2};
}

/** Call one(i, &err) for each of count rows without the GIL; a failure names its row. */
template <class One> void for_rows(size_t count, const One &one)
{
    opms_error_t err = {};
    opms_status_t status = OPMS_OK;
    {
        nb::gil_scoped_release release;
        for (size_t i = 0; i < count && status == OPMS_OK; i++) {
            status = one(i, &err);
            err.index = static_cast<int32_t>(i);
        }
    }
    if (status != OPMS_OK) {
        py_raise(err);
    }
}

PyRows<2> project(const opms_lens_t &lens, const PyPoints3 &points_m)
{
    PyRowsBuffer<2> px(points_m.shape(0));
    const double *in = points_m.data();
    for_rows(points_m.shape(0), [&](size_t i, opms_error_t *err) {
        return opms_lens_project(&lens, in + 3 * i, px.row(i), nullptr, nullptr, err);
    });
    return px.release();
}

auto project_gradients(const opms_lens_t &lens, const PyPoints3 &points_m)
{
    const size_t count = points_m.shape(0);
    PyRowsBuffer<2> px(count);
    PyRowsBuffer<2, 3> jac(count);
    PyRowsBuffer<2, 8> jac_intrinsics(count);
    const double *in = points_m.data();
    for_rows(count, [&](size_t i, opms_error_t *err) {
        return opms_lens_project(&lens, in + 3 * i, px.row(i), jac.row(i), jac_intrinsics.row(i),
                                 err);
    });
    return std::make_tuple(px.release(), jac.release(), jac_intrinsics.release());
}

PyRows<2> unproject(const opms_lens_t &lens, const PyPoints2 &px)
{
    PyRowsBuffer<2> ray(px.shape(0));
    const double *in = px.data();
    for_rows(px.shape(0), [&](size_t i, opms_error_t *err) {
        return opms_lens_unproject(&lens, in + 2 * i, ray.row(i), nullptr, err);
    });
    return ray.release();
}

auto unproject_gradients(const opms_lens_t &lens, const PyPoints2 &px)
{
    const size_t count = px.shape(0);
    PyRowsBuffer<2> ray(count);
    PyRowsBuffer<2, 2> jac(count);
    const double *in = px.data();
    for_rows(count, [&](size_t i, opms_error_t *err) {
        return opms_lens_unproject(&lens, in + 2 * i, ray.row(i), jac.row(i), err);
    });
    return std::make_tuple(ray.release(), jac.release());
}

std::string lens_repr(const opms_lens_t &l)
{
    char text[400];
    std::snprintf(text, sizeof text,
                  "Lens(width_px=%d, height_px=%d, fx_px=%.10g, fy_px=%.10g, cx_px=%.10g, "
                  "cy_px=%.10g, k1=%.10g, k2=%.10g, p1=%.10g, p2=%.10g)",
                  l.width_px, l.height_px, l.fx_px, l.fy_px, l.cx_px, l.cy_px, l.k1, l.k2, l.p1,
                  l.p2);
    return text;
}

void check(const opms_lens_t &lens)
{
    opms_error_t err = {};
    if (opms_lens_check(&lens, &err) != OPMS_OK) {
        py_raise(err);
    }
}

} // namespace

void py_bind_lens(nb::module_ &module)
{
    using namespace nb::literals;
    nb::class_<opms_lens_t>(module, "Lens", R"(Pinhole with the four-parameter Seidel model.

The distortion is OpenCV's first four coefficients. A value: it never changes, any thread may use
it. Frames: `camera` has x right and y down in the picture, z along the optical axis; pixel (0, 0)
is the centre of the top left pixel.)")
        .def(
            "__init__",
            [](opms_lens_t *self, int32_t width_px, int32_t height_px, double fx_px, double fy_px,
               double cx_px, double cy_px, double k1, double k2, double p1, double p2) {
                new (self) opms_lens_t(make_lens(width_px, height_px, fx_px, fy_px, cx_px, cy_px,
                                                 k1, k2, p1, p2));
            },
            nb::kw_only(), "width_px"_a, "height_px"_a, "fx_px"_a, "fy_px"_a, "cx_px"_a,
            "cy_px"_a, "k1"_a = 0.0, "k2"_a = 0.0, "p1"_a = 0.0, "p2"_a = 0.0,
            "Picture size and intrinsic parameters; check() tells whether they can be used.")
        .def_ro("width_px", &opms_lens_t::width_px, "Width of the picture.")
        .def_ro("height_px", &opms_lens_t::height_px, "Height of the picture.")
        .def_ro("fx_px", &opms_lens_t::fx_px, "Focal length along u.")
        .def_ro("fy_px", &opms_lens_t::fy_px, "Focal length along v.")
        .def_ro("cx_px", &opms_lens_t::cx_px, "Principal point, u.")
        .def_ro("cy_px", &opms_lens_t::cy_px, "Principal point, v.")
        .def_ro("k1", &opms_lens_t::k1, "Radial distortion of r^2.")
        .def_ro("k2", &opms_lens_t::k2, "Radial distortion of r^4.")
        .def_ro("p1", &opms_lens_t::p1, "First tangential distortion.")
        .def_ro("p2", &opms_lens_t::p2, "Second tangential distortion.")
        .def("__repr__", &lens_repr)
        .def("check", &check, R"(Check that the lens can be used over its whole picture.

Raises Error: ERR_ARG names the parameter, ERR_DOMAIN where the distortion folds in the picture.)")
        .def("project", &project, "points_m"_a, R"(Project points of the camera frame.

points_m: (N, 3), X Y Z with Z > 0, any common unit. Returns (N, 2) pixels u v.
Raises Error with the index of the first point that has no picture. Releases the GIL.)")
        .def("project_gradients", &project_gradients, "points_m"_a,
             R"(Project points of the camera frame, with gradients.

points_m: (N, 3) as in project(). Returns pixels (N, 2), d(u, v)/d(X, Y, Z) as (N, 2, 3), and
d(u, v)/d(fx fy cx cy k1 k2 p1 p2) as (N, 2, 8). Raises as project(). Releases the GIL.)")
        .def("unproject", &unproject, "px"_a, R"(Rays of pixels.

px: (N, 2) pixels u v. Returns (N, 2) normalised coordinates x y, so that project((x, y, 1)) = px.
Raises Error with the index of the first pixel that no ray reaches. Releases the GIL.)")
        .def("unproject_gradients", &unproject_gradients, "px"_a, R"(Rays of pixels, with gradients.

px: (N, 2) as in unproject(). Returns rays (N, 2) and d(x, y)/d(u, v) as (N, 2, 2). Raises as
unproject(). Releases the GIL.)");
}
