/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_files.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

namespace opms_host {

namespace {

bool fail(const char *what, const std::string &path, FileTrouble &trouble)
{
    trouble.number = errno;
    trouble.text = path + ": cannot be " + what + ": " + std::strerror(trouble.number);
    return false;
}

/** An open file; close() tells whether the system had anything left to say. */
class OpenFile {
public:
    OpenFile(const std::string &path, int flags) : file_(::open(path.c_str(), flags, 0644)) {}
    ~OpenFile() { close(); }
    OpenFile(const OpenFile &) = delete;
    OpenFile &operator=(const OpenFile &) = delete;
    bool is_open() const { return file_ >= 0; }
    int get() const { return file_; }
    bool close()
    {
        const bool good = file_ < 0 || ::close(file_) == 0;
        file_ = -1;
        return good;
    }

private:
    int file_;
};

bool sync_path(const std::string &path, int flags, FileTrouble &trouble)
{
    const OpenFile file(path, flags | O_RDONLY | O_CLOEXEC);
    if (!file.is_open() || ::fsync(file.get()) != 0) {
        return fail("synced", path, trouble);
    }
    return true;
}

}  // namespace

bool FileTrouble::is_full() const
{
    return number == ENOSPC || number == EDQUOT || number == EFBIG;
}

bool file_write(const std::string &path, const std::vector<std::uint8_t> &bytes,
                FileTrouble &trouble)
{
    OpenFile file(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
    if (!file.is_open()) {
        return fail("written", path, trouble);
    }
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t some = ::write(file.get(), bytes.data() + done, bytes.size() - done);
        if (some < 0 && errno != EINTR) {
            return fail("written", path, trouble);
        }
        done += some > 0 ? static_cast<std::size_t>(some) : 0;
    }
    return file.close() || fail("written", path, trouble);
}

bool file_sync(const std::string &path, FileTrouble &trouble)
{
    return sync_path(path, 0, trouble);
}

bool folder_sync(const std::string &path, FileTrouble &trouble)
{
    return sync_path(path, O_DIRECTORY, trouble);
}

bool file_rename(const std::string &from, const std::string &to, FileTrouble &trouble)
{
    return ::rename(from.c_str(), to.c_str()) == 0 || fail("renamed", from, trouble);
}

bool folder_make(const std::string &path, FileTrouble &trouble)
{
    return ::mkdir(path.c_str(), 0755) == 0 || errno == EEXIST || fail("made", path, trouble);
}

std::uint32_t crc32_of(const std::uint8_t *bytes, std::size_t size)
{
    return static_cast<std::uint32_t>(crc32_z(0, bytes, size));
}

bool file_crc32(const std::string &path, std::uint64_t &bytes, std::uint32_t &found)
{
    const OpenFile file(path, O_RDONLY | O_CLOEXEC);
    if (!file.is_open()) {
        return false;
    }
    std::vector<std::uint8_t> buffer(1 << 18);
    uLong sum = crc32_z(0, nullptr, 0);
    bytes = 0;
    for (;;) {
        const ssize_t some = ::read(file.get(), buffer.data(), buffer.size());
        if (some < 0 && errno == EINTR) {
            continue;
        }
        if (some <= 0) {
            found = static_cast<std::uint32_t>(sum);
            return some == 0;
        }
        bytes += static_cast<std::uint64_t>(some);
        sum = crc32_z(sum, buffer.data(), static_cast<std::size_t>(some));
    }
}

}  // namespace opms_host
