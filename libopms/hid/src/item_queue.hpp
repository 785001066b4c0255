/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The bounded queue between the threads of a box and who polls it. Any thread may call.
 *
 * Where it is full the newest items are lost, and an item OPMS_LOST_ITEMS stands in their place. */
#ifndef OPMS_HID_ITEM_QUEUE_HPP
#define OPMS_HID_ITEM_QUEUE_HPP

#include <condition_variable>
#include <mutex>
#include <vector>

#include "box_transport.hpp"

namespace opms_hid {

class ItemQueue {
public:
    explicit ItemQueue(size_t capacity) : items_(capacity) {}

    void push(const opms_box_item_t &item);
    /** @return Whether there was one before the deadline. */
    bool pop(opms_box_item_t &item, Clock::time_point deadline);
    uint64_t lost();

private:
    void append(const opms_box_item_t &item);
    opms_box_item_t loss();

    std::mutex mutex_;
    std::condition_variable filled_;
    std::vector<opms_box_item_t> items_; /* a ring */
    size_t first_ = 0, count_ = 0;
    uint32_t untold_ = 0; /* lost since an item told so */
    int64_t t_last_lost_ns_ = 0;
    uint64_t lost_ = 0;
};

} // namespace opms_hid

#endif
