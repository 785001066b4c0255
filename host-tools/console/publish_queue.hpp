/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A bounded queue from many threads to one, in which nobody ever waits for anybody.
 *
 * The session's threads publish through it, and a pose must never be late because somebody listens
 * slowly. So there is no lock. Each cell carries a ticket that says whose turn it is: a producer
 * claims a position by one compare-and-swap, fills the cell, and opens it to the consumer by
 * setting the ticket. A producer repeats only when another one has claimed the same position in
 * that instant, which means that the queue as a whole went on. A full queue refuses at once. (The
 * scheme is Dmitry Vyukov's bounded queue, with one consumer.) */
#ifndef OPMS_CONSOLE_PUBLISH_QUEUE_HPP
#define OPMS_CONSOLE_PUBLISH_QUEUE_HPP

#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

namespace opms_host {

template <typename Item> class PublishQueue {
public:
    /** @param capacity  A power of two. */
    explicit PublishQueue(std::size_t capacity) : cells_(capacity), mask_(capacity - 1)
    {
        for (std::size_t i = 0; i < capacity; i++) {
            cells_[i].ticket.store(i, std::memory_order_relaxed);
        }
    }

    /** Any thread. @return false, and @p item is as it was, where the queue is full. */
    bool push(Item &item)
    {
        std::size_t position = tail_.load(std::memory_order_relaxed);
        for (;;) {
            Cell &cell = cells_[position & mask_];
            const std::size_t ticket = cell.ticket.load(std::memory_order_acquire);
            if (ticket == position) {
                if (tail_.compare_exchange_weak(position, position + 1,
                                                std::memory_order_relaxed)) {
                    cell.item = std::move(item);
                    cell.ticket.store(position + 1, std::memory_order_release);
                    return true;
                }
            } else if (static_cast<std::ptrdiff_t>(ticket - position) < 0) {
                return false; /* still holds what came a whole round ago */
            } else {
                position = tail_.load(std::memory_order_relaxed);
            }
        }
    }

    /** One thread. @return false where there is nothing. */
    bool pop(Item &item)
    {
        Cell &cell = cells_[head_ & mask_];
        if (cell.ticket.load(std::memory_order_acquire) != head_ + 1) {
            return false;
        }
        item = std::move(cell.item);
        cell.item = Item();
        cell.ticket.store(head_ + cells_.size(), std::memory_order_release);
        ++head_;
        return true;
    }

private:
    struct Cell {
        std::atomic<std::size_t> ticket{0};
        Item item;
    };

    std::vector<Cell> cells_;
    const std::size_t mask_;
    /* Apart, so that producers and the consumer do not share a cache line. */
    alignas(64) std::atomic<std::size_t> tail_{0};
    alignas(64) std::size_t head_ = 0;
};

}  // namespace opms_host
#endif
