/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_book.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <string>
#include <type_traits>

#include <sqlite3.h>

#include "book_fields.hpp"

namespace opms_host {

namespace {

class WriteKeys {
public:
    WriteKeys(Database &database, const std::string &table)
        : insert_(database, "INSERT OR REPLACE INTO " + table + " (key, value) VALUES (?, ?)")
    {
    }
    template <typename Field> void operator()(const char *key, const Field &field)
    {
        insert_.bind(1, std::string_view(key));
        if constexpr (std::is_integral_v<Field>) {
            insert_.bind(2, static_cast<std::int64_t>(field));
        } else {
            insert_.bind(2, field);
        }
        insert_.step();
        insert_.reset();
    }
    template <typename Enum, std::size_t N>
    void state(const char *key, const Enum &field, const Words<N> &words)
    {
        const auto number = std::min(static_cast<std::size_t>(field), N - 1);
        (*this)(key, std::string(words[number]));
    }
    template <std::size_t N> void text(const char *key, const char (&field)[N])
    {
        (*this)(key, std::string(field, strnlen(field, N)));
    }
    template <std::size_t N> void hex(const char *key, const std::uint8_t (&field)[N])
    {
        static const char digits[] = "0123456789ABCDEF";
        std::string value;
        for (const std::uint8_t byte : field) {
            value += digits[byte >> 4];
            value += digits[byte & 15];
        }
        (*this)(key, value);
    }

private:
    Statement insert_;
};

/** A key that is missing leaves its field as it is: versions add keys. */
class ReadKeys {
public:
    ReadKeys(Database &database, const std::string &table)
    {
        Statement rows(database, "SELECT key, value FROM " + table);
        while (rows.step()) {
            Value &value = values_[rows.text(0)];
            value.type = rows.type(1);
            value.integer = rows.integer(1);
            value.real = rows.real(1);
            value.text = value.type == SQLITE_TEXT ? rows.text(1) : std::string();
        }
    }
    bool empty() const { return values_.empty(); }

    template <typename Field> void operator()(const char *key, Field &field)
    {
        if constexpr (std::is_same_v<Field, std::string>) {
            if (const Value *value = find(key, SQLITE_TEXT)) {
                field = value->text;
            }
        } else if constexpr (std::is_floating_point_v<Field>) {
            if (const Value *value = find(key, SQLITE_FLOAT)) {
                field = value->real;
            }
        } else if (const Value *value = find(key, SQLITE_INTEGER)) {
            field = static_cast<Field>(value->integer);
            if (static_cast<std::int64_t>(field) != value->integer) {
                refuse(key);
            }
        }
    }
    template <typename Enum, std::size_t N>
    void state(const char *key, Enum &field, const Words<N> &words)
    {
        const Value *value = find(key, SQLITE_TEXT);
        if (!value) {
            return;
        }
        const auto word = std::find(words.begin(), words.end(), value->text);
        if (word == words.end()) {
            refuse(key);
        }
        field = static_cast<Enum>(word - words.begin());
    }
    template <std::size_t N> void text(const char *key, char (&field)[N])
    {
        if (const Value *value = find(key, SQLITE_TEXT)) {
            const std::size_t size = std::min(value->text.size(), N - 1);
            std::memcpy(field, value->text.data(), size);
            field[size] = '\0';
        }
    }
    template <std::size_t N> void hex(const char *key, std::uint8_t (&field)[N])
    {
        const Value *value = find(key, SQLITE_TEXT);
        if (!value) {
            return;
        }
        if (value->text.size() != 2 * N ||
            value->text.find_first_not_of("0123456789ABCDEF") != std::string::npos) {
            refuse(key);
        }
        for (std::size_t i = 0; i < N; i++) {
            field[i] = static_cast<std::uint8_t>(
                std::stoi(value->text.substr(2 * i, 2), nullptr, 16));
        }
    }

private:
    struct Value {
        int type = SQLITE_NULL;
        std::int64_t integer = 0;
        double real = 0;
        std::string text;
    };
    [[noreturn]] static void refuse(const char *key)
    {
        throw DatabaseError(DatabaseError::Kind::damaged,
                            std::string("is damaged: the value of ") + key + " cannot be right");
    }
    const Value *find(const char *key, int type) const
    {
        const auto found = values_.find(key);
        if (found == values_.end() || found->second.type == SQLITE_NULL) {
            return nullptr;
        }
        if (found->second.type != type) {
            refuse(key);
        }
        return &found->second;
    }
    std::map<std::string, Value> values_;
};

/** Names the counts twice: for the query and as keys. */
template <typename Visit> void count_fields(Visit &&visit, ScanSummary &summary)
{
    visit("triggers", "count(*) FROM triggers", summary.triggers);
    visit("frames", "count(*) FROM frames", summary.frames);
    visit("pairs", "count(*) FROM pairs", summary.pairs);
    visit("poses", "count(*) FROM poses", summary.poses);
    visit("poses_with_time", "count(t_scan_ns) FROM poses", summary.poses_with_time);
    visit("pictures", "count(*) FROM pictures", summary.pictures);
    visit("events", "count(*) FROM events", summary.events);
    visit("sensor_samples", "count(*) FROM sensor_samples", summary.sensor_samples);
}

void count_rows(Database &database, ScanSummary &summary)
{
    count_fields(
        [&](const char *, const char *sql, std::uint64_t &count) {
            count = static_cast<std::uint64_t>(database.integer(std::string("SELECT ") + sql));
        },
        summary);
}

double duration_s(Database &database)
{
    const std::string arrival = "SELECT arrival_host_ns FROM frames ORDER BY number ";
    const std::int64_t first = database.integer(arrival + "LIMIT 1");
    const std::int64_t last = database.integer(arrival + "DESC LIMIT 1");
    return last > first ? (static_cast<double>(last) - static_cast<double>(first)) * 1e-9 : 0;
}

}  // namespace

void book_write(Database &database, const ScanHeader &header)
{
    WriteKeys keys(database, "scan_header");
    header_fields(keys, header);
}

void book_read(Database &database, ScanHeader &header)
{
    ReadKeys keys(database, "scan_header");
    header_fields(keys, header);
}

void book_write(Database &database, const ScanEnd &end)
{
    ScanSummary summary;
    count_rows(database, summary);
    WriteKeys keys(database, "scan_end");
    end_fields(keys, end);
    count_fields(
        [&](const char *name, const char *, const std::uint64_t &count) {
            keys((std::string("rows.") + name).c_str(), count);
        },
        summary);
}

bool book_read(Database &database, ScanEnd &end)
{
    ReadKeys keys(database, "scan_end");
    end_fields(keys, end);
    return !keys.empty();
}

void book_count(Database &database, ScanSummary &summary)
{
    summary.duration_s = duration_s(database);
    if (!summary.ended) {
        count_rows(database, summary);
        return;
    }
    ReadKeys keys(database, "scan_end");
    count_fields(
        [&](const char *name, const char *, std::uint64_t &count) {
            keys((std::string("rows.") + name).c_str(), count);
        },
        summary);
}

}  // namespace opms_host
