/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Delays of the last minute in memory of a fixed size. */
#ifndef OPMS_ENGINE_LATENCY_HISTOGRAM_HPP
#define OPMS_ENGINE_LATENCY_HISTOGRAM_HPP

#include <array>
#include <cstdint>

#include "scan_listener.hpp"

namespace opms_host {

/** Classes of 1/32 octave from 1 us on: a percentile is never told too small, and too large by less
 * than 2.2 %. Six parts of 10 s each; the oldest part makes room. One thread at a time. */
class LatencyHistogram {
public:
    /** @param period_ns  Between pictures; a longer delay is missed. 0: not known. */
    void add(std::int64_t now_ns, std::int64_t delay_ns, std::int64_t period_ns);
    LatencyFigures figures(std::int64_t now_ns) const;

private:
    static constexpr std::int64_t PART_NS = 10'000'000'000;
    static constexpr std::size_t PARTS = 6;
    static constexpr std::size_t CLASSES = 1 + 32 * 27; /* up to 134 s */

    struct Part {
        std::int64_t number = -1; /**< of 10 s since the clock's zero */
        std::uint64_t count = 0, missed = 0;
        std::int64_t most_ns = 0;
        std::array<std::uint32_t, CLASSES> classes{};
    };
    static std::size_t class_of(std::int64_t delay_ns);
    static double upper_ms(std::size_t number);

    std::array<Part, PARTS> parts_{};
};

}  // namespace opms_host
#endif
