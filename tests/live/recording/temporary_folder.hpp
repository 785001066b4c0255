/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A folder for one test, gone after it. */
#ifndef OPMS_TESTS_TEMPORARY_FOLDER_HPP
#define OPMS_TESTS_TEMPORARY_FOLDER_HPP

#include <cstdlib>
#include <filesystem>
#include <string>

class TemporaryFolder {
public:
    TemporaryFolder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "opms-scan-XXXXXX").string();
        if (!::mkdtemp(name.data())) {
            std::abort();
        }
        path_ = std::filesystem::canonical(name);
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder &) = delete;
    TemporaryFolder &operator=(const TemporaryFolder &) = delete;
    std::string operator/(const std::string &name) const { return (path_ / name).string(); }
    std::string path() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

#endif
