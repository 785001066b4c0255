/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_open.hpp"

#include <filesystem>

#include "scan_book.hpp"
#include "scan_folder.hpp"
#include "scan_lock.hpp"
#include "scan_schema.hpp"

namespace opms_host {

namespace {

namespace fs = std::filesystem;

std::uint64_t size_of(const fs::path &path)
{
    std::error_code code;
    const auto size = fs::file_size(path, code);
    return code ? 0 : size;
}

bool is_being_recorded(const fs::path &folder)
{
    return ScanLock::is_held((folder / SCAN_LOCK_NAME).string());
}

/** Nothing is made or changed, unless somebody is writing: then both share what SQLite keeps. */
std::unique_ptr<Database> open_file(const fs::path &folder)
{
    const std::string path = (folder / SCAN_DATABASE_NAME).string();
    auto access = Database::Access::read;
    if (!is_being_recorded(folder)) {
        access = size_of(path + "-wal") > 0 ? Database::Access::read_alone
                                            : Database::Access::read_whole;
    }
    return std::make_unique<Database>(path, access);
}

}  // namespace

std::string scan_folder_of(const std::string &path)
{
    std::error_code code;
    const fs::path absolute = fs::absolute(path, code).lexically_normal();
    const bool is_file = !code && fs::is_regular_file(absolute, code);
    fs::path folder = is_file ? absolute.parent_path() : absolute;
    return folder.has_filename() ? folder.string() : folder.parent_path().string();
}

std::unique_ptr<Database> scan_open_for_reading(const std::string &folder, std::int64_t &version)
{
    if (!fs::is_regular_file(fs::path(folder) / SCAN_DATABASE_NAME)) {
        throw DatabaseError(DatabaseError::Kind::cannot_open,
                            std::string("is no scan: there is no ") + SCAN_DATABASE_NAME);
    }
    auto database = open_file(folder);
    version = scan_schema_version(*database);
    if (version != SCAN_SCHEMA_VERSION) {
        /* The file stays as it is: what is read is a copy in memory, brought up to date. */
        auto copy = std::make_unique<Database>(":memory:", Database::Access::write);
        copy->copy_from(*database);
        scan_schema_migrate(*copy);
        database = std::move(copy);
    }
    return database;
}

void scan_summarize(Database &database, ScanSummary &summary)
{
    book_read(database, summary.header);
    summary.ended = book_read(database, summary.end);
    summary.name = summary.header.name;
    summary.being_recorded = is_being_recorded(summary.folder);
    summary.recovered = database.integer("SELECT count(*) FROM recoveries") > 0;
    book_count(database, summary);
    const std::string path = (fs::path(summary.folder) / SCAN_DATABASE_NAME).string();
    summary.bytes = size_of(path) + size_of(path + "-wal") +
                    static_cast<std::uint64_t>(database.integer("SELECT sum(bytes) FROM pictures"));
}

}  // namespace opms_host
