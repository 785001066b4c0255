/* SPDX-License-Identifier: Apache-2.0 */
#include "print_job.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

namespace opms::print {
namespace {

namespace fs = std::filesystem;

/** Removes what is left of its files when the work ends early. */
class AsideFiles {
public:
    AsideFiles() = default;
    AsideFiles(const AsideFiles &) = delete;
    AsideFiles &operator=(const AsideFiles &) = delete;
    ~AsideFiles()
    {
        for (const fs::path &path : paths_) {
            std::error_code ignored;
            fs::remove(path, ignored);
        }
    }

    const fs::path &add(const fs::path &target)
    {
        fs::path aside = target;
        aside += ".part-" + std::to_string(std::random_device{}());
        paths_.push_back(std::move(aside));
        return paths_.back();
    }
    const fs::path &at(size_t index) const { return paths_[index]; }

private:
    std::vector<fs::path> paths_;
};

[[noreturn]] void fail(const std::string &path, const std::string &reason)
{
    throw FileError(path + ": cannot be written: " + reason);
}

void write_aside(const OutputFile &file, const fs::path &aside)
{
    errno = 0;
    std::ofstream stream(aside, std::ios::binary | std::ios::trunc);
    stream.write(file.bytes.data(), static_cast<std::streamsize>(file.bytes.size()));
    stream.close();
    if (!stream) {
        fail(file.path, errno != 0 ? std::strerror(errno) : "write error");
    }
}

} // namespace

void write_files(const std::vector<OutputFile> &files)
{
    AsideFiles aside;
    for (const OutputFile &file : files) {
        write_aside(file, aside.add(file.path));
    }
    for (size_t i = 0; i < files.size(); ++i) {
        std::error_code error;
        fs::rename(aside.at(i), files[i].path, error);
        if (error) {
            fail(files[i].path, error.message());
        }
    }
}

} // namespace opms::print
