/* SPDX-License-Identifier: Apache-2.0 */
#include "event_gate.hpp"

#include <utility>

namespace opms_host {

bool EventGate::pass(EventRecord &event)
{
    constexpr std::int64_t PAUSE_NS = 1'000'000'000;
    const auto [place, is_first] = told_.try_emplace(event.code);
    Told &told = place->second;
    if (!is_first && event.t_host_ns - told.t_host_ns < PAUSE_NS) {
        ++told.left_out;
        return false;
    }
    if (told.left_out > 0) {
        event.text += " (and " + std::to_string(std::exchange(told.left_out, 0)) + " more before)";
    }
    told.t_host_ns = event.t_host_ns;
    return true;
}

}  // namespace opms_host
