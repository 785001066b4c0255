/* SPDX-License-Identifier: Apache-2.0 */
/* Locks of the open file (OFD): unlike those of the process, another part of the same process that
 * opens and closes the file does not take them away; and they can be looked at without taking. */
#include "scan_lock.hpp"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

namespace opms_host {

namespace {

constexpr int TRY_EVERY_MS = 20;

struct flock whole_file()
{
    struct flock lock = {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    return lock;
}

}  // namespace

std::unique_ptr<ScanLock> ScanLock::take(const std::string &path, int wait_ms, bool &held,
                                         std::string &error)
{
    held = false;
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file < 0) {
        error = path + ": cannot be opened: " + std::strerror(errno);
        return nullptr;
    }
    struct flock lock = whole_file();
    while (::fcntl(file, F_OFD_SETLK, &lock) != 0) {
        held = errno == EAGAIN || errno == EACCES;
        if (!held || wait_ms <= 0) {
            error = path + (held ? ": is locked by another program"
                                 : std::string(": cannot be locked: ") + std::strerror(errno));
            ::close(file);
            return nullptr;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(TRY_EVERY_MS));
        wait_ms -= TRY_EVERY_MS;
        lock = whole_file();
    }
    held = false;
    return std::unique_ptr<ScanLock>(new ScanLock(file));
}

bool ScanLock::is_held(const std::string &path)
{
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        return false;
    }
    struct flock lock = whole_file();
    const bool held = ::fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
    ::close(file);
    return held;
}

ScanLock::~ScanLock()
{
    ::close(file_);
}

}  // namespace opms_host
