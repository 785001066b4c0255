/* SPDX-License-Identifier: Apache-2.0 */
/* opms replay: a recorded scan's poses and pairs once more, and what changed. */
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "camera_file.hpp"
#include "code_versions.hpp"
#include "commands.hpp"
#include "csv_row.hpp"
#include "location_json.hpp"
#include "output_file.hpp"
#include "replay_rows.hpp"
#include "result_stream.hpp"
#include "scan_json.hpp"
#include "scans_folder.hpp"

namespace {

using namespace opms_host;

struct ReplayArguments {
    std::string scan, camera, from, out;
    std::uint64_t every = 1;
    bool all = false, pair = false, json = false;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

/** --out DIR: the new poses and the changes, each file as a whole or not at all. */
class ReplayFiles {
public:
    bool open(const std::string &folder, std::string &error)
    {
        std::error_code code;
        std::filesystem::create_directories(folder, code);
        if (code) {
            error = folder + ": " + code.message();
            return false;
        }
        const std::filesystem::path path(folder);
        poses_ = OutputFile::open((path / "poses.jsonl").string(), true, error);
        changes_ =
            poses_ ? OutputFile::open((path / "changes.csv").string(), true, error) : nullptr;
        if (changes_) {
            changes_->write(csv_heading({"picture", "state", "state_recorded", "identical",
                                         "position_mm", "angle_deg", "differs"}));
        }
        return changes_ != nullptr;
    }

    void take(const PoseChange &change, const PoseRecord &again)
    {
        if (!poses_) {
            return;
        }
        poses_->write(json_line(pose_json(again, PoseDetail::squares)) + "\n");
        std::string differs;
        for (const std::string &word : change.differs) {
            differs += (differs.empty() ? "" : " ") + word;
        }
        CsvRow row;
        row.integer(change.number).text(json_bar_state(change.again));
        row.text(json_bar_state(change.recorded)).integer(change.identical() ? 1 : 0);
        change.both_located ? row.number(change.position_mm).number(change.angle_deg)
                            : row.empty(2);
        changes_->write(row.text(differs).line());
    }

