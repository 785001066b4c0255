/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What is done with the columns of a record (record_columns.hpp): they are listed, bound, read. */
#ifndef OPMS_RECORDING_COLUMN_VISITORS_HPP
#define OPMS_RECORDING_COLUMN_VISITORS_HPP

#include <cstring>
#include <string>
#include <type_traits>

#include <sqlite3.h>

#include "column_names.hpp"
#include "little_endian_blob.hpp"
#include "sqlite_database.hpp"

namespace opms_host {

/** Names of all columns, or of those that are read back. */
class ListColumns {
public:
    explicit ListColumns(bool with_shown) : with_shown_(with_shown) {}
    const std::string &names() const { return names_; }
    int count() const { return count_; }

    template <typename Field> void operator()(const char *name, const Field &) { add(name); }
    template <typename Enum, std::size_t N>
    void state(const char *name, const Enum &, const Words<N> &)
    {
        add(name);
    }
    void where(const char *name, bool, const std::int64_t &) { add(name); }
    template <typename Field> void bytes(const char *name, const Field &) { add(name); }
    template <typename Field> void blob(const char *name, const Field &) { add(name); }
    template <typename Field> void shown(const char *name, bool, const Field &)
    {
        if (with_shown_) {
            add(name);
        }
    }

private:
    void add(const char *name)
    {
        names_ += count_++ > 0 ? std::string(", ") + name : std::string(name);
    }
    bool with_shown_;
    std::string names_;
    int count_ = 0;
};

/** Binds a record to an INSERT of all columns. */
class BindColumns {
public:
    explicit BindColumns(Statement &statement) : statement_(statement) {}

    template <typename Field> void operator()(const char *, const Field &field)
    {
        if constexpr (std::is_integral_v<Field>) {
            statement_.bind(++index_, static_cast<std::int64_t>(field));
        } else {
            statement_.bind(++index_, field);
        }
    }
    template <typename Enum, std::size_t N>
    void state(const char *name, const Enum &field, const Words<N> &words)
    {
        const auto number = static_cast<std::size_t>(field);
        if (number >= N) {
            throw DatabaseError(DatabaseError::Kind::constraint,
                                std::string(name) + " is no state that is known");
        }
        statement_.bind(++index_, std::string_view(words[number]));
    }
    void where(const char *, bool known, const std::int64_t &field)
    {
        known ? statement_.bind(++index_, field) : statement_.bind_null(++index_);
    }
    template <typename Bytes> void bytes(const char *, const Bytes &field)
    {
        statement_.bind_blob(++index_, Blob(field.begin(), field.end()));
    }
    template <typename Field> void blob(const char *, const Field &field)
    {
        Blob bytes;
        blob_write(field, bytes);
        statement_.bind_blob(++index_, bytes);
    }
    template <typename Field> void shown(const char *, bool known, const Field &field)
    {
        known ? statement_.bind(++index_, field) : statement_.bind_null(++index_);
    }

private:
    Statement &statement_;
    int index_ = 0;
};

/** Reads a record from a SELECT of the columns that are read back, from column @p first on.
 * @throws DatabaseError where a value cannot be that of its field. */
class ReadColumns {
public:
    explicit ReadColumns(const Statement &row, int first = 0) : row_(row), column_(first) {}
    int next() const { return column_; }

    template <typename Field> void operator()(const char *name, Field &field)
    {
        const int column = column_++;
        if constexpr (std::is_same_v<Field, std::string>) {
            expect(name, column, SQLITE_TEXT);
            field = row_.text(column);
        } else if constexpr (std::is_floating_point_v<Field>) {
            if (!row_.is_null(column)) {
                expect(name, column, SQLITE_FLOAT);
            }
            field = row_.real(column);
        } else {
            expect(name, column, SQLITE_INTEGER);
            field = integer<Field>(name, row_.integer(column));
        }
    }
    template <typename Enum, std::size_t N>
    void state(const char *name, Enum &field, const Words<N> &words)
    {
        const std::string word = row_.text(column_++);
        for (std::size_t i = 0; i < N; i++) {
            if (word == words[i]) {
                field = static_cast<Enum>(i);
                return;
            }
        }
        refuse(name);
    }
    void where(const char *name, bool &known, std::int64_t &field)
    {
        known = !row_.is_null(column_);
        if (known) {
            (*this)(name, field);
        } else {
            column_++;
        }
    }
    template <typename Bytes> void bytes(const char *name, Bytes &field)
    {
        const BlobView view = row_.blob(column_++);
        if (view.size() != field.size()) {
            refuse(name);
        }
        std::memcpy(field.data(), view.data(), view.size());
    }
    template <typename Field> void blob(const char *name, Field &field)
    {
        if (!blob_read(row_.blob(column_++), field)) {
            refuse(name);
        }
    }
    template <typename Field> void shown(const char *, bool, const Field &) {}

private:
    [[noreturn]] static void refuse(const char *name)
    {
        throw DatabaseError(DatabaseError::Kind::damaged,
                            std::string("is damaged: a ") + name + " cannot be right");
    }
    void expect(const char *name, int column, int type) const
    {
        if (row_.type(column) != type) {
            refuse(name);
        }
    }
    /** 64 bit numbers without sign stand in the table as those with the same bits. */
    template <typename Field> static Field integer(const char *name, std::int64_t value)
    {
        const auto field = static_cast<Field>(value);
        if (static_cast<std::int64_t>(field) != value) {
            refuse(name);
        }
        return field;
    }

    const Statement &row_;
    int column_;
};

}  // namespace opms_host
#endif
