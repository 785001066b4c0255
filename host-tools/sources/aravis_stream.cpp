/* SPDX-License-Identifier: Apache-2.0 */
/* Aravis fills buffers in a thread of its own and tells of each by a signal. There the picture is
 * stamped and passed on; its buffer comes back with the last user of the frame, also after the
 * stream has ended. */
#include "aravis_stream.hpp"

#include <cmath>
#include <cstring>
#include <utility>

namespace opms_host {
namespace {

/* A picture that is read out while the next one is exposed: one may be on its way at a change. */
constexpr std::uint32_t UNSURE_FRAMES = 1;

bool is_partial(ArvBufferStatus status)
{
    return status == ARV_BUFFER_STATUS_MISSING_PACKETS || status == ARV_BUFFER_STATUS_TIMEOUT ||
           status == ARV_BUFFER_STATUS_WRONG_PACKET_ID;
}

/* What is missing in the next picture must not be shown by this one. */
void blank(ArvBuffer *buffer, std::size_t allocated)
{
    size_t received = 0;
    const void *const data = arv_buffer_get_data(buffer, &received);
    std::memset(const_cast<void *>(data), 0, allocated);
}

}  // namespace

AravisStream::AravisStream(const AravisCamera &camera, std::uint32_t buffers,
                           std::shared_ptr<HostClock> clock, OnFrame on_frame)
    : format_(camera.format()), traits_(camera.traits()), clock_(std::move(clock)),
      on_frame_(std::move(on_frame)), lent_(LentBuffers::create(buffers)),
      exposures_(UNSURE_FRAMES)
{
}

std::shared_ptr<AravisStream> AravisStream::start(AravisCamera &camera, std::uint32_t buffers,
                                                  const ExposureSetting &setting,
                                                  std::shared_ptr<HostClock> clock,
                                                  OnFrame on_frame, std::string &error)
{
    std::shared_ptr<AravisStream> stream(
        new AravisStream(camera, buffers, std::move(clock), std::move(on_frame)));
    stream->exposures_.begin(setting);
    return stream->begin(camera, error) ? stream : nullptr;
}

bool AravisStream::begin(AravisCamera &camera, std::string &error)
{
    GFailure failure;
    parser_ = camera.chunk_parser();
    const guint payload = arv_camera_get_payload(camera.get(), failure.fresh());
    if (arv_camera_is_gv_device(camera.get())) {
        /* The packet socket is for root alone, and deaf where the way to the camera is not the
         * interface on which it was discovered. */
        arv_camera_gv_set_stream_options(camera.get(), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    }
    if (!failure && payload > 0) {
        stream_.reset(arv_camera_create_stream(camera.get(), nullptr, nullptr, failure.fresh()));
    }
    if (!stream_) {
        error = camera.id() + " gives no stream: " + failure.text();
        return false;
    }
    payload_ = payload;
    for (std::uint32_t i = 0; i < lent_->most(); ++i) {
        ArvBuffer *const buffer = arv_buffer_new_allocate(payload);
        blank(buffer, payload);
        arv_stream_push_buffer(stream_.get(), buffer);
    }
    handler_ = g_signal_connect(stream_.get(), "new-buffer", G_CALLBACK(on_buffer), this);
    arv_stream_set_emit_signals(stream_.get(), TRUE);
    arv_camera_start_acquisition(camera.get(), failure.fresh());
    if (failure) {
        stop();
        error = camera.id() + " does not start: " + failure.text();
        return false;
    }
    return true;
}

void AravisStream::stop()
{
    GObjectPtr<ArvStream> ending;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        ending = std::move(stream_);
    }
    if (ending) {
        arv_stream_set_emit_signals(ending.get(), FALSE);
        g_signal_handler_disconnect(ending.get(), handler_);
        ending.reset(); /* waits for its thread */
    }
}

void AravisStream::exposure_changed(const ExposureSetting &setting)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    exposures_.change(clock_->now_ns(), setting);
}

ExposureSetting AravisStream::exposure() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return exposures_.newest();
}

SourceCounters AravisStream::counters() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    SourceCounters counters = counters_;
    counters.lent = lent_->lent();
    counters.buffers = lent_->most();
    if (stream_) {
        guint64 completed = 0, failures = 0, underruns = 0;
        arv_stream_get_statistics(stream_.get(), &completed, &failures, &underruns);
        counters.no_buffer = underruns;
    }
    return counters;
}

void AravisStream::on_buffer(ArvStream *stream, gpointer user)
{
    static_cast<AravisStream *>(user)->take(stream);
}