    bool finish(std::string &error)
    {
        return !poses_ || (poses_->finish(error) && changes_->finish(error));
    }

private:
    std::unique_ptr<OutputFile> poses_, changes_;
};

/** Alike to the last bit: all members are numbers without gaps between them. */
bool camera_equal(const opms_camera_t &a, const opms_camera_t &b)
{
    return std::memcmp(&a, &b, sizeof a) == 0;
}

/** The scan's own camera, or that of --camera. */
bool take_camera(const ReplayArguments &arguments, const ScanHeader &header, opms_camera_t &camera,
                 ReplayMeans &means, std::string &error)
{
    CameraFile own, other;
    const std::string &text = header.camera_file_text;
    std::string why = "it was recorded without one; give --camera";
    const bool has_own =
        !text.empty() && camera_file_parse(text.data(), text.size(), own, why);
    if (arguments.camera.empty()) {
        camera = own.camera;
        means.same_camera = has_own;
        if (!has_own) {
            error = "camera file of the scan: " + why;
        }
        return has_own;
    }
    if (!camera_file_read(arguments.camera, other, error)) {
        return false;
    }
    camera = other.camera;
    means.same_camera = has_own && camera_equal(own.camera, other.camera);
    return true;
}

ReplayFrom choose_source(const ReplayArguments &arguments, const ScanSummary &summary)
{
    if (!arguments.from.empty()) {
        return arguments.from == "points" ? ReplayFrom::points : ReplayFrom::pictures;
    }
    return summary.pictures > 0 ? ReplayFrom::pictures : ReplayFrom::points;
}

bool do_poses(const ReplayArguments &arguments, ScanReader &scan, const ReplayRequest &request,
              ResultStream &out, ReplayOutcome &outcome, std::string &error)
{
    ReplayFiles files;
    if (!arguments.out.empty() && !files.open(arguments.out, error)) {
        return false;
    }
    const ReplayTake take = [&](const PoseChange &change, const PoseRecord &again) {
        files.take(change, again);
        if (arguments.json) {
            return out.write_line(json_line(replay_pose_row(change, request.from)));
        }
        return change.identical() || out.write_line(replay_pose_line(change));
    };
    return replay_poses(scan, request, take, outcome, error) && files.finish(error);
}

bool do_pairs(const ReplayArguments &arguments, ScanReader &scan, ResultStream &out,
              PairReplay &pairs, std::string &error)
{
    if (!replay_pairs(scan, pairs, error)) {
        return false;
    }
    for (const PairChange &change : pairs.changes) {
        out.write_line(arguments.json ? json_line(replay_pair_row(change))
                                      : replay_pair_line(change));
    }
    return true;
}

int exit_code_of(const ReplayMeans &means, const ReplayOutcome &outcome, const PairReplay &pairs)
{
    if (!outcome.problems.empty()) {
        return EXIT_CODE_INPUT;
    }
    const bool same_poses = outcome.figures.identical == outcome.figures.compared;
    const bool failed =
        means.same_code && ((means.same_camera && !same_poses) || !pairs.identical());
    return failed ? EXIT_CODE_RESULT : EXIT_CODE_OK;
}

int report(const ReplayArguments &arguments, const ReplayMeans &means,
           const ReplayOutcome &outcome, const PairReplay &pairs, ResultStream &out)
{
    for (const std::string &problem : outcome.problems) {
        talk(problem);
    }
    const PairReplay *shown = arguments.pair ? &pairs : nullptr;
    const bool written =
        out.write_line(arguments.json ? json_line(replay_summary_row(means, outcome, shown))
                                      : replay_summary_text(means, outcome, shown));
    return written ? exit_code_of(means, outcome, pairs) : EXIT_CODE_INPUT;
}

int run_replay(const ReplayArguments &arguments)
{
    std::string error;
    const auto scan = ScanReader::open(scan_path(arguments.scan), error);
    if (!scan) {
        talk(error);
        return EXIT_CODE_INPUT;
    }
    const ScanSummary &summary = scan->summary();
    ReplayRequest request;
    request.every = arguments.every;
    request.from = choose_source(arguments, summary);
    ReplayMeans means;
    means.scan = summary.name;
    means.from = request.from;
    means.recorded_versions = summary.header.versions_json;
    means.versions = code_versions_json();
    means.same_code = code_versions_equal(means.recorded_versions, means.versions);
    ResultStream out;
    ReplayOutcome outcome;
    PairReplay pairs;
    if (!take_camera(arguments, summary.header, request.camera, means, error) ||
        !do_poses(arguments, *scan, request, out, outcome, error) ||
        (arguments.pair && !do_pairs(arguments, *scan, out, pairs, error))) {
        talk(summary.name + ": " + error);
        return EXIT_CODE_INPUT;
    }
    return out.failed() ? EXIT_CODE_INPUT : report(arguments, means, outcome, pairs, out);
}

}  // namespace

void add_cmd_replay(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<ReplayArguments>();
    CLI::App *cmd = app.add_subcommand(
        "replay", "The poses of a recorded scan once more, and what changed; to the last bit.");
    cmd->add_option("SCAN", arguments->scan, "Folder of a scan, or its name in $OPMS_SCANS")
        ->required()
        ->type_name("");
    cmd->add_option("--camera", arguments->camera, "Another camera file than the scan's own")
        ->type_name("FILE");
    cmd->add_option("--from", arguments->from,
                    "pictures, or points: the recorded reference points [what there is]")
        ->type_name("WHAT")
        ->check(CLI::IsMember({"pictures", "points"}).description(""));
    CLI::Option *every =
        cmd->add_option("--every", arguments->every, "Each Nth of them only [1]")
            ->type_name("N")
            ->check(CLI::Range(1, 1000000).description(""));
    cmd->add_flag("--all", arguments->all, "All of them, as without --every")->excludes(every);
    cmd->add_flag("--pair", arguments->pair, "Pair triggers and frames anew, too");
    cmd->add_flag("--json", arguments->json, "One JSON object a line (schema opms.replay/1)");
    cmd->add_option("--out", arguments->out, "Write poses.jsonl and changes.csv into this folder")
        ->type_name("DIR");
    cmd->callback([arguments, &exit_code] { exit_code = run_replay(*arguments); });
}
