/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_reader.hpp"

#include <filesystem>
#include <utility>

#include "column_visitors.hpp"
#include "record_columns.hpp"
#include "scan_files.hpp"
#include "scan_open.hpp"

namespace opms_host {

namespace {

/** "SELECT <columns that are read back> FROM <table> " */
template <typename Record> std::string select_of()
{
    ListColumns list(false);
    const Record record{};
    columns(list, record);
    return "SELECT " + list.names() + " FROM " + RecordTable<Record>::name + " ";
}

/* A pose's location stands in a table of its own, so that a person's queries need not wade through
 * it. Its columns come after those of the pose. */
std::string select_of_poses(const char *where)
{
    ListColumns list(false);
    const PoseRecord record{};
    columns(list, record);
    return "SELECT " + list.names() +
           ", location, location_squares, location_edges, residuals_px, hint FROM poses LEFT JOIN "
           "(SELECT number AS location_number, location, squares AS location_squares, "
           "edges AS location_edges, residuals_px, hint FROM locations) "
           "ON location_number = number " +
           where;
}

void take_location(const Statement &row, int column, PoseRecord &record)
{
    if (row.is_null(column)) {
        return; /* the pose alone, of a table that was mended by hand */
    }
    const bool good = blob_read(row.blob(column), record.location) &&
                      blob_read(row.blob(column + 1), record.squares) &&
                      blob_read(row.blob(column + 2), record.edges) &&
                      blob_read(row.blob(column + 3), record.residuals_px);
    record.has_hint = !row.is_null(column + 4);
    if (!good || (record.has_hint && !blob_read(row.blob(column + 4), record.hint))) {
        throw DatabaseError(DatabaseError::Kind::damaged,
                            "is damaged: the location of picture " +
                                std::to_string(record.number) + " cannot be right");
    }
}

PoseRecord take_pose(const Statement &row)
{
    PoseRecord record;
    ReadColumns read(row);
    columns(read, record);
    take_location(row, read.next(), record);
    return record;
}

}  // namespace

class ScanReader::Impl {
public:
    explicit Impl(const std::string &path)
    {
        summary_.folder = scan_folder_of(path);
        std::int64_t version = 0;
        database_ = scan_open_for_reading(summary_.folder, version);
        scan_summarize(*database_, summary_);
        summary_.schema_version = static_cast<std::uint32_t>(version);
    }

    const ScanSummary &summary() const { return summary_; }

    template <typename Record> bool each(const Each<Record> &take, std::string &error)
    {
        const std::string sql = select_of<Record>() + "ORDER BY " + RecordTable<Record>::key;
        return rows(sql, error, [&](const Statement &row) {
            Record record;
            ReadColumns read(row);
            columns(read, record);
            return take(record);
        });
    }

    /** @param take  Given each row until it returns false. */
    template <typename Take> bool rows(const std::string &sql, std::string &error, const Take &take)
    {
        try {
            Statement row(*database_, sql);
            while (row.step() && take(row)) {
            }
            return true;
        } catch (const DatabaseError &what) {
            error = summary_.folder + ": " + what.what();
            return false;
        }
    }

private:
    std::unique_ptr<Database> database_;
    ScanSummary summary_;
};

ScanReader::ScanReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ScanReader::~ScanReader() = default;

std::unique_ptr<ScanReader> ScanReader::open(const std::string &folder, std::string &error)
{
    try {
        return std::unique_ptr<ScanReader>(new ScanReader(std::make_unique<Impl>(folder)));
    } catch (const DatabaseError &what) {
        error = folder + ": " + what.what();
    }
    return nullptr;
}

const ScanSummary &ScanReader::summary() const
{
    return impl_->summary();
}

bool ScanReader::each_frame(const Each<FrameRecord> &take, std::string &error)
{
    return impl_->each(take, error);
}
bool ScanReader::each_trigger(const Each<TriggerRecord> &take, std::string &error)
{
    return impl_->each(take, error);
}
bool ScanReader::each_pair(const Each<PairRecord> &take, std::string &error)
{
    return impl_->each(take, error);
}
bool ScanReader::each_event(const Each<EventRecord> &take, std::string &error)
{
    return impl_->each(take, error);
}
bool ScanReader::each_clock(const Each<ClockRecord> &take, std::string &error)
{
    return impl_->each(take, error);
}
bool ScanReader::each_box_report(const Each<BoxReportRecord> &take, std::string &error)
{
    return impl_->each(take, error);
}
bool ScanReader::each_sensor(const Each<SensorRecord> &take, std::string &error)
{
    return impl_->each(take, error);
}

bool ScanReader::each_pose(const Each<PoseRecord> &take, std::string &error)
{
    return impl_->rows(select_of_poses("ORDER BY number"), error,
                       [&](const Statement &row) { return take(take_pose(row)); });
}

bool ScanReader::pose(std::uint64_t number, PoseRecord &record, std::string &error)
{
    bool found = false;
    const std::string where =
        "WHERE number = " + std::to_string(static_cast<std::int64_t>(number));
    const bool read = impl_->rows(select_of_poses(where.c_str()), error, [&](const Statement &row) {
        record = take_pose(row);
        found = true;
        return false;
    });
    if (read && !found) {
        error = "there is no pose of picture " + std::to_string(number);
    }
    return found;
}

bool ScanReader::each_picture(const Each<PictureRow> &take, std::string &error)
{
    const std::filesystem::path folder = summary().folder;
    return impl_->rows("SELECT number, path, bytes, crc32 FROM pictures ORDER BY number", error,
                       [&](const Statement &row) {
                           PictureRow picture;
                           picture.number = static_cast<std::uint64_t>(row.integer(0));
                           picture.path = (folder / row.text(1)).string();
                           picture.bytes = static_cast<std::uint64_t>(row.integer(2));
                           picture.crc32 = row.integer(3);
                           return take(picture);
                       });
}

bool picture_is_whole(const PictureRow &picture, std::string &error)
{
    std::uint64_t bytes = 0;
    std::uint32_t crc32 = 0;
    if (!file_crc32(picture.path, bytes, crc32)) {
        error = picture.path + ": is missing, or cannot be read";
    } else if (bytes != picture.bytes) {
        error = picture.path + ": has " + std::to_string(bytes) + " bytes, not " +
                std::to_string(picture.bytes);
    } else if (picture.crc32 >= 0 && picture.crc32 != static_cast<std::int64_t>(crc32)) {
        error = picture.path + ": is not as it was stored: its sum differs";
    } else {
        return true;
    }
    return false;
}

}  // namespace opms_host
