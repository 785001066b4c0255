/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where a box is, as --box says it. */
#ifndef OPMS_SOURCES_BOX_PLACE_HPP
#define OPMS_SOURCES_BOX_PLACE_HPP

#include <string>

#include <opms/hid.h>

/** The place that --box names ("hid", "hid:ID", "emulated", "emulated:PORT"), as options of
 * opms_box_open().
 * @param[out] error  Why it is none.
 * @return Whether it is one. */
bool box_place_parse(const std::string &text, opms_box_options_t &options, std::string &error);

#endif
