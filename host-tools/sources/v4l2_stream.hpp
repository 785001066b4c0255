/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * One opening of a V4L2 camera: its buffers, and the pictures in them. */
#ifndef OPMS_SOURCES_V4L2_STREAM_HPP
#define OPMS_SOURCES_V4L2_STREAM_HPP

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "v4l2_calls.hpp"
#include "v4l2_pixels.hpp"

namespace opms_host {

/** What was agreed with the driver. */
struct V4l2Shape {
    const V4l2Pixels *pixels = nullptr;
    std::uint16_t white_level = 255;
    std::int32_t width_px = 0, height_px = 0;
    std::ptrdiff_t stride_bytes = 0;
    std::size_t grey_bytes = 0; /**< of a whole picture's rows with grey in them */
    bool monotonic = false;     /**< stamps are of the host's monotonic clock */
    std::string card, bus;      /**< who it is */
};

/** A filled buffer. */
struct V4l2Filled {
    std::uint32_t index = 0, sequence = 0;
    std::int64_t t_us = 0;      /**< as stamped */
    bool monotonic = false, damaged = false, starved = false; /**< none was queued before it */
    const void *pixels = nullptr;
};

enum class V4l2Take { filled, none, broken, gone };

/** Any thread, any time. Lives until the last picture in its buffers has gone; it is only then that
 * they are unmapped. */
class V4l2Stream : public std::enable_shared_from_this<V4l2Stream> {
public:
    /** Open and agree on a format. @param size  "WxH"; empty: as it is.
     * @return NULL on failure, with errno ENOENT, ENODEV or ENXIO where it is not there. */
    static std::shared_ptr<V4l2Stream> open(std::shared_ptr<V4l2Calls> calls,
                                            const std::string &path, const std::string &size,
                                            std::string &error);
    ~V4l2Stream();

    const V4l2Shape &shape() const { return shape_; }
    int fd() const { return fd_; }

    /** @param buffers  As many, or as the driver has them; those that still are in use stay so. */
    bool start(std::uint32_t buffers, std::string &error);
    void stop();
    /** The device has gone: nothing more is asked of it. */
    void abandon();
    V4l2Take take(V4l2Filled &filled, std::string &error);
    /** Back to the driver. */
    void give_back(std::uint32_t index);
    /** Whether the driver has a buffer to fill. */
    bool has_queued() const;
    std::uint32_t buffers() const;
    std::uint32_t lent() const;

private:
    struct Buffer {
        void *memory = nullptr;
        std::size_t size = 0;
        enum { idle, queued, lent } place = idle;
    };

    explicit V4l2Stream(std::shared_ptr<V4l2Calls> calls) : calls_(std::move(calls)) {}
    bool agree(const std::string &size, std::string &error);
    bool choose_format(const std::string &size, std::string &error);
    void learn_stamps();
    bool allocate(std::uint32_t buffers, std::string &error);
    bool queue(std::uint32_t index);
    std::uint32_t count(int place) const;
    void unmap_all();

    const std::shared_ptr<V4l2Calls> calls_;
    V4l2Shape shape_;
    int fd_ = -1;
    mutable std::mutex mutex_;
    std::vector<Buffer> buffers_;
    bool streaming_ = false, starved_ = false, abandoned_ = false;
};

}  // namespace opms_host
#endif
