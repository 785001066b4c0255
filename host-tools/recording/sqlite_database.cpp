/* SPDX-License-Identifier: Apache-2.0 */
#include "sqlite_database.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

#include <sqlite3.h>

namespace opms_host {

namespace {

/* No row of a scan comes near; a damaged file may claim anything. */
constexpr int ROW_BYTES_MAX = 64 << 20;

DatabaseError::Kind kind_of(int code, int system_errno)
{
    switch (code & 0xff) {
    case SQLITE_FULL: return DatabaseError::Kind::full;
    case SQLITE_CONSTRAINT:
    case SQLITE_MISMATCH:
    case SQLITE_TOOBIG: return DatabaseError::Kind::constraint;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB: return DatabaseError::Kind::damaged;
    case SQLITE_CANTOPEN: return DatabaseError::Kind::cannot_open;
    default: break;
    }
    const bool no_room = system_errno == ENOSPC || system_errno == EDQUOT;
    return (code & 0xff) == SQLITE_IOERR && no_room ? DatabaseError::Kind::full
                                                    : DatabaseError::Kind::other;
}

[[noreturn]] void fail(sqlite3 *handle)
{
    const int code = sqlite3_extended_errcode(handle);
    const int system_errno = sqlite3_system_errno(handle);
    std::string text = sqlite3_errmsg(handle);
    if ((code & 0xff) == SQLITE_IOERR && system_errno != 0) {
        text += std::string(": ") + std::strerror(system_errno);
    }
    throw DatabaseError(kind_of(code, system_errno), text);
}

int flags_of(Database::Access access)
{
    const int common = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI;
    switch (access) {
    case Database::Access::create: return common | SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    case Database::Access::write: return common | SQLITE_OPEN_READWRITE;
    case Database::Access::read:
    case Database::Access::read_alone:
    case Database::Access::read_whole: break;
    }
    return common | SQLITE_OPEN_READONLY;
}

/** As SQLite's URI, with what has a meaning there escaped. */
std::string uri_of(const std::string &path, Database::Access access)
{
    if (path == ":memory:") {
        return path;
    }
    std::string uri = "file:";
    for (const char c : path) {
        if (c == '%' || c == '?' || c == '#') {
            static const char digits[] = "0123456789ABCDEF";
            const auto byte = static_cast<unsigned char>(c);
            uri += {'%', digits[byte >> 4], digits[byte & 15]};
        } else {
            uri += c;
        }
    }
    return access == Database::Access::read_whole ? uri + "?immutable=1" : uri;
}

/** Without locks (by its file system "unix-none"), and with the index of the -wal in our own memory
 * instead of a file: so a scan that was cut off can be read on a full disk and where nothing may be
 * written. */
void stay_alone(sqlite3 *handle)
{
    sqlite3_db_config(handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    sqlite3_exec(handle, "PRAGMA locking_mode = EXCLUSIVE", nullptr, nullptr, nullptr);
}

/** A file from elsewhere must not be able to make us do more than read. */
void be_careful(sqlite3 *handle)
{
    sqlite3_extended_result_codes(handle, 1);
    sqlite3_busy_timeout(handle, 2000);
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, ROW_BYTES_MAX);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
}

}  // namespace

Database::Database(const std::string &path, Access access)
{
    const int code = sqlite3_open_v2(uri_of(path, access).c_str(), &handle_, flags_of(access),
                                     access == Access::read_alone ? "unix-none" : nullptr);
    if (code != SQLITE_OK) {
        const std::string text = handle_ ? sqlite3_errmsg(handle_) : "out of memory";
        const int system_errno = handle_ ? sqlite3_system_errno(handle_) : 0;
        sqlite3_close_v2(handle_);
        throw DatabaseError(kind_of(code, system_errno), text);
    }
    be_careful(handle_);
    if (access == Access::read_alone) {
        stay_alone(handle_);
    }
    try {
        run("PRAGMA cell_size_check = ON; PRAGMA foreign_keys = ON;");
    } catch (...) {
        sqlite3_close_v2(handle_);
        throw;
    }
}

Database::~Database()
{
    sqlite3_close_v2(handle_);
}

void Database::close()
{
    if (sqlite3_close(handle_) != SQLITE_OK) {
        fail(handle_);
    }
    handle_ = nullptr;
}

void Database::run(const std::string &sql)
{
    if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
        fail(handle_);
    }
}

