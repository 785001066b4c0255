/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * SQLite with C++'s way of freeing things. Errors are thrown: inside of this folder only. */
#ifndef OPMS_RECORDING_SQLITE_DATABASE_HPP
#define OPMS_RECORDING_SQLITE_DATABASE_HPP

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace opms_host {

/** What SQLite says, for people; and what kind of trouble it is. */
class DatabaseError : public std::runtime_error {
public:
    enum class Kind {
        other,
        full,       /**< no room on the disk */
        constraint, /**< this row does not fit; nothing else is amiss */
        damaged,    /**< no database, or one that does not hold together */
        cannot_open
    };
    DatabaseError(Kind kind, const std::string &text) : std::runtime_error(text), kind_(kind) {}
    Kind kind() const { return kind_; }

private:
    Kind kind_;
};

class Database {
public:
    enum class Access {
        create,    /**< make it; it must not hold anything */
        write,     /**< it is there */
        read,      /**< while somebody writes it */
        read_alone, /**< nobody writes it: its -wal is read, too, and nothing is made beside it */
        read_whole  /**< nobody writes it, and there is no -wal */
    };
    Database(const std::string &path, Access access);
    ~Database();
    Database(const Database &) = delete;
    Database &operator=(const Database &) = delete;

    /** One or more statements without results. */
    void run(const std::string &sql);
    std::int64_t integer(const std::string &sql);
    std::string text(const std::string &sql);
    bool is_in_transaction() const;
    /** Make this one, in memory, a copy of @p other. */
    void copy_from(Database &other);
    /** Close and say whether that went well; the destructor does not. */
    void close();
    sqlite3 *handle() const { return handle_; }

private:
    sqlite3 *handle_ = nullptr;
};

/** A statement that is prepared once. Indices of parameters from 1, of columns from 0. */
class Statement {
public:
    Statement(Database &database, const std::string &sql);
    ~Statement();
    Statement(Statement &&other) noexcept;
    Statement(const Statement &) = delete;
    Statement &operator=(const Statement &) = delete;

    void bind(int index, std::int64_t value);
    void bind(int index, double value); /**< NaN becomes NULL */
    void bind(int index, std::string_view value);
    void bind_blob(int index, const std::vector<std::uint8_t> &value);
    void bind_null(int index);

    bool step(); /**< whether there is a row */
    void reset();

    bool is_null(int column) const;
    std::int64_t integer(int column) const;
    double real(int column) const; /**< NULL becomes NaN */
    std::string text(int column) const;
    /** Valid until the next step. */
    std::basic_string_view<std::uint8_t> blob(int column) const;
    int type(int column) const;

private:
    Database *database_;
    sqlite3_stmt *handle_ = nullptr;
};

}  // namespace opms_host
#endif
