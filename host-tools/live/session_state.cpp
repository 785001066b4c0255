/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_listener.hpp"

namespace opms_host {

const char *session_state_name(SessionState state)
{
    switch (state) {
    case SessionState::idle: return "idle";
    case SessionState::arming: return "arming";
    case SessionState::preamble: return "preamble";
    case SessionState::ready: return "ready";
    case SessionState::running: return "running";
    case SessionState::stopping: return "stopping";
    case SessionState::interrupted: return "interrupted";
    }
    return "?";
}

}  // namespace opms_host
