/* SPDX-License-Identifier: Apache-2.0 */
#include "catalogue_delete.hpp"

#include <filesystem>
#include <fstream>
#include <memory>

#include "scan_folder.hpp"
#include "scan_lock.hpp"

using namespace opms_host;
namespace fs = std::filesystem;

namespace {

const std::string SQLITE_MAGIC("SQLite format 3\0", 16);

/** A damaged one begins so, too; what else it holds is looked at by its names. */
bool is_database(const fs::path &path)
{
    std::ifstream file(path, std::ios::binary);
    std::string begin(SQLITE_MAGIC.size(), '\0');
    file.read(&begin[0], static_cast<std::streamsize>(begin.size()));
    return file && begin == SQLITE_MAGIC;
}

bool belongs_to_scan(const fs::directory_entry &entry)
{
    const std::string name = entry.path().filename().string();
    if (entry.is_symlink()) {
        return false;
    }
    if (name == "pictures") {
        return entry.is_directory();
    }
    const std::string database = SCAN_DATABASE_NAME;
    return entry.is_regular_file() &&
           (name == database || name == database + "-wal" || name == database + "-shm" ||
            name == database + "-journal" || name == SCAN_LOCK_NAME);
}

/** Pictures, and those that were half written. */
bool is_picture(const fs::directory_entry &entry)
{
    const std::string name = entry.path().filename().string();
    return !entry.is_symlink() && (entry.is_directory() || name.find(".png") != std::string::npos);
}

std::string foreign_entry(const fs::path &folder)
{
    for (const fs::directory_entry &entry : fs::directory_iterator(folder)) {
        if (!belongs_to_scan(entry)) {
            return entry.path().string();
        }
    }
    if (fs::exists(folder / "pictures")) {
        for (const auto &entry : fs::recursive_directory_iterator(folder / "pictures")) {
            if (!is_picture(entry)) {
                return entry.path().string();
            }
        }
    }
    return std::string();
}

bool looks_like_scan(const fs::path &folder, std::string &error)
{
    if (fs::is_symlink(folder) || !fs::is_directory(folder) ||
        !is_database(folder / SCAN_DATABASE_NAME)) {
        error = folder.string() + ": is no folder of a scan; nothing was deleted";
        return false;
    }
    const std::string foreign = foreign_entry(folder);
    if (!foreign.empty()) {
        error = foreign + ": does not belong to a scan; nothing was deleted";
        return false;
    }
    return true;
}

/** "scans/one/" is "scans/one". */
fs::path without_slash(const std::string &folder)
{
    const fs::path path = fs::absolute(folder).lexically_normal();
    return path.has_filename() ? path : path.parent_path();
}

bool delete_folder(const fs::path &folder, std::string &error)
{
    bool held = false;
    const auto lock = ScanLock::take((folder / SCAN_LOCK_NAME).string(), 0, held, error);
    if (!lock) {
        error = held ? folder.string() + ": is being recorded; nothing was deleted" : error;
        return false;
    }
    const fs::path aside = folder.parent_path() / (".deleted-" + folder.filename().string());
    fs::remove_all(aside); /* what a deletion that was cut off has left */
    fs::rename(folder, aside);
    fs::remove_all(aside);
    return true;
}

}  // namespace

bool catalogue_may_delete(const std::string &folder, std::string &error)
{
    try {
        const fs::path path = without_slash(folder);
        if (!looks_like_scan(path, error)) {
            return false;
        }
        if (ScanLock::is_held((path / SCAN_LOCK_NAME).string())) {
            error = folder + ": is being recorded; nothing was deleted";
            return false;
        }
        return true;
    } catch (const fs::filesystem_error &e) {
        error = e.what();
        return false;
    }
}

bool catalogue_delete(const std::string &folder, std::string &error)
{
    try {
        return catalogue_may_delete(folder, error) && delete_folder(without_slash(folder), error);
    } catch (const fs::filesystem_error &e) {
        error = e.what();
        return false;
    }
}
