/* SPDX-License-Identifier: Apache-2.0 */
#include "catalogue_verify.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

#include <sqlite3.h>

#include "catalogue_state.hpp"
#include "picture_file.hpp"
#include "scan_reader.hpp"

using namespace opms_host;

namespace {

constexpr std::size_t PROBLEMS_SHOWN = 100;

struct DatabaseCloser {
    void operator()(sqlite3 *database) const { sqlite3_close(database); }
};

int take_check(void *outcome, int count, char **values, char **)
{
    if (count > 0 && values[0] && std::string(values[0]) != "ok") {
        static_cast<VerifyOutcome *>(outcome)->problem(std::string("scan.sqlite: ") + values[0]);
    }
    return 0;
}

void check_database(const std::string &folder, VerifyOutcome &outcome)
{
    std::error_code ignored;
    const std::filesystem::path path(folder);
    const std::string file =
        std::filesystem::is_directory(path, ignored) ? (path / "scan.sqlite").string() : folder;
    sqlite3 *opened = nullptr;
    int status = sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
    const std::unique_ptr<sqlite3, DatabaseCloser> database(opened);
    if (status == SQLITE_OK) {
        sqlite3_busy_timeout(opened, 5000);
        status = sqlite3_exec(opened, "PRAGMA integrity_check(20); PRAGMA foreign_key_check;",
                              take_check, &outcome, nullptr);
    }
    if (status != SQLITE_OK) {
        outcome.problem(file + ": " + sqlite3_errmsg(opened));
    }
}

/** Times of one kind of record, which must not fall. */
class Ascending {
public:
    explicit Ascending(const char *what) : what_(what) {}
    void take(std::int64_t t_ns, std::uint64_t number, VerifyOutcome &outcome)
    {
        if (any_ && t_ns < last_) {
            outcome.problem(std::string(what_) + " " + std::to_string(number) +
                            " lies before the one that was recorded before it");
        }
        last_ = t_ns;
        any_ = true;
    }

private:
    const char *what_;
    std::int64_t last_ = 0;
    bool any_ = false;
};

class ScanCheck {
public:
    ScanCheck(ScanReader &scan, VerifyOutcome &outcome) : scan_(scan), outcome_(outcome) {}

    void run()
    {
        std::string error;
        if (!check_frames(error) || !check_pairs(error) || !check_poses(error) ||
            !check_clock(error) || !check_pictures(error)) {
            outcome_.problem(error);
        }
        check_end();
    }

private:
    bool check_frames(std::string &error)
    {
        Ascending arrivals("frame");
        return scan_.each_frame(
            [&](const FrameRecord &frame) {
                if (!frames_.insert(frame.number).second || frame.number == 0) {
                    outcome_.problem("frame " + std::to_string(frame.number) +
                                     " is there twice or has no number");
                }
                arrivals.take(frame.arrival_host_ns, frame.number, outcome_);
                return true;
            },
            error);
    }

    /** Each trigger and each frame ends once. */
    bool check_pairs(std::string &error)
    {
        const bool read = scan_.each_pair(
            [this](const PairRecord &pair) {
                const opms_pair_result_t &result = pair.result;
                if (result.frame_state != OPMS_FRAME_NONE &&
                    !frames_ended_.insert(result.frame.tag).second) {
                    outcome_.problem("frame " + std::to_string(result.frame.tag) +
                                     " has two fates");
                }
                for (std::uint32_t i = 0;
                     result.trigger_state != OPMS_TRIGGER_NONE && i < result.trigger_count; i++) {
                    if (!triggers_ended_.insert(result.trigger_number + i).second) {
                        outcome_.problem("trigger " + std::to_string(result.trigger_number + i) +
                                         " has two fates");
                    }
                }
                return true;
            },
            error);
        return read;
    }

    bool check_poses(std::string &error)
    {
        Ascending times("pose");
        return scan_.each_pose(
            [&](const PoseRecord &pose) {
                if (frames_.count(pose.number) == 0) {
                    outcome_.problem("pose " + std::to_string(pose.number) + " has no frame");
                }
                if (pose.has_time) {
                    times.take(pose.t_scan_ns, pose.number, outcome_);
                }
                return true;
            },
            error);
    }

    bool check_clock(std::string &error)
    {
        Ascending times("clock sample");
        std::uint64_t number = 0;
        return scan_.each_clock(
            [&](const ClockRecord &record) {
                times.take(record.trip.arrived_host_ns, ++number, outcome_);
                return true;
            },
            error);
    }

    bool check_pictures(std::string &error)
    {
        const ScanHeader &header = scan_.summary().header;
        return scan_.each_picture(
            [&](const PictureRow &picture) {
                std::string why;
                outcome_.pictures++;
                if (!picture_is_whole(picture, why) ||
                    picture_read(picture.path, header.width_px, header.height_px, why).empty()) {
                    outcome_.problem(picture.path + ": " + why);
                }
                if (frames_.count(picture.number) == 0) {
                    outcome_.problem(picture.path + ": its frame " +
                                     std::to_string(picture.number) + " is not in the books");
                }
                return true;
            },
            error);
    }

    /** The sums of the pairer against what is in the books, where the scan was closed in order. */
    void check_end()
    {
        const ScanSummary &summary = scan_.summary();
        if (summary.being_recorded) {
            outcome_.notes.push_back("is being recorded: sums are of what is there by now");
            return;
        }
        if (!summary.ended && !summary.recovered) {
            outcome_.problem("was cut off: 'opms catalogue verify --mend' brings it in order");
            return;
        }
        if (!summary.ended || !summary.end.has_summary) {
            return; /* nobody counted to the end */
        }
        const opms_pair_counters_t &n = summary.end.summary.counters;
        if (!summary.end.summary.sums_hold) {
            outcome_.problem("the sums of triggers and frames did not hold at the end");
        }
        check_sum("triggers with a fate", triggers_ended_.size(), n.triggers - n.triggers_pending);
        check_sum("frames with a fate", frames_ended_.size(), n.frames - n.frames_pending);
    }

    void check_sum(const char *what, std::uint64_t found, std::uint64_t counted)
    {
        if (found != counted) {
            outcome_.problem(std::string(what) + ": " + std::to_string(found) +
                             " are recorded, but the pairer counted " + std::to_string(counted));
        }
    }

    ScanReader &scan_;
    VerifyOutcome &outcome_;
    std::set<std::uint64_t> frames_, frames_ended_, triggers_ended_;
};

}  // namespace

void VerifyOutcome::problem(const std::string &words)
{
    problem_count++;
    if (problems.size() < PROBLEMS_SHOWN) {
        problems.push_back(words);
    }
}

VerifyOutcome catalogue_verify(const std::string &folder)
{
    VerifyOutcome outcome;
    std::string error;
    outcome.name = catalogue_name(folder);
    check_database(folder, outcome);
    const auto scan = ScanReader::open(folder, error);
    if (!scan) {
        outcome.problem(error);
        return outcome;
    }
    outcome.readable = true;
    ScanCheck(*scan, outcome).run();
    return outcome;
}
