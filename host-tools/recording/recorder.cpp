/* SPDX-License-Identifier: Apache-2.0 */
/* One thread commits all that waits every commit_ms; PictureStore has two of its own and hands a
 * picture's row over only when the picture is on the disk. Trouble is acted on by the first thread
 * alone. Durability is of the real world: these waits are by the machine's clock, whatever clock
 * the scan goes by. */
#include "recorder.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include "picture_store.hpp"
#include "record_queue.hpp"
#include "scan_book.hpp"
#include "scan_folder.hpp"

namespace opms_host {

namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::int64_t TELL_EVERY_NS = 1000000000; /* pictures that were not stored */

const char *check(const RecorderOptions &options)
{
    if (options.picture_queue < 1 || options.picture_queue > 4096) {
        return "the queue of pictures holds 1 to 4096";
    }
    if (options.commit_ms < 20 || options.commit_ms > 900) {
        return "commits are 20 to 900 ms apart";
    }
    return nullptr;
}

std::uint64_t size_of(const std::string &path)
{
    std::error_code code;
    const auto size = std::filesystem::file_size(path, code);
    return code ? 0 : size;
}

}  // namespace

class Recorder::Impl {
public:
    Impl(const RecorderOptions &options, NewScanFolder made, std::shared_ptr<HostClock> clock)
        : options_(options), clock_(std::move(clock)), folder_(std::move(made.path)),
          lock_(std::move(made.lock)), path_(folder_ + "/" + SCAN_DATABASE_NAME), queue_(*clock_),
          database_(std::make_unique<Database>(path_, Database::Access::write)),
          writer_(std::make_unique<RowWriter>(*database_, options.edges)),
          synced_host_ns_(clock_->now_ns())
    {
        database_->run("PRAGMA synchronous = FULL");
        if (options.picture_every > 0) {
            pictures_ = std::make_unique<PictureStore>(
                folder_, options.picture_queue,
                PictureStore::Calls{[this](const StoredPicture &picture) { stored(picture); },
                                    [this](const FileTrouble &trouble) {
                                        report(trouble.is_full() ? RecordingState::full
                                                                 : RecordingState::failed,
                                               trouble.text);
                                    }});
        }
        thread_ = std::thread([this] { run(); });
    }

    ~Impl()
    {
        if (thread_.joinable()) {
            ScanEnd end;
            end.ended_wall_ns = clock_->wall_ns();
            end.ended_host_ns = clock_->now_ns();
            end.reason = "abandoned";
            std::string ignored;
            finish(end, ignored);
        }
    }

    void push(Row row)
    {
        if (state_ == RecordingState::on && !queue_.push(std::move(row))) {
            report(RecordingState::failed, "the disk has taken nothing for too long");
        }
    }

    void push_frame(const FrameRecord &record, const FramePtr &picture)
    {
        push(record);
        const bool due = pictures_ && picture && picture->image.pixels &&
                         (record.number - 1) % options_.picture_every == 0;
        if (due && !(state_ == RecordingState::on &&
                     pictures_->add(record.number, picture->image))) {
            not_stored_++;
        }
    }

    bool finish(const ScanEnd &end, std::string &error)
    {
        const std::lock_guard<std::mutex> guard(finishing_);
        if (!thread_.joinable()) {
            error = "the recording has ended already";
            return false;
        }
        if (pictures_) {
            pictures_->finish();
        }
        queue_.close();
        thread_.join();
        if (state_ != RecordingState::on) {
            const std::lock_guard<std::mutex> trouble(trouble_);
            error = trouble_text_;
            return false;
        }
        return close(end, error);
    }

    RecorderFigures figures() const
    {
        RecorderFigures figures;
        figures.state = state_;
        figures.rows = rows_;
        figures.pictures_stored = stored_;
        figures.pictures_not_stored = not_stored_;
        figures.queued_pictures = pictures_ ? pictures_->waiting() : 0;
        figures.queued_rows = queue_.size();
        figures.synced_host_ns = synced_host_ns_;
        figures.bytes = picture_bytes_ + size_of(path_) + size_of(path_ + "-wal");
        return figures;
    }

