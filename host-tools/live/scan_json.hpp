/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Poses, events and states of a scan as JSON: one form for the terminal, the interface and exports.
 * Numbers that are not known are null. Schemas: docs/live.md. */
#ifndef OPMS_LIVE_SCAN_JSON_HPP
#define OPMS_LIVE_SCAN_JSON_HPP

#include <nlohmann/json.hpp>

#include "scan_listener.hpp"
#include "scan_records.hpp"

namespace opms_host {

enum class PoseDetail {
    pose,   /**< state, times, poses, covariances, light, blur */
    squares /**< with the squares' corners */
};

/** opms.pose/1 */
nlohmann::ordered_json pose_json(const PoseRecord &pose, PoseDetail detail = PoseDetail::pose);
/** opms.event/1 */
nlohmann::ordered_json event_json(const EventRecord &event);
/** opms.state/1 */
nlohmann::ordered_json status_json(const SessionStatus &status);

const char *blur_verdict_name(BlurVerdict verdict);
const char *severity_name(Severity severity);
const char *recording_state_name(RecordingState state);
const char *exposure_state_name(opms_exposure_state_t state);

}  // namespace opms_host
#endif
