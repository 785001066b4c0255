/* SPDX-License-Identifier: Apache-2.0 */
#include "py_convert.h"

#include <cstddef>
#include <cstring>
#include <limits>
#include <string>

namespace {

nb::object numpy(const char *name)
{
    return nb::module_::import_("numpy").attr(name);
}

/** Fields of a struct become a numpy dtype with the compiler's own offsets. */
class DtypeBuilder {
public:
    void add(const char *name, const char *format, size_t offset)
    {
        names_.append(name);
        formats_.append(format);
        offsets_.append(offset);
    }

    nb::object build(size_t size) const
    {
        nb::dict fields;
        fields["names"] = names_;
        fields["formats"] = formats_;
        fields["offsets"] = offsets_;
        fields["itemsize"] = size;
        return numpy("dtype")(fields);
    }

private:
    nb::list names_, formats_, offsets_;
};

nb::object new_array(const void *items, size_t item_bytes, size_t count, const nb::object &dtype)
{
    nb::object array = numpy("empty")(count, dtype);
    if (count > 0) {
        Py_buffer view;
        if (PyObject_GetBuffer(array.ptr(), &view, PyBUF_WRITABLE | PyBUF_C_CONTIGUOUS) != 0) {
            throw nb::python_error();
        }
        std::memcpy(view.buf, items, item_bytes * count);
        PyBuffer_Release(&view);
    }
    return array;
}

nb::object module_dtype(const char *name)
{
    return nb::module_::import_("opms._opms").attr(name);
}

} // namespace

void py_raise(const opms_error_t &error)
{
    nb::object type = nb::module_::import_("opms.errors").attr("Error");
    nb::object exception =
        type(nb::cast(error.code), nb::str(error.message), error.index, nb::str(error.stage));
    PyErr_SetObject(type.ptr(), exception.ptr());
    throw nb::python_error();
}

opms_image_t py_image(const PyImage &pixels, uint16_t white_level)
{
    const bool grey8 = pixels.dtype() == nb::dtype<uint8_t>();
    if (!grey8 && pixels.dtype() != nb::dtype<uint16_t>()) {
        throw nb::type_error("image: the pixels must be uint8 or uint16");
    }
    if (pixels.ndim() != 2) {
        throw nb::type_error("image: the array must be two-dimensional (rows, columns)");
    }
    const size_t limit = static_cast<size_t>(std::numeric_limits<int32_t>::max());
    const size_t height = pixels.shape(0), width = pixels.shape(1);
    if (height > limit || width > limit) {
        throw nb::value_error("image: the array is too large");
    }
    if (width > 1 && pixels.stride(1) != 1) {
        throw nb::value_error("image: the pixels of a row must be neighbours in memory; "
                              "use numpy.ascontiguousarray()");
    }
    const ptrdiff_t pixel_bytes = grey8 ? 1 : 2;
    opms_image_t image = {};
    image.pixels = pixels.data();
    image.width_px = static_cast<int32_t>(width);
    image.height_px = static_cast<int32_t>(height);
    /* numpy leaves the stride of a single row undefined. */
    image.stride_bytes = height > 1 ? static_cast<ptrdiff_t>(pixels.stride(0)) * pixel_bytes
                                    : static_cast<ptrdiff_t>(width) * pixel_bytes;
    image.format = grey8 ? OPMS_PIXEL_GREY8 : OPMS_PIXEL_GREY16;
    image.white_level = white_level;
    return image;
}

nb::object py_square_dtype()
{
    DtypeBuilder dtype;
    dtype.add("index", "i4", offsetof(opms_square_t, index));
    dtype.add("edges", "u4", offsetof(opms_square_t, edges));
    dtype.add("corners_px", "(4,2)f8", offsetof(opms_square_t, corners_px));
    return dtype.build(sizeof(opms_square_t));
}

nb::object py_edge_dtype()
{
    DtypeBuilder dtype;
    dtype.add("square", "i4", offsetof(opms_edge_t, square));
    dtype.add("side", "i4", offsetof(opms_edge_t, side));
    dtype.add("bar_m", "(2,)f8", offsetof(opms_edge_t, bar_m));
    dtype.add("px", "(2,)f8", offsetof(opms_edge_t, px));
    dtype.add("normal", "(2,)f8", offsetof(opms_edge_t, normal));
    dtype.add("sigma_px", "f8", offsetof(opms_edge_t, sigma_px));
    dtype.add("shift_gain", "f8", offsetof(opms_edge_t, shift_gain));
    return dtype.build(sizeof(opms_edge_t));
}

nb::object py_node_dtype()
{
    DtypeBuilder dtype;
    dtype.add("label", "(2,)i4", offsetof(opms_node_t, label));
    dtype.add("px", "(2,)f8", offsetof(opms_node_t, px));
    dtype.add("sigma_px", "f8", offsetof(opms_node_t, sigma_px));
    return dtype.build(sizeof(opms_node_t));
}

nb::object py_squares(const opms_square_t *squares, size_t count)
{
    return new_array(squares, sizeof *squares, count, module_dtype("SQUARE_DTYPE"));
}

nb::object py_edges(const opms_edge_t *edges, size_t count)
{
    return new_array(edges, sizeof *edges, count, module_dtype("EDGE_DTYPE"));
}

nb::object py_nodes(const opms_node_t *nodes, size_t count)
{
    return new_array(nodes, sizeof *nodes, count, module_dtype("NODE_DTYPE"));
}

nb::object py_doubles(const double *values, size_t count)
{
    return new_array(values, sizeof *values, count, numpy("dtype")("f8"));
}

PyRecords::PyRecords(nb::handle array, const char *dtype, const char *argument)
{
    const nb::object expected = module_dtype(dtype);
    if (!nb::hasattr(array, "dtype") || !array.attr("dtype").equal(expected) ||
        nb::cast<int>(array.attr("ndim")) != 1) {
        throw nb::type_error((std::string(argument) +
                              ": must be a one-dimensional array of " + dtype)
                                 .c_str());
    }
    const nb::object packed = numpy("ascontiguousarray")(array);
    if (PyObject_GetBuffer(packed.ptr(), &view_, PyBUF_C_CONTIGUOUS) != 0) {
        throw nb::python_error();
    }
}

PyRecords::~PyRecords()
{
    PyBuffer_Release(&view_);
}

uint32_t PyRecords::count_of(size_t item_bytes) const
{
    const size_t count = static_cast<size_t>(view_.len) / item_bytes;
    const size_t limit = std::numeric_limits<uint32_t>::max();
    return static_cast<uint32_t>(count < limit ? count : limit);
}
