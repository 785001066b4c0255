/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rows of a recording as items of a box. */
#ifndef OPMS_SOURCES_RECORDED_ITEMS_HPP
#define OPMS_SOURCES_RECORDED_ITEMS_HPP

#include <string>
#include <vector>

#include <opms/hid.h>

#include "scan_reader.hpp"

namespace opms_host {

/** All that the box of a scan gave, by its arrival. @return false with @p error. */
bool recorded_items(ScanReader &reader, std::vector<opms_box_item_t> &items,
                      std::string &error);

/** The session of an item, or NULL where it has none. */
std::uint32_t *item_session(opms_box_item_t &item);

}  // namespace opms_host
#endif
