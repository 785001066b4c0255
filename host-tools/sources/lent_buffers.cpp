/* SPDX-License-Identifier: Apache-2.0 */
#include "lent_buffers.hpp"

#include <chrono>
#include <utility>

namespace opms_host {

std::uint32_t LentBuffers::lent() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return lent_;
}

bool LentBuffers::wait_for_free(std::uint32_t timeout_ms)
{
    std::unique_lock<std::mutex> lock(mutex_);
    returned_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                       [this] { return lent_ < most_ || woken_; });
    woken_ = false;
    return lent_ < most_;
}

void LentBuffers::wake()
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        woken_ = true;
    }
    returned_.notify_all();
}

std::shared_ptr<const void> LentBuffers::lend(std::function<void()> give_back)
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        ++lent_;
    }
    return std::shared_ptr<const void>(
        this, [self = shared_from_this(), give_back = std::move(give_back)](const void *) {
            give_back();
            {
                const std::lock_guard<std::mutex> lock(self->mutex_);
                --self->lent_;
            }
            self->returned_.notify_all();
        });
}

std::shared_ptr<const void> LentBuffers::lend(std::shared_ptr<const void> memory)
{
    return lend([memory = std::move(memory)]() mutable { memory.reset(); });
}

}  // namespace opms_host
