/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Many rows of numbers, in and out. */
#ifndef OPMS_PY_ROWS_H
#define OPMS_PY_ROWS_H

#include <memory>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

namespace nb = nanobind;

/** (N, 2) and (N, 3) arrays as arguments. */
using PyPoints2 = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using PyPoints3 = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

/** A new (N, Shape...) numpy array as a result. */
template <ssize_t... Shape>
using PyRows = nb::ndarray<nb::numpy, double, nb::shape<-1, Shape...>>;

/** An uninitialised (N, Shape...) array while the GIL may be released, and then a numpy array. */
template <ssize_t... Shape> class PyRowsBuffer {
public:
    explicit PyRowsBuffer(size_t rows) : rows_(rows), values_(new double[rows * row_size + 1]) {}
    double *row(size_t i) { return values_.get() + i * row_size; }
    PyRows<Shape...> release()
    {
        double *values = values_.get();
        nb::capsule owner(values, [](void *p) noexcept { delete[] static_cast<double *>(p); });
        values_.release();
        return PyRows<Shape...>(values, {rows_, static_cast<size_t>(Shape)...}, owner);
    }

private:
    static constexpr size_t row_size = (size_t{1} * ... * static_cast<size_t>(Shape));
    size_t rows_;
    std::unique_ptr<double[]> values_;
};

#endif
