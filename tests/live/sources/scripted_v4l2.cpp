/* SPDX-License-Identifier: Apache-2.0 */
#include "scripted_v4l2.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace {
constexpr int CAMERA_FD = 1000000; /* none that the system gives */
}

ScriptedV4l2::~ScriptedV4l2() = default;

int ScriptedV4l2::fail(int error) const
{
    errno = error;
    return -1;
}

int ScriptedV4l2::open(const char *wanted)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    if (gone || wanted != path) {
        return fail(ENOENT);
    }
    ++open_;
    return CAMERA_FD + plugged_;
}

void ScriptedV4l2::close(int fd)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    --open_;
    if (fd == CAMERA_FD + plugged_) {
        streaming_ = false;
        queue_.clear();
    }
}

void ScriptedV4l2::replug(const std::string &new_path)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    ++plugged_;
    path = new_path;
    gone = streaming_ = false;
    queue_.clear();
    old_memory_.push_back(std::move(memory_)); /* moving keeps the bytes where they are */
    memory_.clear();
}

int ScriptedV4l2::ioctl(int fd, unsigned long request, void *argument)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return gone || fd != CAMERA_FD + plugged_ ? fail(ENODEV) : answer(request, argument);
}

int ScriptedV4l2::answer(unsigned long what, void *argument)
{
    switch (what) {
    case VIDIOC_QUERYCAP: return capability(*static_cast<v4l2_capability *>(argument));
    case VIDIOC_ENUM_FMT: {
        auto &description = *static_cast<v4l2_fmtdesc *>(argument);
        if (description.index >= formats.size()) {
            return fail(EINVAL);
        }
        description.pixelformat = formats[description.index];
        return 0;
    }
    case VIDIOC_G_FMT: return format(*static_cast<v4l2_format *>(argument), false);
    case VIDIOC_S_FMT: return format(*static_cast<v4l2_format *>(argument), true);
    case VIDIOC_S_PARM: return 0;
    case VIDIOC_REQBUFS: return request(*static_cast<v4l2_requestbuffers *>(argument));
    case VIDIOC_QUERYBUF: return query(*static_cast<v4l2_buffer *>(argument));
    case VIDIOC_QBUF: return queue(*static_cast<v4l2_buffer *>(argument));
    case VIDIOC_DQBUF: return dequeue(*static_cast<v4l2_buffer *>(argument));
    case VIDIOC_STREAMON: streaming_ = true; return 0;
    case VIDIOC_STREAMOFF: streaming_ = false; queue_.clear(); return 0;
    case VIDIOC_QUERYCTRL: return query_control(*static_cast<v4l2_queryctrl *>(argument));
    case VIDIOC_QUERYMENU: return query_menu(*static_cast<v4l2_querymenu *>(argument));
    case VIDIOC_S_CTRL: return set_control(*static_cast<v4l2_control *>(argument));
    case VIDIOC_G_CTRL: return get_control(*static_cast<v4l2_control *>(argument));
    default: return fail(ENOTTY);
    }
}

int ScriptedV4l2::capability(v4l2_capability &who) const
{
    std::strncpy(reinterpret_cast<char *>(who.card), card.c_str(), sizeof who.card - 1);
    std::strncpy(reinterpret_cast<char *>(who.bus_info), bus.c_str(), sizeof who.bus_info - 1);
    who.capabilities = capabilities | V4L2_CAP_DEVICE_CAPS;
    who.device_caps = capabilities;
    return 0;
}

int ScriptedV4l2::format(v4l2_format &format, bool set)
{
    v4l2_pix_format &pix = format.fmt.pix;
    if (set && std::find(formats.begin(), formats.end(), pix.pixelformat) != formats.end()) {
        fourcc_ = pix.pixelformat;
    }
    const bool one_byte = fourcc_ == V4L2_PIX_FMT_GREY || fourcc_ == V4L2_PIX_FMT_NV12;
    stride_ = width * (one_byte ? 1 : 2) + row_padding;
    fourcc_size_ = stride_ * height * (fourcc_ == V4L2_PIX_FMT_NV12 ? 3 : 2) / 2;
    pix.width = width;
    pix.height = height;
    pix.pixelformat = fourcc_;
    pix.field = V4L2_FIELD_NONE;
    pix.bytesperline = stride_;
    pix.sizeimage = fourcc_size_;
    return 0;
}

int ScriptedV4l2::request(v4l2_requestbuffers &request)
{
    if (mapped_here() > 0) {
        return fail(EBUSY);
    }
    request.count = std::min(request.count, buffers_most);
    memory_.assign(request.count, std::vector<std::uint8_t>(fourcc_size_));
    queue_.clear();
    return 0;
}

