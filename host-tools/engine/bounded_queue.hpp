/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A queue between two threads that never grows beyond its size: who is too fast waits. */
#ifndef OPMS_ENGINE_BOUNDED_QUEUE_HPP
#define OPMS_ENGINE_BOUNDED_QUEUE_HPP

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <utility>

namespace opms_host {

/** Any thread, any time. */
template <typename Item> class BoundedQueue {
public:
    explicit BoundedQueue(std::size_t most) : most_(most) {}

    /** Wait for a place. @return false: closed, the item was not taken. */
    bool push(Item item)
    {
        std::unique_lock<std::mutex> lock(mutex_);
        room_.wait(lock, [this] { return closed_ || items_.size() < most_; });
        return put(std::move(item));
    }

    /** Only where nobody else waits: for what may be left out. */
    bool push_if_empty(Item item)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        return items_.empty() && put(std::move(item));
    }

    /** Wait for an item. @return false: closed, and all items have been taken. */
    bool pop(Item &item)
    {
        std::unique_lock<std::mutex> lock(mutex_);
        filled_.wait(lock, [this] { return closed_ || !items_.empty(); });
        if (items_.empty()) {
            return false;
        }
        item = std::move(items_.front());
        items_.pop_front();
        room_.notify_one();
        return true;
    }

    /** No more go in; those that are there may still be taken. */
    void close()
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        closed_ = true;
        room_.notify_all();
        filled_.notify_all();
    }

    std::size_t size() const
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        return items_.size();
    }

private:
    bool put(Item &&item)
    {
        if (closed_) {
            return false;
        }
        items_.push_back(std::move(item));
        filled_.notify_one();
        return true;
    }

    const std::size_t most_;
    mutable std::mutex mutex_;
    std::condition_variable room_, filled_;
    std::deque<Item> items_;
    bool closed_ = false;
};

}  // namespace opms_host
#endif
