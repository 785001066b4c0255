/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of a GenICam camera, lent out in the buffers in which they came. */
#ifndef OPMS_SOURCES_ARAVIS_STREAM_HPP
#define OPMS_SOURCES_ARAVIS_STREAM_HPP

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "aravis_camera.hpp"
#include "host_clock.hpp"
#include "lent_buffers.hpp"

namespace opms_host {

/** From start to stop. Any thread; but stop() not from on_frame. */
class AravisStream : public std::enable_shared_from_this<AravisStream> {
public:
    /** Told of each picture by the stream's own thread. */
    using OnFrame = std::function<void(std::shared_ptr<Frame>)>;

    /** @return NULL on failure. */
    static std::shared_ptr<AravisStream> start(AravisCamera &camera, std::uint32_t buffers,
                                               const ExposureSetting &setting,
                                               std::shared_ptr<HostClock> clock, OnFrame on_frame,
                                               std::string &error);
    /** No on_frame after it. The camera itself is told by who owns it. */
    void stop();
    void exposure_changed(const ExposureSetting &setting);
    ExposureSetting exposure() const;
    /** All but what has been handed out. */
    SourceCounters counters() const;

private:
    AravisStream(const AravisCamera &camera, std::uint32_t buffers,
                 std::shared_ptr<HostClock> clock, OnFrame on_frame);
    bool begin(AravisCamera &camera, std::string &error);
    static void on_buffer(ArvStream *stream, gpointer user);
    void take(ArvStream *stream);
    std::shared_ptr<Frame> frame_of(ArvBuffer *buffer, bool damaged);
    void give_back(GObjectPtr<ArvBuffer> buffer);
    ExposureSetting setting_of(ArvBuffer *buffer, std::int64_t arrival_host_ns);

    const AravisFormat &format_;
    const SourceTraits traits_;
    const std::shared_ptr<HostClock> clock_;
    const OnFrame on_frame_;
    const std::shared_ptr<LentBuffers> lent_;
    GObjectPtr<ArvChunkParser> parser_; /* of the stream's thread */
    mutable std::mutex mutex_;
    GObjectPtr<ArvStream> stream_;      /* none after stop() */
    std::size_t payload_ = 0;           /* bytes of a buffer */
    gulong handler_ = 0;
    ExposureLog exposures_;
    SourceCounters counters_;
};

}  // namespace opms_host
#endif
