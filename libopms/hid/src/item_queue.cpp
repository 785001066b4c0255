/* SPDX-License-Identifier: Apache-2.0 */
#include "item_queue.hpp"

namespace opms_hid {

void ItemQueue::append(const opms_box_item_t &item)
{
    items_[(first_ + count_) % items_.size()] = item;
    ++count_;
}

opms_box_item_t ItemQueue::loss()
{
    opms_box_item_t item = {};
    item.kind = OPMS_ITEM_LOST;
    item.t_host_ns = t_last_lost_ns_;
    item.as.lost = {OPMS_LOST_ITEMS, 0, 0, untold_};
    untold_ = 0;
    return item;
}

void ItemQueue::push(const opms_box_item_t &item)
{
    const std::lock_guard<std::mutex> guard(mutex_);
    const size_t needed = untold_ ? 2 : 1;
    if (count_ + needed > items_.size()) {
        ++untold_;
        ++lost_;
        t_last_lost_ns_ = item.t_host_ns;
        return;
    }
    if (untold_) {
        append(loss());
    }
    append(item);
    filled_.notify_one();
}

bool ItemQueue::pop(opms_box_item_t &item, Clock::time_point deadline)
{
    std::unique_lock<std::mutex> lock(mutex_);
    if (!filled_.wait_until(lock, deadline, [this] { return count_ || untold_; })) {
        return false;
    }
    if (count_ == 0) {
        item = loss();
        return true;
    }
    item = items_[first_];
    first_ = (first_ + 1) % items_.size();
    --count_;
    return true;
}

uint64_t ItemQueue::lost()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    return lost_;
}

} // namespace opms_hid