std::int64_t Database::integer(const std::string &sql)
{
    Statement statement(*this, sql);
    return statement.step() ? statement.integer(0) : 0;
}

std::string Database::text(const std::string &sql)
{
    Statement statement(*this, sql);
    return statement.step() ? statement.text(0) : std::string();
}

bool Database::is_in_transaction() const
{
    return sqlite3_get_autocommit(handle_) == 0;
}

void Database::copy_from(Database &other)
{
    sqlite3_backup *backup = sqlite3_backup_init(handle_, "main", other.handle_, "main");
    if (!backup) {
        fail(handle_);
    }
    sqlite3_backup_step(backup, -1);
    if (sqlite3_backup_finish(backup) != SQLITE_OK) {
        fail(handle_);
    }
}

Statement::Statement(Database &database, const std::string &sql) : database_(&database)
{
    if (sqlite3_prepare_v3(database.handle(), sql.c_str(), -1, SQLITE_PREPARE_PERSISTENT, &handle_,
                           nullptr) != SQLITE_OK) {
        fail(database.handle());
    }
}

Statement::~Statement()
{
    sqlite3_finalize(handle_);
}

Statement::Statement(Statement &&other) noexcept
    : database_(other.database_), handle_(other.handle_)
{
    other.handle_ = nullptr;
}

void Statement::bind(int index, std::int64_t value)
{
    sqlite3_bind_int64(handle_, index, value);
}

void Statement::bind(int index, double value)
{
    if (std::isnan(value)) {
        bind_null(index);
    } else {
        sqlite3_bind_double(handle_, index, value);
    }
}

void Statement::bind(int index, std::string_view value)
{
    if (sqlite3_bind_text64(handle_, index, value.empty() ? "" : value.data(), value.size(),
                            SQLITE_TRANSIENT, SQLITE_UTF8) != SQLITE_OK) {
        fail(database_->handle());
    }
}

void Statement::bind_blob(int index, const std::vector<std::uint8_t> &value)
{
    static const std::uint8_t nothing = 0;
    if (sqlite3_bind_blob64(handle_, index, value.empty() ? &nothing : value.data(), value.size(),
                            SQLITE_TRANSIENT) != SQLITE_OK) {
        fail(database_->handle());
    }
}

void Statement::bind_null(int index)
{
    sqlite3_bind_null(handle_, index);
}

bool Statement::step()
{
    const int code = sqlite3_step(handle_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) {
        fail(database_->handle());
    }
    return code == SQLITE_ROW;
}

void Statement::reset()
{
    sqlite3_reset(handle_); /* its error is that of step(), which has told it */
    sqlite3_clear_bindings(handle_);
}

bool Statement::is_null(int column) const
{
    return sqlite3_column_type(handle_, column) == SQLITE_NULL;
}

std::int64_t Statement::integer(int column) const
{
    return sqlite3_column_int64(handle_, column);
}

double Statement::real(int column) const
{
    return is_null(column) ? std::numeric_limits<double>::quiet_NaN()
                           : sqlite3_column_double(handle_, column);
}

std::string Statement::text(int column) const
{
    const auto *text = reinterpret_cast<const char *>(sqlite3_column_text(handle_, column));
    const int size = sqlite3_column_bytes(handle_, column);
    return text ? std::string(text, static_cast<std::size_t>(size)) : std::string();
}

std::basic_string_view<std::uint8_t> Statement::blob(int column) const
{
    const auto *bytes = static_cast<const std::uint8_t *>(sqlite3_column_blob(handle_, column));
    const int size = sqlite3_column_bytes(handle_, column);
    return {bytes, bytes ? static_cast<std::size_t>(size) : 0};
}

int Statement::type(int column) const
{
    return sqlite3_column_type(handle_, column);
}

}  // namespace opms_host
