/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Version of libopms: the one place where it is written (CMake reads it here). */
#ifndef OPMS_VERSION_H
#define OPMS_VERSION_H

#include <opms/export.h>

#define OPMS_VERSION_MAJOR 0
#define OPMS_VERSION_MINOR 1
#define OPMS_VERSION_PATCH 0

#ifdef __cplusplus
extern "C" {
#endif

/** Version of the library that is running, as "major.minor.patch".
 *
 * @return A string with static storage; never freed. Any thread, any time.
 * @since 0.1 */
OPMS_API const char *opms_version(void);

#ifdef __cplusplus
}
#endif
#endif
