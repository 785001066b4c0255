/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The simulated camera's buffers: bounded, counted, reused. */
#ifndef OPMS_SIMULATED_WORLD_BUFFERS_HPP
#define OPMS_SIMULATED_WORLD_BUFFERS_HPP

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace opms_host {

/** The world's lock and what is rung when something in it changed. */
struct WorldBell {
    std::mutex mutex;
    std::condition_variable changed;
};

/** Any thread, any time. Lives as long as the last buffer that it has lent. */
class WorldBuffers : public std::enable_shared_from_this<WorldBuffers> {
public:
    /** @param bell  Rung when a buffer comes back. */
    WorldBuffers(std::uint32_t count, std::size_t bytes, std::shared_ptr<WorldBell> bell)
        : count_(count), bytes_(bytes), bell_(std::move(bell))
    {
    }
    std::uint32_t count() const { return count_; }
    std::uint32_t lent() const
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        return lent_;
    }
    /** The caller has seen to it that one is free. */
    std::shared_ptr<std::uint8_t> lend()
    {
        std::unique_ptr<std::uint8_t[]> memory;
        {
            const std::lock_guard<std::mutex> guard(mutex_);
            ++lent_;
            if (!free_.empty()) {
                memory = std::move(free_.back());
                free_.pop_back();
            }
        }
        if (!memory) {
            memory.reset(new std::uint8_t[bytes_]());
        }
        return {memory.release(), [self = shared_from_this()](std::uint8_t *pixels) {
                    self->take_back(pixels);
                }};
    }

private:
    /** Not with the world's lock held. */
    void take_back(std::uint8_t *pixels)
    {
        {
            const std::lock_guard<std::mutex> guard(mutex_);
            free_.emplace_back(pixels);
            --lent_;
        }
        // Who has just looked and found none is asleep once the lock can be had.
        const std::lock_guard<std::mutex> guard(bell_->mutex);
        bell_->changed.notify_all();
    }

    const std::uint32_t count_;
    const std::size_t bytes_;
    const std::shared_ptr<WorldBell> bell_;
    mutable std::mutex mutex_;
    std::vector<std::unique_ptr<std::uint8_t[]>> free_;
    std::uint32_t lent_ = 0;
};

}  // namespace opms_host
#endif
