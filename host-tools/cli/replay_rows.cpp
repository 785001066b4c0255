/* SPDX-License-Identifier: Apache-2.0 */
#include "replay_rows.hpp"

#include "location_json.hpp"
#include "text_table.hpp"

using Json = nlohmann::ordered_json;

namespace {

const char *from_name(ReplayFrom from)
{
    return from == ReplayFrom::points ? "points" : "pictures";
}

std::string fate_name(const PairChange &change, const PairFate &fate)
{
    if (fate.state == 0) {
        return "none";
    }
    return change.of_frame ? opms_frame_state_name(static_cast<opms_frame_state_t>(fate.state))
                           : opms_trigger_state_name(
                                 static_cast<opms_trigger_state_t>(fate.state));
}

Json fate_json(const PairChange &change, const PairFate &fate)
{
    return {{"state", fate_name(change, fate)},
            {change.of_frame ? "trigger" : "picture",
             fate.partner > 0 ? Json(fate.partner) : Json(nullptr)}};
}

std::string fate_text(const PairChange &change, const PairFate &fate)
{
    std::string text = fate_name(change, fate);
    if (fate.partner > 0) {
        text += change.of_frame ? " with trigger " : " with picture ";
        text += std::to_string(fate.partner);
    }
    return text;
}

Json versions_json(const std::string &text)
{
    const Json versions = Json::parse(text, nullptr, false);
    return versions.is_object() ? versions : Json(nullptr);
}

Json pairs_json(const PairReplay &pairs)
{
    if (!pairs.possible) {
        return nullptr;
    }
    return {{"triggers", pairs.triggers},
            {"triggers_changed", pairs.triggers_changed},
            {"frames", pairs.frames},
            {"frames_changed", pairs.frames_changed},
            {"sums_hold", pairs.sums_hold},
            {"text", pairs.line}};
}

std::string joined(const std::vector<std::string> &words)
{
    std::string text;
    for (const std::string &word : words) {
        text += (text.empty() ? "" : ", ") + word;
    }
    return text;
}

std::string pairs_text(const PairReplay &pairs)
{
    if (!pairs.possible) {
        return "\npairs: no box was armed, so there are none";
    }
    return text_format("\npairs: %llu of %llu triggers and %llu of %llu frames end otherwise; ",
                       static_cast<unsigned long long>(pairs.triggers_changed),
                       static_cast<unsigned long long>(pairs.triggers),
                       static_cast<unsigned long long>(pairs.frames_changed),
                       static_cast<unsigned long long>(pairs.frames)) +
           pairs.line;
}

}  // namespace

Json replay_pose_row(const PoseChange &change, ReplayFrom from)
{
    const auto measured = [&change](double value) {
        return change.both_located ? Json(value) : Json(nullptr);
    };
    return {{"schema", "opms.replay/1"},
            {"picture", change.number},
            {"from", from_name(from)},
            {"identical", change.identical()},
            {"differs", change.differs},
            {"state", json_bar_state(change.again)},
            {"state_recorded", json_bar_state(change.recorded)},
            {"position_mm", measured(change.position_mm)},
            {"angle_deg", measured(change.angle_deg)}};
}

Json replay_pair_row(const PairChange &change)
{
    return {{"schema", "opms.replay.pair/1"},
            {change.of_frame ? "picture" : "trigger", change.number},
            {"now", fate_json(change, change.again)},
            {"recorded", fate_json(change, change.recorded)}};
}

Json replay_summary_row(const ReplayMeans &means, const ReplayOutcome &outcome,
                        const PairReplay *pairs)
{
    const ReplayFigures &f = outcome.figures;
    return {{"schema", "opms.replay.summary/1"},
            {"scan", means.scan},
            {"from", from_name(means.from)},
            {"versions", versions_json(means.versions)},
            {"versions_recorded", versions_json(means.recorded_versions)},
            {"same_code", means.same_code},
            {"same_camera", means.same_camera},
            {"compared", f.compared},
            {"identical", f.identical},
            {"states_changed", f.states_changed},
            {"left_out", outcome.left_out},
            {"position_rms_mm", f.position_rms_mm},
            {"position_most_mm", f.position_most_mm},
            {"angle_rms_deg", f.angle_rms_deg},
            {"angle_most_deg", f.angle_most_deg},
            {"pairs", pairs ? pairs_json(*pairs) : Json(nullptr)},
            {"problems", outcome.problems}};
}

std::string replay_pose_line(const PoseChange &change)
{
    const std::string start =
        text_format("picture %llu: ", static_cast<unsigned long long>(change.number));
    if (change.recorded != change.again) {
        return start + json_bar_state(change.again) + ", was " + json_bar_state(change.recorded);
    }
    return start + text_format("%.3g mm, %.3g deg; differs in ", change.position_mm,
                               change.angle_deg) +
           joined(change.differs);
}

std::string replay_pair_line(const PairChange &change)
{
    return text_format("%s %llu: ", change.of_frame ? "picture" : "trigger",
                       static_cast<unsigned long long>(change.number)) +
           fate_text(change, change.again) + ", was " + fate_text(change, change.recorded);
}

std::string replay_summary_text(const ReplayMeans &means, const ReplayOutcome &outcome,
                                const PairReplay *pairs)
{
    const ReplayFigures &f = outcome.figures;
    std::string text = text_format(
        "%llu poses from %s: %llu identical, %llu with another state, %llu left out\n"
        "change of position %.3g mm RMS, %.3g mm at most; of angle %.3g deg RMS, %.3g deg at most",
        static_cast<unsigned long long>(f.compared), from_name(means.from),
        static_cast<unsigned long long>(f.identical),
        static_cast<unsigned long long>(f.states_changed),
        static_cast<unsigned long long>(outcome.left_out), f.position_rms_mm, f.position_most_mm,
        f.angle_rms_deg, f.angle_most_deg);
    text += means.same_camera ? "\nthe scan's own camera file" : "\nanother camera file";
    text += means.same_code ? ", the same code: " + means.versions
                            : ", other code: " + means.recorded_versions + ", now " +
                                  means.versions;
    return pairs ? text + pairs_text(*pairs) : text;
}
