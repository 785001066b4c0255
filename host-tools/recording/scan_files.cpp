/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_files.hpp"

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

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

std::array<std::uint32_t, 256> crc32_table()
{
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; i++) {
        std::uint32_t value = i;
        for (int bit = 0; bit < 8; bit++) {
            value = value & 1 ? 0xEDB88320U ^ (value >> 1) : value >> 1;
        }
        table[i] = value;
    }
    return table;
}

std::uint32_t crc32_add(std::uint32_t state, const std::uint8_t *bytes, std::size_t size)
{
    static const std::array<std::uint32_t, 256> table = crc32_table();
    for (std::size_t i = 0; i < size; i++) {
        state = table[(state ^ bytes[i]) & 0xff] ^ (state >> 8);
    }
    return state;
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
    return ~crc32_add(0xffffffffU, bytes, size);
}

bool file_crc32(const std::string &path, std::uint64_t &bytes, std::uint32_t &crc32)
{
    const OpenFile file(path, O_RDONLY | O_CLOEXEC);
    if (!file.is_open()) {
        return false;
    }
    std::vector<std::uint8_t> buffer(1 << 18);
    std::uint32_t state = 0xffffffffU;
    bytes = 0;
    for (;;) {
        const ssize_t some = ::read(file.get(), buffer.data(), buffer.size());
        if (some < 0 && errno == EINTR) {
            continue;
        }
        if (some <= 0) {
            crc32 = ~state;
            return some == 0;
        }
        bytes += static_cast<std::uint64_t>(some);
        state = crc32_add(state, buffer.data(), static_cast<std::size_t>(some));
    }
}

}  // namespace opms_host
