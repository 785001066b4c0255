/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the binding files share: arguments in, results out, failures as opms.Error. */
#ifndef OPMS_PY_CONVERT_H
#define OPMS_PY_CONVERT_H

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <opms/opms.h>

#include <array>
#include <cstdint>
#include <optional>

namespace nb = nanobind;

using PyMatrix3 = nb::ndarray<const double, nb::shape<3, 3>, nb::c_contig, nb::device::cpu>;
using PyVector3 = nb::ndarray<const double, nb::shape<3>, nb::c_contig, nb::device::cpu>;
using PyMatrix6 = nb::ndarray<const double, nb::shape<6, 6>, nb::c_contig, nb::device::cpu>;
using PyMatrix68 = nb::ndarray<const double, nb::shape<6, 8>, nb::c_contig, nb::device::cpu>;
using PyMatrix8 = nb::ndarray<const double, nb::shape<8, 8>, nb::c_contig, nb::device::cpu>;
using PyImage = nb::ndarray<nb::ro, nb::device::cpu>;
using PyRoi = std::optional<std::array<int32_t, 4>>;

/** The OPMS_COVARIANCE_ bits as Python's opms.Covariance. */
enum PyCovariance : uint32_t {};

/** Raise opms.Error for a failed call. */
[[noreturn]] void py_raise(const opms_error_t &error);

/** View of a picture, no copy. TypeError or ValueError where it is no 2-D grey picture. */
opms_image_t py_image(const PyImage &pixels, uint16_t white_level);

inline opms_roi_t py_roi(const PyRoi &roi)
{
    return roi ? opms_roi_t{(*roi)[0], (*roi)[1], (*roi)[2], (*roi)[3]} : opms_roi_t{0, 0, 0, 0};
}

/** numpy dtypes of opms_square_t, opms_edge_t and opms_node_t. */
nb::object py_square_dtype();
nb::object py_edge_dtype();
nb::object py_node_dtype();

/** New structured arrays of the package's dtypes. */
nb::object py_squares(const opms_square_t *squares, size_t count);
nb::object py_edges(const opms_edge_t *edges, size_t count);
nb::object py_nodes(const opms_node_t *nodes, size_t count);
nb::object py_doubles(const double *values, size_t count);

/** Items of a structured array; TypeError where the dtype is another. Keeps the array alive and its
 * memory in place. */
class PyRecords {
public:
    /** `dtype` names it in the module, `argument` in the message. */
    PyRecords(nb::handle array, const char *dtype, const char *argument);
    ~PyRecords();
    PyRecords(const PyRecords &) = delete;
    PyRecords &operator=(const PyRecords &) = delete;

protected:
    /** Saturates: more than 32 bits hold is refused by the library, too. */
    uint32_t count_of(size_t item_bytes) const;
    Py_buffer view_{};
};

template <class Item> class PyItems : public PyRecords {
public:
    using PyRecords::PyRecords;
    const Item *data() const { return static_cast<const Item *>(view_.buf); }
    uint32_t count() const { return count_of(sizeof(Item)); }
};

struct PyEdges : PyItems<opms_edge_t> {
    explicit PyEdges(nb::handle array) : PyItems(array, "EDGE_DTYPE", "edges") {}
};

struct PyNodes : PyItems<opms_node_t> {
    PyNodes(nb::handle array, const char *argument) : PyItems(array, "NODE_DTYPE", argument) {}
};

/** Read-only numpy view into a bound value; the value lives as long as the view. */
template <size_t... Shape, class Owner>
nb::ndarray<nb::numpy, const double, nb::shape<Shape...>> py_view(Owner &owner, const double *data)
{
    return nb::ndarray<nb::numpy, const double, nb::shape<Shape...>>(data, {Shape...},
                                                                    nb::find(owner));
}

/** The parts of the module, one file each. */
void py_bind_lens(nb::module_ &module);
void py_bind_pose(nb::module_ &module);
void py_bind_bar(nb::module_ &module);
void py_bind_locate(nb::module_ &module);
void py_bind_blur(nb::module_ &module);
void py_bind_grid(nb::module_ &module);
void py_bind_calib(nb::module_ &module);
void py_bind_calib_results(nb::module_ &module);
void py_bind_expect(nb::module_ &module);
void py_bind_wire(nb::module_ &module);
void py_bind_wire_calls(nb::module_ &module);

#endif