    const std::string &folder() const { return folder_; }

private:
    void run()
    {
        bool last = false;
        while (!last) {
            const auto deadline =
                SteadyClock::now() + std::chrono::milliseconds(options_.commit_ms);
            queue_.wait(deadline);
            last = queue_.is_closed();
            tell_of_pictures(last);
            std::int64_t taken_host_ns = 0;
            const std::vector<Row> rows = queue_.take(taken_host_ns);
            if (!commit(rows, taken_host_ns) || has_trouble()) {
                break;
            }
        }
        if (has_trouble()) {
            stop_for_trouble();
        }
    }

    bool commit(const std::vector<Row> &rows, std::int64_t taken_host_ns)
    {
        try {
            if (!rows.empty() || !own_events_.empty()) {
                database_->run("BEGIN IMMEDIATE");
                write_all(rows);
                for (const EventRecord &event : own_events_) {
                    writer_->write(event);
                }
                database_->run("COMMIT");
                rows_ += rows.size() + own_events_.size();
                own_events_.clear();
            }
            synced_host_ns_ = taken_host_ns;
            return true;
        } catch (const DatabaseError &what) {
            const bool full = what.kind() == DatabaseError::Kind::full || has_no_room();
            report(full ? RecordingState::full : RecordingState::failed,
                   path_ + ": " + what.what());
        }
        return false;
    }

    /** SQLite knows one kind of full disk only, and calls a used up quota an I/O error. */
    bool has_no_room() const
    {
        const std::string probe = folder_ + "/room.part";
        FileTrouble trouble;
        const bool wrote = file_write(probe, std::vector<std::uint8_t>(4096), trouble);
        std::error_code ignored;
        std::filesystem::remove(probe, ignored);
        return !wrote && trouble.is_full();
    }

    /** A row that cannot be (a number that is there already) costs itself and an event. */
    void write_all(const std::vector<Row> &rows)
    {
        for (const Row &row : rows) {
            try {
                writer_->write(row);
            } catch (const DatabaseError &what) {
                if (what.kind() != DatabaseError::Kind::constraint) {
                    throw;
                }
                tell(Severity::error, "recording.row_refused",
                     std::string("a row was not recorded: ") + what.what());
            }
        }
    }

    void stored(const StoredPicture &picture)
    {
        stored_++;
        picture_bytes_ += picture.bytes;
        push(picture);
    }

    /** To be acted on by run(); the first one counts. Any thread. */
    void report(RecordingState state, const std::string &text)
    {
        const std::lock_guard<std::mutex> guard(trouble_);
        if (trouble_state_ == RecordingState::on) {
            trouble_state_ = state;
            trouble_text_ = text;
            queue_.wake();
        }
    }

    bool has_trouble() const
    {
        const std::lock_guard<std::mutex> guard(trouble_);
        return trouble_state_ != RecordingState::on;
    }

    /** The scan goes on, its recording does not. */
    void stop_for_trouble()
    {
        RecordingState state = RecordingState::failed;
        std::string text;
        {
            const std::lock_guard<std::mutex> guard(trouble_);
            state = trouble_state_;
            text = trouble_text_;
        }
        state_ = state;
        queue_.close();
        if (pictures_) {
            pictures_->abandon();
        }
        const bool full = state == RecordingState::full;
        const EventRecord event =
            event_of(Severity::error, full ? "recording.full" : "recording.failed",
                     (full ? "the disk is full, the recording ends here: "
                           : "the recording ends here: ") + text);
        close_for_trouble(event);
        if (options_.on_event) {
            options_.on_event(event);
        }
    }

    /** With what room there is; where there is none, the scan is as one that was cut off. */
    void close_for_trouble(const EventRecord &event)
    {
        ScanEnd end;
        end.ended_wall_ns = clock_->wall_ns();
        end.ended_host_ns = event.t_host_ns;
        end.reason = event.code;
        try {
            if (database_->is_in_transaction()) {
                database_->run("ROLLBACK");
            }
            database_->run("PRAGMA wal_checkpoint(PASSIVE); BEGIN IMMEDIATE");
            writer_->write(event);
            book_write(*database_, end);
            database_->run("COMMIT");
        } catch (const DatabaseError &) {
            /* what was committed before is safe, and that is what matters here */
        }
        writer_.reset();
        database_.reset();
        release();
    }

