/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The newest picture with its pose, for displays that ask. */
#ifndef OPMS_ENGINE_NEWEST_PICTURE_HPP
#define OPMS_ENGINE_NEWEST_PICTURE_HPP

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "scan_records.hpp"

namespace opms_host {

/** Any thread, any time. */
class NewestPicture {
public:
    /** @param picture  NULL: the camera needs its buffer back; the pose alone is kept. */
    void set(FramePtr picture, std::shared_ptr<const PoseRecord> pose)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        picture_ = std::move(picture);
        pose_ = std::move(pose);
        ++count_;
    }

    void get(FramePtr &picture, std::shared_ptr<const PoseRecord> &pose) const
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        picture = picture_;
        pose = pose_;
    }

    /** How often it was set. */
    std::uint64_t count() const
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        return count_;
    }

private:
    mutable std::mutex mutex_;
    FramePtr picture_;
    std::shared_ptr<const PoseRecord> pose_;
    std::uint64_t count_ = 0;
};

}  // namespace opms_host
#endif
