/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The private extension `_opms`; the package `opms` re-exports it. A line here converts, calls and
 * raises; it computes nothing. */
#include "py_convert.h"

namespace {

void bind_status(nb::module_ &module)
{
    nb::enum_<opms_status_t>(module, "Status", nb::is_arithmetic(),
                             "Status of a call; failures are negative.")
        .value("OK", OPMS_OK)
        .value("ERR_ARG", OPMS_ERR_ARG, "An argument is out of range or not finite.")
        .value("ERR_MEMORY", OPMS_ERR_MEMORY, "An allocation failed.")
        .value("ERR_CAPACITY", OPMS_ERR_CAPACITY, "A buffer is too small.")
        .value("ERR_DOMAIN", OPMS_ERR_DOMAIN, "No solution exists, e.g. no ray reaches a pixel.")
        .value("ERR_CONVERGE", OPMS_ERR_CONVERGE, "An iteration did not converge.")
        .value("ERR_INTERNAL", OPMS_ERR_INTERNAL, "A defect of the library; please report it.")
        .value("ERR_DEVICE", OPMS_ERR_DEVICE, "No such device, several, gone, or no permission.")
        .value("ERR_TIMEOUT", OPMS_ERR_TIMEOUT, "The device did not answer in time.")
        .value("ERR_VERSION", OPMS_ERR_VERSION, "The device speaks another protocol version.")
        .value("ERR_REFUSED", OPMS_ERR_REFUSED, "The device refused; the message says why.");
}

void bind_constants(nb::module_ &module)
{
    module.def("version", &opms_version, "Version of the library, as major.minor.patch.");
    module.attr("BAR_SQUARES") = OPMS_BAR_SQUARES;
    module.attr("BAR_PITCH_M") = OPMS_BAR_PITCH_M;
    module.attr("BAR_SQUARE_M") = OPMS_BAR_SQUARE_M;
    module.attr("BAR_ORIGIN") = OPMS_BAR_ORIGIN;
    module.attr("SQUARE_DTYPE") = py_square_dtype();
    module.attr("EDGE_DTYPE") = py_edge_dtype();
    module.attr("NODE_DTYPE") = py_node_dtype();
    module.attr("GRID_PITCH_M") = OPMS_GRID_PITCH_M;
    module.attr("GRID_LINE_M") = OPMS_GRID_LINE_M;
    module.attr("GRID_CENTRE") = OPMS_GRID_CENTRE;
    module.attr("GRID_NODES_X") = OPMS_GRID_NODES_X;
    module.attr("GRID_NODES_Y") = OPMS_GRID_NODES_Y;
}

} // namespace

NB_MODULE(_opms, module)
{
    module.doc() = "Binding of libopms; use the package opms.";
    bind_status(module);
    bind_constants(module);
    py_bind_lens(module);
    py_bind_pose(module);
    py_bind_bar(module);
    py_bind_locate(module);
    py_bind_blur(module);
    py_bind_grid(module);
    py_bind_calib(module);
    py_bind_expect(module);
    py_bind_wire(module);
}
