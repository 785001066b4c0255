/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Records to rows. */
#ifndef OPMS_RECORDING_ROW_WRITER_HPP
#define OPMS_RECORDING_ROW_WRITER_HPP

#include <memory>
#include <variant>

#include "picture_store.hpp"
#include "scan_records.hpp"
#include "sqlite_database.hpp"

namespace opms_host {

using Row = std::variant<FrameRecord, TriggerRecord, PairRecord, std::shared_ptr<const PoseRecord>,
                         EventRecord, ClockRecord, BoxReportRecord, SensorRecord, StoredPicture>;

/** What a row takes in memory while it waits, roughly. */
std::size_t row_bytes(const Row &row);

/** Throws DatabaseError. */
class RowWriter {
public:
    /** @param edges  Store the reference points, too. */
    RowWriter(Database &database, bool edges);
    void write(const Row &row);

private:
    template <typename Record> void write_columns(Statement &insert, const Record &record);
    void write_one(const FrameRecord &record) { write_columns(frames_, record); }
    void write_one(const TriggerRecord &record) { write_columns(triggers_, record); }
    void write_one(const PairRecord &record) { write_columns(pairs_, record); }
    void write_one(const EventRecord &record) { write_columns(events_, record); }
    void write_one(const ClockRecord &record) { write_columns(clock_, record); }
    void write_one(const BoxReportRecord &record) { write_columns(box_reports_, record); }
    void write_one(const SensorRecord &record) { write_columns(sensors_, record); }
    void write_one(const std::shared_ptr<const PoseRecord> &record);
    void write_one(const StoredPicture &picture);
    void write_location(const PoseRecord &record);

    const bool edges_;
    Statement frames_, triggers_, pairs_, poses_, events_, clock_, box_reports_, sensors_;
    Statement locations_, pictures_;
};

}  // namespace opms_host
#endif
