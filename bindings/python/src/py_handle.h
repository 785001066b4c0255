/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A handle of the library as a member of a Python class. */
#ifndef OPMS_PY_HANDLE_H
#define OPMS_PY_HANDLE_H

#include <mutex>

#include "py_convert.h"

/** Leave a call of PyHandle::run() with the status of a step that failed. */
#define OPMS_PY_TRY(step)                                                                          \
    do {                                                                                           \
        const opms_status_t py_status = (step);                                                    \
        if (py_status != OPMS_OK) {                                                                \
            return py_status;                                                                      \
        }                                                                                          \
    } while (0)

/** Owns a C handle, which serves one thread at a time; the lock queues the others. */
template <class Handle, void (*Destroy)(Handle *)> class PyHandle {
public:
    /** create(Handle **, opms_error_t *) gives a status. Raises opms.Error. */
    template <class Create> explicit PyHandle(const Create &create)
    {
        opms_error_t err = {};
        if (create(&handle_, &err) != OPMS_OK) {
            py_raise(err);
        }
    }
    ~PyHandle() { Destroy(handle_); }
    PyHandle(const PyHandle &) = delete;
    PyHandle &operator=(const PyHandle &) = delete;

    /** call(Handle *, opms_error_t *) gives a status; it runs without the GIL and alone, so what
     * the handle keeps only until its next call is copied there. Raises opms.Error. */
    template <class Call> void run(const Call &call)
    {
        opms_error_t err = {};
        opms_status_t status;
        {
            nb::gil_scoped_release release;
            std::lock_guard<std::mutex> one_at_a_time(busy_);
            status = call(handle_, &err);
        }
        if (status != OPMS_OK) {
            py_raise(err);
        }
    }

private:
    Handle *handle_ = nullptr;
    std::mutex busy_;
};

/** Call a pure function of the library without the GIL. Raises opms.Error. */
template <class Call> void py_call(const Call &call)
{
    opms_error_t err = {};
    opms_status_t status;
    {
        nb::gil_scoped_release release;
        status = call(&err);
    }
    if (status != OPMS_OK) {
        py_raise(err);
    }
}

#endif