int ScriptedV4l2::query(v4l2_buffer &buffer) const
{
    if (buffer.index >= memory_.size()) {
        return fail(EINVAL);
    }
    buffer.length = fourcc_size_;
    buffer.m.offset = buffer.index * 0x10000;
    buffer.flags = stamp_flags;
    return 0;
}

void *ScriptedV4l2::map(int, std::size_t, std::int64_t offset)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    void *const memory = memory_[static_cast<std::size_t>(offset) / 0x10000].data();
    mapped_.insert(memory);
    return memory;
}

void ScriptedV4l2::unmap(void *memory, std::size_t)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    mapped_.erase(memory);
}

std::size_t ScriptedV4l2::mapped_here() const
{
    return static_cast<std::size_t>(
        std::count_if(memory_.begin(), memory_.end(),
                      [this](const auto &bytes) { return mapped_.count(bytes.data()) > 0; }));
}

int ScriptedV4l2::queue(v4l2_buffer &buffer)
{
    if (buffer.index >= memory_.size() ||
        std::find(queue_.begin(), queue_.end(), buffer.index) != queue_.end()) {
        return fail(EINVAL);
    }
    queue_.push_back(buffer.index);
    return 0;
}

int ScriptedV4l2::dequeue(v4l2_buffer &buffer)
{
    if (!streaming_) {
        return fail(EINVAL);
    }
    if (script_.empty()) {
        return fail(EAGAIN);
    }
    const ScriptedPicture next = script_.front();
    if (next.error != 0) {
        script_.pop_front();
        gone = next.error == ENODEV;
        return fail(next.error);
    }
    if (queue_.empty()) {
        return fail(EAGAIN);
    }
    script_.pop_front();
    buffer.index = queue_.front();
    queue_.pop_front();
    buffer.sequence = next.sequence;
    buffer.timestamp.tv_sec = next.t_us / 1000000;
    buffer.timestamp.tv_usec = next.t_us % 1000000;
    buffer.flags = stamp_flags | (next.bad ? V4L2_BUF_FLAG_ERROR : 0);
    buffer.bytesused = next.bytes_used ? next.bytes_used : fourcc_size_;
    std::vector<std::uint8_t> &bytes = memory_[buffer.index];
    std::fill(bytes.begin(), bytes.begin() + buffer.bytesused, next.fill);
    return 0;
}

int ScriptedV4l2::poll(pollfd *fds, nfds_t count, int timeout_ms)
{
    bool ready = false;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        ready = count > 1 && (gone || (!script_.empty() && streaming_));
    }
    const int rung = V4l2Calls::poll(fds, 1, ready ? 0 : timeout_ms);
    if (count > 1) {
        fds[1].revents = ready ? POLLIN : 0;
    }
    return rung + (ready ? 1 : 0);
}

int ScriptedV4l2::query_control(v4l2_queryctrl &query) const
{
    auto found = controls.find(query.id);
    if ((query.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0) {
        found = controls.upper_bound(query.id & ~V4L2_CTRL_FLAG_NEXT_CTRL);
    }
    if (found == controls.end()) {
        return fail(EINVAL);
    }
    query = v4l2_queryctrl();
    query.id = found->first;
    query.type = found->second.type;
    std::strncpy(reinterpret_cast<char *>(query.name), found->second.name.c_str(),
                 sizeof query.name - 1);
    query.minimum = found->second.least;
    query.maximum = found->second.most;
    query.step = found->second.step;
    return 0;
}

int ScriptedV4l2::query_menu(v4l2_querymenu &menu) const
{
    const auto found = controls.find(menu.id);
    if (found == controls.end() || found->second.menu.count(static_cast<int>(menu.index)) == 0) {
        return fail(EINVAL);
    }
    std::strncpy(reinterpret_cast<char *>(menu.name),
                 found->second.menu.at(static_cast<int>(menu.index)).c_str(),
                 sizeof menu.name - 1);
    return 0;
}

int ScriptedV4l2::set_control(v4l2_control &control)
{
    const auto found = controls.find(control.id);
    if (found == controls.end()) {
        return fail(EINVAL);
    }
    if (found->second.refuses) {
        return fail(EBUSY);
    }
    found->second.value = control.value;
    accepted[control.id] = control.value;
    return 0;
}

int ScriptedV4l2::get_control(v4l2_control &control) const
{
    const auto found = controls.find(control.id);
    if (found == controls.end()) {
        return fail(EINVAL);
    }
    control.value = found->second.value;
    return 0;
}

void ScriptedV4l2::play(const std::vector<ScriptedPicture> &pictures)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    script_.insert(script_.end(), pictures.begin(), pictures.end());
}

std::uint32_t ScriptedV4l2::queued() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return static_cast<std::uint32_t>(queue_.size());
}

int ScriptedV4l2::open_count() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return open_;
}

std::uint32_t ScriptedV4l2::mapped() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return static_cast<std::uint32_t>(mapped_.size());
}
