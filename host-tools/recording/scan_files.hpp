/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Files that are on the disk when a call returns. False on failure, with errno in @p number. */
#ifndef OPMS_RECORDING_SCAN_FILES_HPP
#define OPMS_RECORDING_SCAN_FILES_HPP

#include <cstdint>
#include <string>
#include <vector>

namespace opms_host {

/** What went wrong, with the name of the file. */
struct FileTrouble {
    int number = 0; /**< errno */
    std::string text;
    bool is_full() const; /**< no room on the disk */
};

/** Write a new file, or over an old one; not yet synced. */
bool file_write(const std::string &path, const std::vector<std::uint8_t> &bytes,
                FileTrouble &trouble);
bool file_sync(const std::string &path, FileTrouble &trouble);
/** The names in a folder. */
bool folder_sync(const std::string &path, FileTrouble &trouble);
bool file_rename(const std::string &from, const std::string &to, FileTrouble &trouble);
/** Exists already: no failure. Its name is on the disk after folder_sync() of its parent. */
bool folder_make(const std::string &path, FileTrouble &trouble);

/** The sum that PNG and zlib use, too. */
std::uint32_t crc32_of(const std::uint8_t *bytes, std::size_t size);
/** @return False where the file cannot be read. */
bool file_crc32(const std::string &path, std::uint64_t &bytes, std::uint32_t &found);

}  // namespace opms_host
#endif
