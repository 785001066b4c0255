/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a box tells, in words: events for people and programs. */
#ifndef OPMS_ENGINE_BOX_WORDS_HPP
#define OPMS_ENGINE_BOX_WORDS_HPP

#include <opms/hid.h>

#include "scan_records.hpp"

namespace opms_host {

struct BoxWords {
    EventRecord event;
    bool may_come_often = false; /**< for EventGate */
};

/** @return Whether the item is worth an event: pulses, pongs and statuses are not. */
bool box_item_words(const opms_box_item_t &item, BoxWords &words);

}  // namespace opms_host
#endif
