/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A V4L2 driver that a test writes: it answers the system calls as the kernel's documentation has
 * them, with the pictures, gaps and errors of a script. */
#ifndef OPMS_TESTS_SCRIPTED_V4L2_HPP
#define OPMS_TESTS_SCRIPTED_V4L2_HPP

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <linux/videodev2.h>

#include "v4l2_calls.hpp"

/** One answer of DQBUF. */
struct ScriptedPicture {
    std::uint32_t sequence = 0;
    std::int64_t t_us = 0;
    int error = 0;                /**< errno instead of a picture */
    bool bad = false;             /**< V4L2_BUF_FLAG_ERROR */
    std::uint8_t fill = 100;      /**< all its bytes */
    std::uint32_t bytes_used = 0; /**< 0: all */
};

struct ScriptedControl {
    std::string name;
    std::uint32_t type = V4L2_CTRL_TYPE_INTEGER;
    std::int32_t least = 0, most = 0, step = 1, value = 0;
    std::map<int, std::string> menu;
    bool refuses = false;
};

class ScriptedV4l2 : public opms_host::V4l2Calls {
public:
    ScriptedV4l2() { formats = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_GREY}; }
    ~ScriptedV4l2() override;

    int open(const char *path) override;
    void close(int fd) override;
    int ioctl(int fd, unsigned long request, void *argument) override;
    void *map(int fd, std::size_t size, std::int64_t offset) override;
    void unmap(void *memory, std::size_t size) override;
    int poll(pollfd *fds, nfds_t count, int timeout_ms) override;

    /** What the driver is. */
    std::string path = "/dev/video0", card = "Scripted", bus = "usb-1";
    std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    std::vector<std::uint32_t> formats;
    std::uint32_t width = 64, height = 48, row_padding = 16;
    std::uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    std::map<std::uint32_t, ScriptedControl> controls;
    std::map<std::uint32_t, std::int32_t> accepted; /**< S_CTRL that came */
    std::uint32_t buffers_most = 32;
    bool gone = false;      /**< ENODEV for all, ENOENT for open() */

    /** What is going on. */
    /** Plugged in again, as another device of the system. */
    void replug(const std::string &new_path);
    void play(const std::vector<ScriptedPicture> &pictures);
    std::uint32_t queued() const;
    int open_count() const;
    std::uint32_t mapped() const;

private:
    int answer(unsigned long request, void *argument);
    int fail(int error) const;
    int capability(v4l2_capability &who) const;
    int format(v4l2_format &format, bool set);
    int request(v4l2_requestbuffers &request);
    int query(v4l2_buffer &buffer) const;
    int queue(v4l2_buffer &buffer);
    int dequeue(v4l2_buffer &buffer);
    int query_control(v4l2_queryctrl &query) const;
    int query_menu(v4l2_querymenu &menu) const;
    int set_control(v4l2_control &control);
    int get_control(v4l2_control &control) const;

    std::size_t mapped_here() const;

    mutable std::mutex mutex_;
    std::deque<ScriptedPicture> script_;
    std::vector<std::vector<std::uint8_t>> memory_;
    std::deque<std::uint32_t> queue_;
    std::uint32_t fourcc_ = V4L2_PIX_FMT_YUYV, fourcc_size_ = 0;
    std::vector<std::vector<std::vector<std::uint8_t>>> old_memory_;
    std::set<const void *> mapped_;
    std::uint32_t stride_ = 0;
    int open_ = 0, plugged_ = 0;
    bool streaming_ = false;
};

#endif