    bool close(const ScanEnd &end, std::string &error)
    {
        error.clear();
        try {
            database_->run("BEGIN IMMEDIATE");
            book_write(*database_, end);
            database_->run("COMMIT; PRAGMA wal_checkpoint(TRUNCATE)");
            writer_.reset();
            database_->close();
            state_ = RecordingState::off;
        } catch (const DatabaseError &what) {
            error = path_ + ": " + what.what();
            state_ = what.kind() == DatabaseError::Kind::full ? RecordingState::full
                                                              : RecordingState::failed;
        }
        writer_.reset();
        database_.reset();
        release();
        return error.empty();
    }

    void release()
    {
        std::error_code ignored;
        std::filesystem::remove(folder_ + "/" + SCAN_LOCK_NAME, ignored);
        lock_.reset();
    }

    EventRecord event_of(Severity severity, const char *code, const std::string &text) const
    {
        EventRecord event;
        event.t_host_ns = clock_->now_ns();
        event.severity = severity;
        event.code = code;
        event.text = text;
        return event;
    }

    void tell(Severity severity, const char *code, const std::string &text)
    {
        const EventRecord event = event_of(severity, code, text);
        own_events_.push_back(event);
        if (options_.on_event) {
            options_.on_event(event);
        }
    }

    void tell_of_pictures(bool last)
    {
        const std::uint64_t not_stored = not_stored_;
        const std::int64_t now_ns = clock_->now_ns();
        if (not_stored == told_ || (told_ > 0 && now_ns - told_host_ns_ < TELL_EVERY_NS && !last)) {
            return;
        }
        tell(Severity::warning, "recording.pictures_not_stored",
             std::to_string(not_stored - told_) + " pictures came faster than they can be stored");
        told_ = not_stored;
        told_host_ns_ = now_ns;
    }

    const RecorderOptions options_;
    const std::shared_ptr<HostClock> clock_;
    const std::string folder_;
    std::unique_ptr<ScanLock> lock_;
    const std::string path_;
    RecordQueue queue_;
    std::unique_ptr<Database> database_; /**< by run() alone, then by finish() */
    std::unique_ptr<RowWriter> writer_;
    std::atomic<RecordingState> state_{RecordingState::on};
    std::atomic<std::uint64_t> rows_{0}, stored_{0}, not_stored_{0}, picture_bytes_{0};
    std::atomic<std::int64_t> synced_host_ns_;
    mutable std::mutex trouble_; /**< of the next two */
    RecordingState trouble_state_ = RecordingState::on;
    std::string trouble_text_;
    std::vector<EventRecord> own_events_; /**< with the next commit; this and the next: of run() */
    std::uint64_t told_ = 0;
    std::int64_t told_host_ns_ = 0;
    std::mutex finishing_;
    std::unique_ptr<PictureStore> pictures_;
    std::thread thread_;
};

Recorder::Recorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recorder::~Recorder() = default;

std::unique_ptr<Recorder> Recorder::begin(const RecorderOptions &options, const ScanHeader &header,
                                          std::shared_ptr<HostClock> clock, std::string &error)
{
    if (const char *wrong = check(options)) {
        error = wrong;
        return nullptr;
    }
    NewScanFolder made;
    if (!scan_folder_make(options.folder, header, made, error)) {
        return nullptr;
    }
    const std::string path = made.path;
    try {
        return std::unique_ptr<Recorder>(
            new Recorder(std::make_unique<Impl>(options, std::move(made), std::move(clock))));
    } catch (const DatabaseError &what) {
        error = path + ": " + what.what();
    }
    return nullptr;
}

void Recorder::add(const FrameRecord &record, const FramePtr &picture)
{
    impl_->push_frame(record, picture);
}
void Recorder::add(const TriggerRecord &record)
{
    impl_->push(record);
}
void Recorder::add(const PairRecord &record)
{
    impl_->push(record);
}
void Recorder::add(const std::shared_ptr<const PoseRecord> &record)
{
    impl_->push(record);
}
void Recorder::add(const EventRecord &record)
{
    impl_->push(record);
}
void Recorder::add(const ClockRecord &record)
{
    impl_->push(record);
}
void Recorder::add(const BoxReportRecord &record)
{
    impl_->push(record);
}
void Recorder::add(const SensorRecord &record)
{
    impl_->push(record);
}

RecorderFigures Recorder::figures() const
{
    return impl_->figures();
}

std::string Recorder::folder() const
{
    return impl_->folder();
}

bool Recorder::end(const ScanEnd &end, std::string &error)
{
    return impl_->finish(end, error);
}

}  // namespace opms_host
