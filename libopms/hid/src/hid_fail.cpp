/* SPDX-License-Identifier: Apache-2.0 */
#include "hid_fail.hpp"

#include <cstdio>

namespace opms_hid {

opms_status_t fail(opms_error_t *err, opms_status_t code, const std::string &message)
{
    if (err) {
        err->code = code;
        err->index = -1;
        std::snprintf(err->stage, sizeof err->stage, "hid");
        std::snprintf(err->message, sizeof err->message, "%s", message.c_str());
    }
    return code;
}

opms_status_t fail_io(opms_error_t *err, Io io, const char *what)
{
    const std::string subject = std::string("cannot ") + what + ": ";
    switch (io) {
    case Io::done: return OPMS_OK;
    case Io::stalled:
        return fail(err, OPMS_ERR_REFUSED, subject + "the box refused the transfer");
    case Io::gone: return fail(err, OPMS_ERR_DEVICE, subject + "the box is not plugged in");
    case Io::none:
    case Io::timed_out: break;
    }
    return fail(err, OPMS_ERR_TIMEOUT, subject + "the box did not answer in time");
}

} // namespace opms_hid
