/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms.grid: from a picture of the calibration grid to its labelled nodes. */
#include "py_handle.h"

#include <vector>

namespace {

using namespace nb::literals;

struct GridDetection {
    opms_grid_summary_t summary;
    nb::object nodes;
};

class GridDetector {
public:
    GridDetector(int32_t width_px, int32_t height_px, double min_pitch_px)
        : detector_([&](opms_grid_detector_t **detector, opms_error_t *err) {
              opms_grid_options_t options;
              opms_grid_options_init(&options);
              options.width_px = width_px;
              options.height_px = height_px;
              options.min_pitch_px = min_pitch_px;
              return opms_grid_detector_create(&options, detector, err);
          })
    {
    }

    GridDetection detect(const PyImage &image, uint16_t white_level)
    {
        const opms_image_t view = py_image(image, white_level);
        GridDetection found = {};
        std::vector<opms_node_t> nodes;
        detector_.run([&](opms_grid_detector_t *detector, opms_error_t *err) {
            OPMS_PY_TRY(opms_grid_detect(detector, &view, &found.summary, err));
            uint32_t count = 0;
            const opms_node_t *n = opms_grid_nodes(detector, &count);
            nodes.assign(n, n + count);
            return OPMS_OK;
        });
        found.nodes = py_nodes(nodes.data(), nodes.size());
        return found;
    }

private:
    PyHandle<opms_grid_detector_t, opms_grid_detector_destroy> detector_;
};

nb::object relabel(nb::handle known, nb::handle nodes)
{
    const PyNodes from(known, "known"), given(nodes, "nodes");
    std::vector<opms_node_t> labelled(given.data(), given.data() + given.count());
    uint32_t certain = 0;
    py_call([&](opms_error_t *err) {
        return opms_grid_relabel(from.data(), from.count(), labelled.data(), given.count(),
                                 &certain, err);
    });
    return certain ? py_nodes(labelled.data(), labelled.size()) : nb::none();
}

void bind_summary(nb::module_ &module)
{
    nb::enum_<opms_grid_state_t>(module, "GridState", nb::is_arithmetic(), "What a picture shows.")
        .value("ABSENT", OPMS_GRID_ABSENT, "No grid is seen.")
        .value("LABELLED", OPMS_GRID_LABELLED, "Nodes found, labels certain.")
        .value("UNLABELLED", OPMS_GRID_UNLABELLED,
               "Nodes found, but not the marker: labels begin anywhere, turned by any quarter.");

    nb::class_<opms_grid_summary_t>(module, "GridSummary", "The picture of the grid as a whole.")
        .def_ro("state", &opms_grid_summary_t::state, "A GridState.")
        .def_ro("node_count", &opms_grid_summary_t::node_count, "Nodes found.")
        .def_ro("noise", &opms_grid_summary_t::noise,
                "Standard deviation of the grey levels about the line model.")
        .def_ro("contrast", &opms_grid_summary_t::contrast,
                "Median grey levels from white to the depth of a line.")
        .def_ro("blur_px", &opms_grid_summary_t::blur_px, "Standard deviation of the blur.")
        .def_ro("marker_margin", &opms_grid_summary_t::marker_margin,
                "Contrast of the marker over the next best place, 0 to 1; 0 if none.");
}

} // namespace

void py_bind_grid(nb::module_ &module)
{
    bind_summary(module);
    nb::class_<GridDetection>(module, "GridDetection", "What opms.grid.Detector.detect() found.")
        .def_ro("summary", &GridDetection::summary, "State and figures.")
        .def_prop_ro(
            "nodes", [](const GridDetection &self) { return self.nodes; },
            nb::sig("def nodes(self) -> numpy.typing.NDArray[numpy.void]"),
            R"(Nodes by label, (N,) of opms.grid.NODE_DTYPE.

label: (N, 2), (50 + i, 50 + j) for the node at (i, j) pitches of the grid frame; px: (N, 2),
(u, v); sigma_px: standard deviation of each coordinate.)");

    nb::class_<GridDetector>(module, "GridDetector",
                             R"(Finds grids of kind a0-25; holds all memory.

Calls from several threads on one detector are taken one after the other; different detectors run
in parallel.)")
        .def(nb::init<int32_t, int32_t, double>(), "width_px"_a, "height_px"_a, nb::kw_only(),
             "min_pitch_px"_a = 9.0, R"(For pictures of one size, 16 to 16384 px each way.

min_pitch_px: shortest distance between lines that is sought, 8 to 100.
Raises Error (ERR_ARG, ERR_MEMORY).)")
        .def("detect", &GridDetector::detect, "image"_a, nb::kw_only(), "white_level"_a = 0,
             nb::sig("def detect(self, image: numpy.typing.NDArray[numpy.uint8] | "
                     "numpy.typing.NDArray[numpy.uint16], *, white_level: int = 0) -> "
                     "GridDetection"),
             R"(Find the grid in a picture. No lens is needed.

image: (height_px, width_px), uint8 or uint16, rows at any distance, read in place without a copy;
do not change it meanwhile. white_level: grey level at saturation, 0 for 255 or 65535.
Raises Error (ERR_ARG); "no grid" is no error but a state. Releases the GIL.)");

    module.def("grid_relabel", &relabel, "known"_a, "nodes"_a,
               nb::sig("def grid_relabel(known: numpy.typing.NDArray[numpy.void], "
                       "nodes: numpy.typing.NDArray[numpy.void]) -> "
                       "numpy.typing.NDArray[numpy.void] | None"),
               R"(Label the nodes of a picture whose marker is hidden from a neighbouring picture.

known: (M,) labelled nodes of a picture taken shortly before or after; nodes: (N,); both of
opms.grid.NODE_DTYPE. Returns new nodes with their labels, or None where these are not certain: the
camera must have moved by much less than half a pitch between both.
Raises Error (ERR_ARG). Pure, any thread; releases the GIL.)");
}