void AravisStream::take(ArvStream *stream)
{
    GObjectPtr<ArvBuffer> buffer(arv_stream_try_pop_buffer(stream));
    if (!buffer) {
        return;
    }
    const ArvBufferStatus status = arv_buffer_get_status(buffer.get());
    const bool damaged = is_partial(status);
    std::shared_ptr<Frame> frame;
    if (status == ARV_BUFFER_STATUS_SUCCESS || damaged) {
        frame = frame_of(buffer.get(), damaged);
    }
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        counters_.failed += !frame && status != ARV_BUFFER_STATUS_CLEARED;
    }
    if (!frame) {
        give_back(std::move(buffer));
        return;
    }
    /* The buffer is released when the frame is: std::function wants copyable captures. */
    ArvBuffer *const raw = buffer.release();
    frame->memory = lent_->lend([self = shared_from_this(), raw] {
        self->give_back(GObjectPtr<ArvBuffer>(raw));
    });
    on_frame_(std::move(frame));
}

std::shared_ptr<Frame> AravisStream::frame_of(ArvBuffer *buffer, bool damaged)
{
    const std::size_t stride = static_cast<std::size_t>(traits_.width_px) *
                               (format_.grey == OPMS_PIXEL_GREY16 ? 2U : 1U);
    auto frame = std::make_shared<Frame>();
    frame->arrival_host_ns = clock_->now_ns();
    size_t size = 0;
    const void *pixels = nullptr;
    if (damaged) { /* what it says of itself may be what got lost */
        pixels = arv_buffer_get_data(buffer, &size);
        size = payload_;
        frame->flags = OPMS_FRAME_DAMAGED | OPMS_FRAME_NO_TIME;
    } else if (arv_buffer_get_n_parts(buffer) > 0 &&
               arv_buffer_get_image_width(buffer) == traits_.width_px &&
               arv_buffer_get_image_height(buffer) == traits_.height_px &&
               arv_buffer_get_image_pixel_format(buffer) == format_.code) {
        pixels = arv_buffer_get_image_data(buffer, &size);
    }
    if (!pixels || size < stride * static_cast<std::size_t>(traits_.height_px)) {
        return nullptr;
    }
    frame->image.pixels = pixels;
    frame->image.width_px = traits_.width_px;
    frame->image.height_px = traits_.height_px;
    frame->image.stride_bytes = static_cast<std::ptrdiff_t>(stride);
    frame->image.format = format_.grey;
    frame->image.white_level = format_.white_level;
    frame->frame_id = arv_buffer_get_frame_id(buffer);
    frame->camera_time_ticks = damaged ? 0 : arv_buffer_get_timestamp(buffer);
    const std::uint32_t id_bits = traits_.profile.frame_id_bits;
    /* Where the packet that brings the id got lost, the buffer has 0. */
    const bool has_none =
        frame->frame_id == 0 && (damaged || traits_.profile.frame_id_skips_0 != 0);
    if (has_none || (id_bits < 64 && frame->frame_id >> id_bits != 0)) {
        frame->flags |= OPMS_FRAME_NO_ID;
    }
    if (!traits_.profile.has_camera_time) {
        frame->flags |= OPMS_FRAME_NO_TIME;
    }
    const ExposureSetting setting = setting_of(damaged ? nullptr : buffer, frame->arrival_host_ns);
    frame->exposure_us = setting.exposure_us;
    frame->gain_db = setting.gain_db;
    return frame;
}

ExposureSetting AravisStream::setting_of(ArvBuffer *buffer, std::int64_t arrival_host_ns)
{
    ExposureSetting setting;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        setting = exposures_.take(arrival_host_ns);
    }
    if (parser_ && buffer) {
        GFailure failure;
        const double exposure_us = arv_chunk_parser_get_float_value(
            parser_.get(), buffer, "ChunkExposureTime", failure.fresh());
        setting.exposure_us = failure ? setting.exposure_us : exposure_us;
        const double gain_db = arv_chunk_parser_get_float_value(parser_.get(), buffer, "ChunkGain",
                                                                failure.fresh());
        setting.gain_db = failure ? setting.gain_db : gain_db;
    }
    return setting;
}

void AravisStream::give_back(GObjectPtr<ArvBuffer> buffer)
{
    blank(buffer.get(), payload_);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stream_) {
        arv_stream_push_buffer(stream_.get(), buffer.release());
    }
}

}  // namespace opms_host
