/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_folder.hpp"

#include <filesystem>

#include "scan_book.hpp"
#include "scan_files.hpp"
#include "scan_schema.hpp"
#include "sqlite_database.hpp"

namespace opms_host {

namespace {

namespace fs = std::filesystem;

constexpr int FOLDER_WAIT_MS = 5000; /* others begin a scan in the same folder */
const std::string ASIDE = ".new-";

/** Under the lock of the folder of all scans: what is still aside now, nobody is making. */
void remove_left_overs(const fs::path &folder)
{
    std::error_code ignored;
    for (const fs::directory_entry &entry : fs::directory_iterator(folder, ignored)) {
        if (entry.path().filename().string().rfind(ASIDE, 0) == 0) {
            fs::remove_all(entry.path(), ignored);
        }
    }
}

/** In the folder aside. Closed again: SQLite knows a database by its path, which will change. */
void write_database(const fs::path &path, const ScanHeader &header)
{
    Database database(path.string(), Database::Access::create);
    scan_schema_create(database);
    database.run("BEGIN");
    book_write(database, header);
    database.run("COMMIT");
    database.close();
}

bool fill(const fs::path &aside, const ScanHeader &header, NewScanFolder &made, std::string &error)
{
    FileTrouble trouble;
    bool held = false;
    if (!folder_make(aside.string(), trouble) ||
        !folder_make((aside / "pictures").string(), trouble)) {
        error = trouble.text;
        return false;
    }
    made.lock = ScanLock::take((aside / SCAN_LOCK_NAME).string(), 0, held, error);
    if (!made.lock) {
        return false;
    }
    const fs::path database = aside / SCAN_DATABASE_NAME;
    try {
        write_database(database, header);
    } catch (const DatabaseError &what) {
        error = database.string() + ": " + what.what();
        return false;
    }
    if (!file_sync(database.string(), trouble) ||
        !folder_sync((aside / "pictures").string(), trouble) ||
        !folder_sync(aside.string(), trouble)) {
        error = trouble.text;
        return false;
    }
    return true;
}

/** Make the folder of all scans, with those above it. */
bool make_parent(const fs::path &folder, std::string &error)
{
    std::error_code code;
    fs::create_directories(folder, code);
    if (!fs::is_directory(folder)) {
        error = folder.string() + ": cannot be made: " + code.message();
        return false;
    }
    FileTrouble ignored; /* some parents may not be read, and so not synced */
    folder_sync((fs::absolute(folder) / "..").string(), ignored);
    return true;
}

bool name_it(const fs::path &aside, const fs::path &folder, const fs::path &path,
             std::string &error)
{
    FileTrouble trouble;
    if (!file_rename(aside.string(), path.string(), trouble) ||
        !folder_sync(folder.string(), trouble)) {
        error = trouble.text;
        return false;
    }
    return true;
}

}  // namespace

bool scan_folder_make(const std::string &folder, const ScanHeader &header, NewScanFolder &made,
                      std::string &error)
{
    if (!scan_name_check(header.name, error) || !make_parent(folder, error)) {
        return false;
    }
    bool held = false;
    const std::unique_ptr<ScanLock> all =
        ScanLock::take((fs::path(folder) / ".scans.lock").string(), FOLDER_WAIT_MS, held, error);
    if (!all) {
        return false;
    }
    remove_left_overs(folder);
    const fs::path path = fs::path(folder) / header.name;
    const fs::path aside = fs::path(folder) / (ASIDE + header.name);
    if (fs::exists(fs::symlink_status(path))) {
        error = path.string() + ": is there already";
        return false;
    }
    if (!fill(aside, header, made, error) || !name_it(aside, folder, path, error)) {
        made.lock.reset();
        std::error_code ignored;
        fs::remove_all(aside, ignored);
        return false;
    }
    made.path = path.string();
    return true;
}

}  // namespace opms_host
