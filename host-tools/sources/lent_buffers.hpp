/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Counts the pictures that are in use, so that there are never more of them than were asked for. */
#ifndef OPMS_SOURCES_LENT_BUFFERS_HPP
#define OPMS_SOURCES_LENT_BUFFERS_HPP

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>

namespace opms_host {

/** Any thread, any time. Lives as long as the last picture that it counts. */
class LentBuffers : public std::enable_shared_from_this<LentBuffers> {
public:
    static std::shared_ptr<LentBuffers> create(std::uint32_t most)
    {
        return std::shared_ptr<LentBuffers>(new LentBuffers(most));
    }

    std::uint32_t most() const { return most_; }
    std::uint32_t lent() const;
    /** Wait until one more may be lent, or a wake(). @return Whether one may. */
    bool wait_for_free(std::uint32_t timeout_ms);
    /** End a wait_for_free(), and the next one if none is going on. */
    void wake();
    /** Count one more for as long as the result lives. @param give_back  Called at its end. */
    std::shared_ptr<const void> lend(std::function<void()> give_back);
    /** The same, for memory that goes with its last user. */
    std::shared_ptr<const void> lend(std::shared_ptr<const void> memory);

private:
    explicit LentBuffers(std::uint32_t most) : most_(most) {}

    const std::uint32_t most_;
    mutable std::mutex mutex_;
    std::condition_variable returned_;
    std::uint32_t lent_ = 0;
    bool woken_ = false;
};

}  // namespace opms_host
#endif
