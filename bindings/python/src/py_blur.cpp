/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms.blur: how sharp the bar is, and what is wrong where it is not. */
#include "py_handle.h"

#include <nanobind/stl/optional.h>

namespace {

using namespace nb::literals;

struct PySquares : PyItems<opms_square_t> {
    explicit PySquares(nb::handle array) : PyItems(array, "SQUARE_DTYPE", "squares") {}
};

opms_blur_t measure(const PyImage &image, nb::handle squares, uint16_t white_level,
                    double sharp_most_px)
{
    const opms_image_t view = py_image(image, white_level);
    const PySquares given(squares);
    opms_blur_options_t options;
    opms_blur_options_init(&options);
    options.sharp_most_px = sharp_most_px;
    opms_blur_t blur = {};
    py_call([&](opms_error_t *err) {
        return opms_blur_measure(&view, given.data(), given.count(), &options, &blur, err);
    });
    return blur;
}

std::optional<int32_t> index_of(int32_t square)
{
    return square < 0 ? std::nullopt : std::optional<int32_t>(square);
}

} // namespace

void py_bind_blur(nb::module_ &module)
{
    nb::enum_<opms_blur_verdict_t>(module, "BlurVerdict", nb::is_arithmetic(),
                                   "What a person should do something about.")
        .value("UNKNOWN", OPMS_BLUR_UNKNOWN, "Too few squares, or their white is saturated.")
        .value("SHARP", OPMS_BLUR_SHARP)
        .value("FOCUS", OPMS_BLUR_FOCUS, "Blurred in all directions, nowhere sharp.")
        .value("MOTION", OPMS_BLUR_MOTION, "Blurred in one direction of the picture.")
        .value("APERTURE", OPMS_BLUR_APERTURE, "Sharp in places alone.");

    nb::class_<opms_blur_t>(module, "Blur", R"(How sharp the bar is in a picture.

Blur is the standard deviation of what a point becomes, px, as the picture shows it: a perfect lens
leaves the pixel's own 0.29.)")
        .def_ro("verdict", &opms_blur_t::verdict, "A BlurVerdict.")
        .def_ro("squares", &opms_blur_t::squares, "Squares that were measured.")
        .def_prop_ro(
            "blur_px", [](opms_blur_t &self) { return py_view<2>(self, self.blur_px); },
            "Medians across the sides along Y and across those along X, (2,).")
        .def_ro("still_px", &opms_blur_t::still_px,
                "Median in the direction that is blurred least.")
        .def_ro("motion_px", &opms_blur_t::motion_px,
                "Way of the picture that explains what is more in the other direction.")
        .def_prop_ro(
            "motion_direction",
            [](opms_blur_t &self) { return py_view<2>(self, self.motion_direction); },
            "(u, v) of that way, length 1; its sign means nothing.")
        .def_ro("sharpest_px", &opms_blur_t::sharpest_px, "Blur where it is least on the bar.")
        .def_ro("softest_px", &opms_blur_t::softest_px, "Blur where it is most on the bar.")
        .def_prop_ro(
            "sharpest_square",
            [](const opms_blur_t &self) { return index_of(self.sharpest_square); },
            "Index of the square where it is least; None where none was measured.")
        .def_prop_ro(
            "softest_square", [](const opms_blur_t &self) { return index_of(self.softest_square); },
            "Index of the square where it is most; None where none was measured.");

    module.def("blur_measure", &measure, "image"_a, "squares"_a, nb::kw_only(),
               "white_level"_a = 0, "sharp_most_px"_a = 1.0,
               nb::sig("def blur_measure(image: numpy.typing.NDArray[numpy.uint8] | "
                       "numpy.typing.NDArray[numpy.uint16], "
                       "squares: numpy.typing.NDArray[numpy.void], *, white_level: int = 0, "
                       "sharp_most_px: float = 1.0) -> Blur"),
               R"(Measure the blur of the bar's squares.

image: (height, width), uint8 or uint16, read in place; squares: (N,) of opms.SQUARE_DTYPE as a
detection or a location has them. white_level: grey level at saturation, 0 for 255 or 65535.
sharp_most_px: up to here it counts as sharp, 0.3 to 20.
Raises Error (ERR_ARG). Pure, any thread; releases the GIL.)");
}
