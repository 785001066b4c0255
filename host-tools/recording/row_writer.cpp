/* SPDX-License-Identifier: Apache-2.0 */
#include "row_writer.hpp"

#include <string>

#include "column_visitors.hpp"
#include "record_columns.hpp"

namespace opms_host {

namespace {

template <typename Record> Statement insert_of(Database &database)
{
    ListColumns list(true);
    const Record record{};
    columns(list, record);
    std::string marks = "?";
    for (int i = 1; i < list.count(); i++) {
        marks += ", ?";
    }
    return Statement(database, std::string("INSERT INTO ") + RecordTable<Record>::name + " (" +
                                   list.names() + ") VALUES (" + marks + ")");
}

/** Ready again for the next row, however this one went. */
class Reset {
public:
    explicit Reset(Statement &statement) : statement_(statement) {}
    ~Reset() { statement_.reset(); }

private:
    Statement &statement_;
};

template <typename Value> std::size_t bytes_of(const std::vector<Value> &values)
{
    return values.size() * sizeof(Value);
}

}  // namespace

std::size_t row_bytes(const Row &row)
{
    std::size_t bytes = sizeof(Row);
    if (const auto *pose = std::get_if<std::shared_ptr<const PoseRecord>>(&row)) {
        bytes += sizeof(PoseRecord) + bytes_of((*pose)->squares) + bytes_of((*pose)->edges) +
                 bytes_of((*pose)->residuals_px);
    } else if (const auto *sample = std::get_if<SensorRecord>(&row)) {
        bytes += bytes_of(sample->values) + sample->data_json.size();
    } else if (const auto *event = std::get_if<EventRecord>(&row)) {
        bytes += event->text.size() + event->data_json.size();
    }
    return bytes;
}

RowWriter::RowWriter(Database &database, bool edges)
    : edges_(edges), frames_(insert_of<FrameRecord>(database)),
      triggers_(insert_of<TriggerRecord>(database)), pairs_(insert_of<PairRecord>(database)),
      poses_(insert_of<PoseRecord>(database)), events_(insert_of<EventRecord>(database)),
      clock_(insert_of<ClockRecord>(database)),
      box_reports_(insert_of<BoxReportRecord>(database)),
      sensors_(insert_of<SensorRecord>(database)),
      locations_(database, "INSERT INTO locations (number, location, squares, edges, residuals_px,"
                           " hint) VALUES (?, ?, ?, ?, ?, ?)"),
      pictures_(database, "INSERT INTO pictures (number, path, bytes, crc32) VALUES (?, ?, ?, ?)")
{
}

void RowWriter::write(const Row &row)
{
    std::visit([this](const auto &record) { write_one(record); }, row);
}

template <typename Record> void RowWriter::write_columns(Statement &insert, const Record &record)
{
    const Reset reset(insert);
    BindColumns bind(insert);
    columns(bind, record);
    insert.step();
}

void RowWriter::write_one(const std::shared_ptr<const PoseRecord> &record)
{
    write_columns(poses_, *record);
    write_location(*record);
}

void RowWriter::write_location(const PoseRecord &record)
{
    const Reset reset(locations_);
    Blob blob;
    const auto put = [&](int index, const auto &value) {
        blob_write(value, blob);
        locations_.bind_blob(index, blob);
    };
    locations_.bind(1, static_cast<std::int64_t>(record.number));
    put(2, record.location);
    put(3, record.squares);
    if (edges_) {
        put(4, record.edges);
        put(5, record.residuals_px);
    }
    if (record.has_hint) {
        put(6, record.hint);
    }
    locations_.step();
}

void RowWriter::write_one(const StoredPicture &picture)
{
    const Reset reset(pictures_);
    pictures_.bind(1, static_cast<std::int64_t>(picture.number));
    pictures_.bind(2, picture.path);
    pictures_.bind(3, static_cast<std::int64_t>(picture.bytes));
    pictures_.bind(4, static_cast<std::int64_t>(picture.crc32));
    pictures_.step();
}

}  // namespace opms_host
