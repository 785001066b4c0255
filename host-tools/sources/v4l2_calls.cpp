/* SPDX-License-Identifier: Apache-2.0 */
#include "v4l2_calls.hpp"

#include <cerrno>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace opms_host {

int V4l2Calls::open(const char *path)
{
    return ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
}

void V4l2Calls::close(int fd)
{
    ::close(fd);
}

int V4l2Calls::ioctl(int fd, unsigned long request, void *argument)
{
    int result = 0;
    do {
        result = ::ioctl(fd, request, argument);
    } while (result < 0 && errno == EINTR);
    return result;
}

void *V4l2Calls::map(int fd, std::size_t size, std::int64_t offset)
{
    void *const memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return memory == MAP_FAILED ? nullptr : memory;
}

void V4l2Calls::unmap(void *memory, std::size_t size)
{
    ::munmap(memory, size);
}

int V4l2Calls::poll(pollfd *fds, nfds_t count, int timeout_ms)
{
    return ::poll(fds, count, timeout_ms);
}

}  // namespace opms_host
