/* SPDX-License-Identifier: Apache-2.0 */
#include "base/fail.h"

#include <stdarg.h>
#include <stdio.h>

#include <opms/version.h>

#define STRINGIFY_(x) #x
#define STRINGIFY(x) STRINGIFY_(x)

const char *opms_version(void)
{
    return STRINGIFY(OPMS_VERSION_MAJOR) "." STRINGIFY(OPMS_VERSION_MINOR) "." STRINGIFY(
        OPMS_VERSION_PATCH);
}

const char *opms_status_name(opms_status_t status)
{
    switch (status) {
    case OPMS_OK: return "OPMS_OK";
    case OPMS_ERR_ARG: return "OPMS_ERR_ARG";
    case OPMS_ERR_MEMORY: return "OPMS_ERR_MEMORY";
    case OPMS_ERR_CAPACITY: return "OPMS_ERR_CAPACITY";
    case OPMS_ERR_DOMAIN: return "OPMS_ERR_DOMAIN";
    case OPMS_ERR_CONVERGE: return "OPMS_ERR_CONVERGE";
    case OPMS_ERR_INTERNAL: return "OPMS_ERR_INTERNAL";
    case OPMS_ERR_DEVICE: return "OPMS_ERR_DEVICE";
    case OPMS_ERR_TIMEOUT: return "OPMS_ERR_TIMEOUT";
    case OPMS_ERR_VERSION: return "OPMS_ERR_VERSION";
    case OPMS_ERR_REFUSED: return "OPMS_ERR_REFUSED";
    }
    return "unknown status";
}

opms_status_t opms_fail(opms_error_t *err, opms_status_t code, const char *stage, int32_t index,
                        const char *format, ...)
{
    if (err) {
        err->code = code;
        err->index = index;
        snprintf(err->stage, sizeof err->stage, "%s", stage);
        va_list args;
        va_start(args, format);
        vsnprintf(err->message, sizeof err->message, format, args);
        va_end(args);
    }
    return code;
}
