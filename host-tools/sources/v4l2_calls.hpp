/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The system calls that V4L2 needs, so that a test can answer them. */
#ifndef OPMS_SOURCES_V4L2_CALLS_HPP
#define OPMS_SOURCES_V4L2_CALLS_HPP

#include <cstddef>
#include <cstdint>

#include <poll.h>

namespace opms_host {

/** As the functions of the C library: -1 (or nullptr) and errno on failure. Any thread. */
class V4l2Calls {
public:
    virtual ~V4l2Calls() = default;
    virtual int open(const char *path);
    virtual void close(int fd);
    /** Calls again after EINTR. */
    virtual int ioctl(int fd, unsigned long request, void *argument);
    virtual void *map(int fd, std::size_t size, std::int64_t offset);
    virtual void unmap(void *memory, std::size_t size);
    /** Of the camera and of an eventfd of ours. */
    virtual int poll(pollfd *fds, nfds_t count, int timeout_ms);
};

}  // namespace opms_host
#endif
