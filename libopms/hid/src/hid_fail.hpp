/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Errors of opms::hid, and the edge of C that nothing is thrown across. */
#ifndef OPMS_HID_HID_FAIL_HPP
#define OPMS_HID_HID_FAIL_HPP

#include <exception>
#include <new>
#include <string>

#include "box_transport.hpp"

namespace opms_hid {

/** Record a failure in err (may be NULL) and return its code. */
opms_status_t fail(opms_error_t *err, opms_status_t code, const std::string &message);
/** What a request's end means to a caller. @param what  Was being done, such as "arm". */
opms_status_t fail_io(opms_error_t *err, Io io, const char *what);

/** Call `body`, a callable that returns a status; what it throws becomes one. */
template <typename Body> opms_status_t guarded(opms_error_t *err, Body body)
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return fail(err, OPMS_ERR_MEMORY, "out of memory");
    } catch (const std::exception &error) {
        return fail(err, OPMS_ERR_INTERNAL, error.what());
    }
}

} // namespace opms_hid

#endif
