/* SPDX-License-Identifier: Apache-2.0 */
#include "v4l2_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include <linux/videodev2.h>

namespace opms_host {
namespace {

constexpr std::uint32_t CAPTURE = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr std::uint16_t LIMITED_RANGE_WHITE = 235;

std::string because(const std::string &what)
{
    return what + ": " + std::strerror(errno);
}

v4l2_buffer buffer_of(std::uint32_t index)
{
    v4l2_buffer buffer = {};
    buffer.index = index;
    buffer.type = CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    return buffer;
}

v4l2_requestbuffers request_of(std::uint32_t count)
{
    v4l2_requestbuffers request = {};
    request.count = count;
    request.type = CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    return request;
}

std::string text_of(const std::uint8_t *bytes, std::size_t size)
{
    const char *const text = reinterpret_cast<const char *>(bytes);
    return std::string(text, strnlen(text, size));
}

bool parse_size(const std::string &text, std::uint32_t &width, std::uint32_t &height)
{
    const char *const end = text.data() + text.size();
    const auto [x, first] = std::from_chars(text.data(), end, width);
    if (first != std::errc() || x == end || *x != 'x') {
        return false;
    }
    const auto [last, second] = std::from_chars(x + 1, end, height);
    return second == std::errc() && last == end;
}

}  // namespace

std::shared_ptr<V4l2Stream> V4l2Stream::open(std::shared_ptr<V4l2Calls> calls,
                                             const std::string &path, const std::string &size,
                                             std::string &error)
{
    std::shared_ptr<V4l2Stream> stream(new V4l2Stream(std::move(calls)));
    stream->fd_ = stream->calls_->open(path.c_str());
    if (stream->fd_ < 0) {
        const int why = errno;
        error = because(path) + (why == EACCES ? " (is the user in the group video?)" : "");
        errno = why;
        return nullptr;
    }
    if (!stream->agree(size, error)) {
        error = path + ": " + error;
        errno = EINVAL; /* it is there */
        return nullptr;
    }
    return stream;
}

V4l2Stream::~V4l2Stream()
{
    stop();
    unmap_all();
    if (fd_ >= 0) {
        calls_->close(fd_);
    }
}

bool V4l2Stream::agree(const std::string &size, std::string &error)
{
    v4l2_capability who = {};
    if (calls_->ioctl(fd_, VIDIOC_QUERYCAP, &who) < 0) {
        error = because("is no V4L2 device");
        return false;
    }
    const std::uint32_t can =
        (who.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? who.device_caps : who.capabilities;
    if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
        error = "does not stream pictures (single-planar capture is needed)";
        return false;
    }
    shape_.card = text_of(who.card, sizeof who.card);
    shape_.bus = text_of(who.bus_info, sizeof who.bus_info);
    if (!choose_format(size, error)) {
        return false;
    }
    learn_stamps();
    return true;
}

bool V4l2Stream::choose_format(const std::string &size, std::string &error)
{
    std::vector<std::uint32_t> offered;
    std::string names;
    v4l2_fmtdesc description = {};
    for (description.type = CAPTURE; calls_->ioctl(fd_, VIDIOC_ENUM_FMT, &description) == 0;
         ++description.index) {
        offered.push_back(description.pixelformat);
        names += (names.empty() ? "" : ", ") + fourcc_text(description.pixelformat);
    }
    const V4l2Pixels *const end = V4L2_PIXELS + V4L2_PIXELS_COUNT;
    const V4l2Pixels *const best = std::find_if(V4L2_PIXELS, end, [&](const V4l2Pixels &pixels) {
        return std::find(offered.begin(), offered.end(), pixels.fourcc) != offered.end();
    });
    v4l2_format format = {};
    format.type = CAPTURE;
    if (best == end) {
        error = "offers " + (names.empty() ? "no format" : names) +
                "; GREY, Y10, Y12, Y16, NV12 or YUYV is needed";
        return false;
    }
    if (calls_->ioctl(fd_, VIDIOC_G_FMT, &format) < 0) {
        error = because("its format cannot be read");
        return false;
    }
    v4l2_pix_format &pix = format.fmt.pix;
    if (!size.empty() && !parse_size(size, pix.width, pix.height)) {
        error = size + " is no size; give WIDTHxHEIGHT";
        return false;
    }
    const std::uint32_t width = pix.width, height = pix.height;
    pix.pixelformat = best->fourcc;
    pix.field = V4L2_FIELD_NONE;
    pix.bytesperline = pix.sizeimage = 0;
    if (calls_->ioctl(fd_, VIDIOC_S_FMT, &format) < 0 || pix.pixelformat != best->fourcc) {
        error = because("refuses the format " + fourcc_text(best->fourcc));
        return false;
    }
    if (!size.empty() && (pix.width != width || pix.height != height)) {
        error = "has no " + size + " px; the nearest is " + std::to_string(pix.width) + "x" +
                std::to_string(pix.height);
        return false;
    }
    const std::uint64_t row = std::uint64_t{best->bytes_a_pixel} * pix.width;
    if (pix.width < 16 || pix.height < 16 || pix.width > 16384 || pix.height > 16384 ||
        pix.bytesperline < row || pix.field != V4L2_FIELD_NONE) {
        error = "its pictures of " + std::to_string(pix.width) + " x " +
                std::to_string(pix.height) + " px cannot be used";
        return false;
    }
    shape_.pixels = best;
    const bool coloured = best->fourcc == V4L2_PIX_FMT_NV12 || best->fourcc == V4L2_PIX_FMT_YUYV;
    shape_.white_level = coloured && pix.quantization != V4L2_QUANTIZATION_FULL_RANGE
                             ? LIMITED_RANGE_WHITE : best->white_level;
    shape_.width_px = static_cast<std::int32_t>(pix.width);
    shape_.height_px = static_cast<std::int32_t>(pix.height);
    shape_.stride_bytes = static_cast<std::ptrdiff_t>(pix.bytesperline);
    shape_.grey_bytes = std::size_t{pix.bytesperline} * (pix.height - 1) + row;
    return true;
}

/* A driver says in each of its buffers what its stamps are; one is asked for to see it. */
void V4l2Stream::learn_stamps()
{
    v4l2_requestbuffers request = request_of(2);
    if (calls_->ioctl(fd_, VIDIOC_REQBUFS, &request) < 0) {
        return;
    }
    v4l2_buffer buffer = buffer_of(0);
    if (calls_->ioctl(fd_, VIDIOC_QUERYBUF, &buffer) == 0) {
        shape_.monotonic =
            (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    }
    request = request_of(0);
    calls_->ioctl(fd_, VIDIOC_REQBUFS, &request);
}

bool V4l2Stream::allocate(std::uint32_t buffers, std::string &error)
{
    if (count(Buffer::lent) > 0 || buffers_.size() == buffers) {
        return true; /* pictures in use stay where they are, and so do the others */
    }
    unmap_all();
    v4l2_requestbuffers request = request_of(buffers);
    if (calls_->ioctl(fd_, VIDIOC_REQBUFS, &request) < 0 || request.count == 0) {
        error = because("gives no buffers");
        return false;
    }
    for (std::uint32_t i = 0; i < request.count; ++i) {
        v4l2_buffer buffer = buffer_of(i);
        Buffer made;
        if (calls_->ioctl(fd_, VIDIOC_QUERYBUF, &buffer) == 0 &&
            buffer.length >= shape_.grey_bytes) {
            made.size = buffer.length;
            made.memory = calls_->map(fd_, buffer.length, buffer.m.offset);
        }
        if (!made.memory) {
            error = because("buffer " + std::to_string(i) + " cannot be used");
            return false;
        }
        buffers_.push_back(made);
    }
    return true;
}

void V4l2Stream::unmap_all()
{
    for (const Buffer &buffer : buffers_) {
        calls_->unmap(buffer.memory, buffer.size);
    }
    buffers_.clear();
}

bool V4l2Stream::start(std::uint32_t buffers, std::string &error)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!allocate(buffers, error)) {
        return false;
    }
    for (std::uint32_t i = 0; i < buffers_.size(); ++i) {
        if (buffers_[i].place == Buffer::idle && !queue(i)) {
            error = because("takes no buffers");
            return false;
        }
    }
    std::uint32_t type = CAPTURE;
    if (calls_->ioctl(fd_, VIDIOC_STREAMON, &type) < 0) {
        error = because("does not start");
        return false;
    }
    streaming_ = true;
    starved_ = count(Buffer::queued) == 0;
    return true;
}

