/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Words for states, as they stand in the columns of a recording. Never changed, only added to. */
#ifndef OPMS_RECORDING_COLUMN_NAMES_HPP
#define OPMS_RECORDING_COLUMN_NAMES_HPP

#include <array>
#include <cstddef>

namespace opms_host {

/** By the number of the state. */
template <std::size_t N> using Words = std::array<const char *, N>;

constexpr Words<4> TRIGGER_STATES = {"NONE", "PAIRED", "MISSING", "UNCERTAIN"};
constexpr Words<6> FRAME_STATES = {"NONE", "PAIRED", "ORPHAN", "DUPLICATE", "STALE", "UNCERTAIN"};
constexpr Words<3> BAR_STATES = {"absent", "located", "ambiguous"};
constexpr Words<5> EXPOSURE_STATES = {"searching", "holding", "moving", "too dark", "too bright"};
constexpr Words<5> BLUR_VERDICTS = {"unknown", "sharp", "focus", "motion", "aperture"};
constexpr Words<3> SEVERITIES = {"info", "warning", "error"};
constexpr Words<4> PAIR_STATES = {"CLOSED", "SEARCHING", "LOCKED", "SUSPECT"};
constexpr Words<3> CLOCK_STATES = {"UNKNOWN", "COARSE", "FITTED"};
constexpr Words<3> SYNC_MODES = {"off", "1hz", "run"};

}  // namespace opms_host
#endif
