/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Keeps an event that comes again and again from drowning the others. */
#ifndef OPMS_ENGINE_EVENT_GATE_HPP
#define OPMS_ENGINE_EVENT_GATE_HPP

#include <cstdint>
#include <map>
#include <string>

#include "scan_records.hpp"

namespace opms_host {

/** Of each code that may come often, one event a second; the next one tells how many were left out.
 * One thread at a time. Memory grows with the codes there are, not with events. */
class EventGate {
public:
    /** @return Whether the event shall be told; its text may be added to. */
    bool pass(EventRecord &event);

private:
    struct Told {
        std::int64_t t_host_ns = 0;
        std::uint64_t left_out = 0;
    };
    std::map<std::string, Told> told_;
};

}  // namespace opms_host
#endif