void V4l2Stream::stop()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!streaming_) {
        return;
    }
    streaming_ = false;
    std::uint32_t type = CAPTURE;
    if (!abandoned_) {
        calls_->ioctl(fd_, VIDIOC_STREAMOFF, &type); /* takes all buffers out of the queue */
    }
    for (Buffer &buffer : buffers_) {
        if (buffer.place == Buffer::queued) {
            buffer.place = Buffer::idle;
        }
    }
}

void V4l2Stream::abandon()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    abandoned_ = true;
}

bool V4l2Stream::queue(std::uint32_t index)
{
    v4l2_buffer buffer = buffer_of(index);
    if (abandoned_ || calls_->ioctl(fd_, VIDIOC_QBUF, &buffer) < 0) {
        return false;
    }
    buffers_[index].place = Buffer::queued;
    return true;
}

V4l2Take V4l2Stream::take(V4l2Filled &filled, std::string &error)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!streaming_) {
        return V4l2Take::none;
    }
    v4l2_buffer buffer = buffer_of(0);
    if (calls_->ioctl(fd_, VIDIOC_DQBUF, &buffer) < 0) {
        if (errno == EAGAIN) {
            return V4l2Take::none;
        }
        error = because("a picture could not be taken");
        return errno == ENODEV ? V4l2Take::gone : V4l2Take::broken;
    }
    if (buffer.index >= buffers_.size()) {
        error = "the driver names a buffer that it does not have";
        return V4l2Take::broken;
    }
    Buffer &held = buffers_[buffer.index];
    held.place = Buffer::lent;
    const std::size_t came = std::min<std::size_t>(buffer.bytesused, held.size);
    filled.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || came < shape_.grey_bytes;
    if (came < shape_.grey_bytes) {
        /* What is missing would be the rows of an older picture. */
        std::memset(static_cast<char *>(held.memory) + came, 0, shape_.grey_bytes - came);
    }
    filled.index = buffer.index;
    filled.sequence = buffer.sequence;
    filled.t_us = std::int64_t{buffer.timestamp.tv_sec} * 1'000'000 + buffer.timestamp.tv_usec;
    filled.monotonic =
        (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    filled.starved = starved_;
    filled.pixels = held.memory;
    starved_ = count(Buffer::queued) == 0;
    return V4l2Take::filled;
}

void V4l2Stream::give_back(std::uint32_t index)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    buffers_[index].place = Buffer::idle;
    if (streaming_) {
        queue(index); /* one that the driver does not take back is idle until the next start */
    }
}

bool V4l2Stream::has_queued() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return count(Buffer::queued) > 0;
}

std::uint32_t V4l2Stream::buffers() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return static_cast<std::uint32_t>(buffers_.size());
}

std::uint32_t V4l2Stream::lent() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return count(Buffer::lent);
}

std::uint32_t V4l2Stream::count(int place) const
{
    return static_cast<std::uint32_t>(
        std::count_if(buffers_.begin(), buffers_.end(),
                      [place](const Buffer &buffer) { return buffer.place == place; }));
}

}  // namespace opms_host
