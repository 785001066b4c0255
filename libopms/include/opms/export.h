/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * OPMS_API marks what the shared library exports; all else is hidden. */
#ifndef OPMS_EXPORT_H
#define OPMS_EXPORT_H

#if defined(OPMS_STATIC)
#define OPMS_API
#elif defined(_WIN32)
#if defined(OPMS_BUILD)
#define OPMS_API __declspec(dllexport)
#else
#define OPMS_API __declspec(dllimport)
#endif
#else
#define OPMS_API __attribute__((visibility("default")))
#endif

#endif
