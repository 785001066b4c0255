/* SPDX-License-Identifier: Apache-2.0 */
/* SQLite mends its own file when it is opened for writing: whole commits that stand in the -wal are
 * taken up, a torn one is not. What is left is to compare the books with the pictures: those that
 * are named were on the disk before, so a missing one is a fault of the disk or of a person. */
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>

#include "host_clock.hpp"
#include "scan_files.hpp"
#include "scan_folder.hpp"
#include "scan_lock.hpp"
#include "scan_open.hpp"
#include "scan_reader.hpp"
#include "scan_schema.hpp"

namespace opms_host {

namespace {

namespace fs = std::filesystem;

constexpr int LOCK_WAIT_MS = 300;
constexpr std::int64_t LAST_PICTURES = 256; /* whose sums are checked; of the others the size */

const char *const TABLES[] = {"triggers", "frames", "pictures", "pairs", "poses", "locations",
                              "events", "clock_samples", "box_reports", "sensor_samples"};
const char *const TIMES[] = {
    "SELECT arrival_host_ns FROM frames ORDER BY number DESC LIMIT 1",
    "SELECT arrival_host_ns FROM triggers ORDER BY id DESC LIMIT 1",
    "SELECT t_host_ns FROM pairs ORDER BY id DESC LIMIT 1",
    "SELECT published_host_ns FROM poses ORDER BY number DESC LIMIT 1",
    "SELECT t_host_ns FROM events ORDER BY id DESC LIMIT 1",
    "SELECT arrived_host_ns FROM clock_samples ORDER BY id DESC LIMIT 1",
    "SELECT arrival_host_ns FROM box_reports ORDER BY id DESC LIMIT 1",
    "SELECT arrival_host_ns FROM sensor_samples ORDER BY id DESC LIMIT 1"};

void count(Database &database, ScanRecovery &recovery)
{
    for (const char *table : TABLES) {
        recovery.rows += static_cast<std::uint64_t>(
            database.integer(std::string("SELECT count(*) FROM ") + table));
    }
    for (const char *sql : TIMES) {
        recovery.last_host_ns = std::max(recovery.last_host_ns, database.integer(sql));
    }
}

void check_structure(Database &database)
{
    const std::string verdict = database.text("PRAGMA quick_check(1)");
    if (verdict != "ok") {
        throw DatabaseError(DatabaseError::Kind::damaged, "is damaged: " + verdict);
    }
}

bool has_its_size(const PictureRow &picture, std::string &why)
{
    std::error_code code;
    if (fs::file_size(picture.path, code) == picture.bytes && !code) {
        return true;
    }
    why = picture.path + ": is missing, or has not its size";
    return false;
}

/** Names in the books. Rows without a whole file are taken out; what there is of the file stays,
 * for who wants to see what became of it. */
std::set<std::string> check_named(Database &database, const fs::path &folder,
                                  ScanRecovery &recovery)
{
    std::set<std::string> named;
    std::vector<std::int64_t> lost;
    const std::int64_t newest = database.integer("SELECT max(number) FROM pictures");
    Statement rows(database, "SELECT number, path, bytes, crc32 FROM pictures ORDER BY number");
    while (rows.step()) {
        PictureRow picture;
        picture.path = (folder / rows.text(1)).string();
        picture.bytes = static_cast<std::uint64_t>(rows.integer(2));
        picture.crc32 = rows.integer(3);
        std::string why;
        const bool is_new = rows.integer(0) > newest - LAST_PICTURES;
        named.insert(picture.path);
        if (!(is_new ? picture_is_whole(picture, why) : has_its_size(picture, why))) {
            lost.push_back(rows.integer(0));
            recovery.words.push_back(why);
        }
    }
    rows.reset();
    Statement remove(database, "DELETE FROM pictures WHERE number = ?");
    for (const std::int64_t number : lost) {
        remove.bind(1, number);
        remove.step();
        remove.reset();
    }
    recovery.pictures_lost = lost.size();
    return named;
}

/** Files of pictures that no row names, and parts of such: nobody could find them. */
void remove_loose(const fs::path &folder, const std::set<std::string> &named,
                  ScanRecovery &recovery)
{
    std::error_code ignored;
    std::vector<fs::path> loose;
    for (const auto &entry : fs::recursive_directory_iterator(folder / "pictures", ignored)) {
        const bool ours = entry.path().extension() == ".png" || entry.path().extension() == ".part";
        if (ours && entry.is_regular_file(ignored) && named.count(entry.path().string()) == 0) {
            loose.push_back(entry.path());
        }
    }
    for (const fs::path &path : loose) {
        recovery.pictures_loose += path.extension() == ".png";
        fs::remove(path, ignored);
    }
}

void write_down(Database &database, ScanRecovery &recovery)
{
    recovery.words.insert(recovery.words.begin(),
                          "the recording was cut off; " + std::to_string(recovery.rows) +
                              " rows are there");
    if (recovery.pictures_loose > 0) {
        recovery.words.push_back(std::to_string(recovery.pictures_loose) +
                                 " pictures were stored but not yet in the books: removed");
    }
    std::string text;
    for (const std::string &word : recovery.words) {
        text += (text.empty() ? "" : "\n") + word;
    }
    Statement insert(database, "INSERT INTO recoveries (wall_ns, text) VALUES (?, ?)");
    insert.bind(1, SystemClock().wall_ns());
    insert.bind(2, text);
    insert.step();
}

void recover(const fs::path &folder, ScanRecovery &recovery)
{
    Database database((folder / SCAN_DATABASE_NAME).string(), Database::Access::write);
    database.run("PRAGMA synchronous = FULL");
    scan_schema_version(database);
    check_structure(database);
    scan_schema_migrate(database);
    recovery.needed = database.integer("SELECT (SELECT count(*) FROM scan_end) + "
                                       "(SELECT count(*) FROM recoveries)") == 0;
    if (recovery.needed) {
        database.run("BEGIN IMMEDIATE");
        remove_loose(folder, check_named(database, folder, recovery), recovery);
        count(database, recovery);
        write_down(database, recovery);
        database.run("COMMIT");
    } else {
        count(database, recovery);
    }
    database.run("PRAGMA wal_checkpoint(TRUNCATE)");
    database.close();
}

}  // namespace

bool recover_scan(const std::string &path, ScanRecovery &recovery, std::string &error)
{
    recovery = ScanRecovery();
    error.clear();
    const fs::path folder = scan_folder_of(path);
    if (!fs::is_regular_file(folder / SCAN_DATABASE_NAME)) {
        error = path + ": is no scan: there is no " + SCAN_DATABASE_NAME;
        return false;
    }
    bool held = false;
    const std::string lock_path = (folder / SCAN_LOCK_NAME).string();
    const auto lock = ScanLock::take(lock_path, LOCK_WAIT_MS, held, error);
    if (!lock) {
        error = held ? path + ": is being recorded; it can be mended when that has ended" : error;
        return false;
    }
    try {
        recover(folder, recovery);
    } catch (const DatabaseError &what) {
        error = path + ": " + what.what();
    }
    std::error_code ignored;
    fs::remove(lock_path, ignored);
    FileTrouble trouble;
    folder_sync(folder.string(), trouble);
    return error.empty();
}

}  // namespace opms_host
