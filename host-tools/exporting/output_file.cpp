/* SPDX-License-Identifier: Apache-2.0 */
#include "output_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace opms_host {

namespace {

constexpr std::size_t FLUSH_BYTES = 256 * 1024;

std::string because(const std::string &path, int error_number)
{
    return path + ": " + std::strerror(error_number);
}

/** What mkstemp() denies to others, the umask may allow. */
void open_to_umask(int descriptor)
{
    const mode_t mask = ::umask(0);
    ::umask(mask);
    (void)!::fchmod(descriptor, 0666 & ~mask);
}

/** A rename is on the disk when its folder is. */
void sync_folder_of(const std::string &path)
{
    const std::string folder = std::filesystem::absolute(path).parent_path().string();
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        ::fsync(descriptor);
        ::close(descriptor);
    }
}

}  // namespace

std::unique_ptr<OutputFile> OutputFile::open(const std::string &path, bool may_replace,
                                             std::string &error)
{
    struct stat there = {};
    const bool exists = ::lstat(path.c_str(), &there) == 0;
    if (exists && !may_replace) {
        error = path + ": is there already; --force replaces it";
        return nullptr;
    }
    if (exists && !S_ISREG(there.st_mode) && !S_ISLNK(there.st_mode)) {
        error = path + ": is no file";
        return nullptr;
    }
    const std::string pattern = path + ".part-XXXXXX";
    std::vector<char> aside(pattern.begin(), pattern.end());
    aside.push_back('\0');
    const int descriptor = ::mkstemp(aside.data());
    if (descriptor < 0) {
        error = because(path, errno);
        return nullptr;
    }
    open_to_umask(descriptor);
    return std::unique_ptr<OutputFile>(new OutputFile(path, aside.data(), descriptor));
}

OutputFile::OutputFile(std::string path, std::string aside, int descriptor)
    : path_(std::move(path)), aside_(std::move(aside)), descriptor_(descriptor)
{
}

OutputFile::~OutputFile()
{
    if (descriptor_ >= 0) {
        ::close(descriptor_);
        ::unlink(aside_.c_str());
    }
}

void OutputFile::write(const void *bytes, std::size_t size)
{
    size_ += size;
    waiting_.append(static_cast<const char *>(bytes), size);
    if (waiting_.size() >= FLUSH_BYTES) {
        flush();
    }
}

void OutputFile::flush()
{
    std::size_t done = 0;
    while (done < waiting_.size() && error_number_ == 0) {
        const ssize_t count = ::write(descriptor_, waiting_.data() + done, waiting_.size() - done);
        if (count > 0) {
            done += static_cast<std::size_t>(count);
        } else if (errno != EINTR) {
            error_number_ = errno != 0 ? errno : EIO;
        }
    }
    waiting_.clear();
}

bool OutputFile::told(std::string &error) const
{
    if (error_number_ != 0) {
        error = because(path_, error_number_) + "; nothing of it was kept";
    }
    return error_number_ == 0;
}

bool OutputFile::seal(std::string &error)
{
    flush();
    if (error_number_ == 0 && ::fsync(descriptor_) != 0) {
        error_number_ = errno;
    }
    return told(error);
}

bool OutputFile::finish(std::string &error)
{
    if (!seal(error)) {
        return false;
    }
    if (::rename(aside_.c_str(), path_.c_str()) != 0) {
        error_number_ = errno;
        return told(error);
    }
    ::close(descriptor_);
    descriptor_ = -1;
    sync_folder_of(path_);
    return true;
}

bool output_file_write(const std::string &path, const std::string &bytes, bool may_replace,
                       std::string &error)
{
    const std::unique_ptr<OutputFile> file = OutputFile::open(path, may_replace, error);
    if (!file) {
        return false;
    }
    file->write(bytes);
    return file->finish(error);
}

}  // namespace opms_host
