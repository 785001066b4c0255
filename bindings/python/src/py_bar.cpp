/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms.BarDetector: from a picture to labelled squares and measured edges. */
#include "py_handle.h"

#include <vector>

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>

namespace {

using namespace nb::literals;

struct BarDetection {
    opms_bar_summary_t summary;
    nb::object squares, edges;
};

class BarDetector {
public:
    BarDetector(const opms_lens_t &lens, int32_t min_square_px)
        : detector_([&](opms_bar_detector_t **detector, opms_error_t *err) {
              opms_bar_options_t options;
              opms_bar_options_init(&options);
              options.min_square_px = min_square_px;
              return opms_bar_detector_create(&lens, &options, detector, err);
          })
    {
    }

    BarDetection detect(const PyImage &image, const PyRoi &roi, const opms_transform_t *hint,
                        uint16_t white_level)
    {
        const opms_image_t view = py_image(image, white_level);
        const opms_roi_t region = py_roi(roi);
        BarDetection found = {};
        std::vector<opms_square_t> squares;
        std::vector<opms_edge_t> edges;
        detector_.run([&](opms_bar_detector_t *detector, opms_error_t *err) {
            OPMS_PY_TRY(opms_bar_detect(detector, &view, &region, hint, &found.summary, err));
            uint32_t count = 0;
            const opms_square_t *s = opms_bar_squares(detector, &count);
            squares.assign(s, s + count);
            const opms_edge_t *e = opms_bar_edges(detector, &count);
            edges.assign(e, e + count);
            return OPMS_OK;
        });
        found.squares = py_squares(squares.data(), squares.size());
        found.edges = py_edges(edges.data(), edges.size());
        return found;
    }

private:
    PyHandle<opms_bar_detector_t, opms_bar_detector_destroy> detector_;
};

void bind_summary(nb::module_ &module)
{
    nb::enum_<opms_bar_state_t>(module, "BarState", nb::is_arithmetic(), "What a picture shows.")
        .value("ABSENT", OPMS_BAR_ABSENT, "No bar is seen.")
        .value("LOCATED", OPMS_BAR_LOCATED, "Squares found, labels certain.")
        .value("AMBIGUOUS", OPMS_BAR_AMBIGUOUS, "Squares found, but the evidence does not decide.");

    nb::class_<opms_bar_summary_t>(module, "BarSummary", "The picture of the bar as a whole.")
        .def_ro("state", &opms_bar_summary_t::state, "A BarState.")
        .def_ro("square_count", &opms_bar_summary_t::square_count, "Squares found.")
        .def_ro("edge_count", &opms_bar_summary_t::edge_count, "Edges measured.")
        .def_prop_ro(
            "followed", [](const opms_bar_summary_t &self) { return self.followed != 0; },
            "The bar was found where the hint said.")
        .def_ro("label_margin", &opms_bar_summary_t::label_margin,
                "Log-likelihood ratio of the labels to the next best; 0 if none.")
        .def_prop_ro(
            "blur_px", [](opms_bar_summary_t &self) { return py_view<2>(self, self.blur_px); },
            "Gaussian edge blur of the sides along X and of those along Y, (2,); 0 unknown.")
        .def_ro("noise", &opms_bar_summary_t::noise,
                "Standard deviation of the grey levels about the edge model.")
        .def_ro("contrast", &opms_bar_summary_t::contrast,
                "Median grey levels from black to white.")
        .def_ro("white_fraction_saturated", &opms_bar_summary_t::white_fraction_saturated,
                "Part of the white beside the squares that is saturated.");
}

} // namespace

void py_bind_bar(nb::module_ &module)
{
    bind_summary(module);
    nb::class_<BarDetection>(module, "BarDetection", "What BarDetector.detect() found.")
        .def_ro("summary", &BarDetection::summary, "State and figures.")
        .def_prop_ro(
            "squares", [](const BarDetection &self) { return self.squares; },
            nb::sig("def squares(self) -> numpy.typing.NDArray[numpy.void]"),
            R"(Squares by rising index, (N,) of opms.SQUARE_DTYPE.

corners_px: (N, 4, 2), in the order (-X,-Y), (+X,-Y), (+X,+Y), (-X,+Y) of the bar frame.)")
        .def_prop_ro(
            "edges", [](const BarDetection &self) { return self.edges; },
            nb::sig("def edges(self) -> numpy.typing.NDArray[numpy.void]"),
            R"(Measured stretches of the squares' sides, (N,) of opms.EDGE_DTYPE.

side 0: X = -10 mm, 1: Y = -10 mm, 2: X = +10 mm, 3: Y = +10 mm; bar_m: (X, Y) in the bar plane;
normal: unit normal in the picture, out of the square; sigma_px: along the normal; shift_gain:
pixels by which the edge moves when the common edge shift grows by one.)");

    nb::class_<BarDetector>(module, "BarDetector", R"(Finds bars of kind hope33; holds all memory.

Calls from several threads on one detector are taken one after the other; different detectors run
in parallel.)")
        .def(nb::init<const opms_lens_t &, int32_t>(), "lens"_a, nb::kw_only(),
             "min_square_px"_a = 7, R"(For pictures of one lens, whose size is that of the pictures.

min_square_px: shortest side of a square that the search must not miss, 6 to 64.
Raises Error (ERR_ARG, ERR_DOMAIN, ERR_MEMORY).)")
        .def("detect", &BarDetector::detect, "image"_a, nb::kw_only(), "roi"_a = nb::none(),
             "hint"_a = nb::none(), "white_level"_a = 0,
             nb::sig("def detect(self, image: numpy.typing.NDArray[numpy.uint8] | "
                     "numpy.typing.NDArray[numpy.uint16], *, "
                     "roi: tuple[int, int, int, int] | None = None, "
                     "hint: Transform | None = None, white_level: int = 0) -> BarDetection"),
             R"(Find the bar in a picture.

image: (height, width), uint8 or uint16, rows at any distance, read in place without a copy; do not
change it meanwhile. roi: (x_px, y_px, width_px, height_px) in which squares are sought. hint:
where the bar is expected, camera to bar. white_level: grey level at saturation, 0 for 255 or 65535.
Raises Error (ERR_ARG); "no bar" is no error but a state. Releases the GIL.)");
}
