/* SPDX-License-Identifier: Apache-2.0 */
#include "latency_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace opms_host {

std::size_t LatencyHistogram::class_of(std::int64_t delay_ns)
{
    if (delay_ns <= 1000) {
        return 0;
    }
    const double octaves = std::log2(static_cast<double>(delay_ns) * 1e-3);
    return std::min(1 + static_cast<std::size_t>(octaves * 32), CLASSES - 1);
}

double LatencyHistogram::upper_ms(std::size_t number)
{
    return 1e-3 * std::exp2(static_cast<double>(number) / 32);
}

void LatencyHistogram::add(std::int64_t now_ns, std::int64_t delay_ns, std::int64_t period_ns)
{
    const std::int64_t number = now_ns / PART_NS;
    Part &part = parts_[static_cast<std::size_t>(number) % PARTS];
    if (part.number != number) {
        part = Part{};
        part.number = number;
    }
    ++part.count;
    part.missed += period_ns > 0 && delay_ns > period_ns;
    part.most_ns = std::max(part.most_ns, delay_ns);
    ++part.classes[class_of(delay_ns)];
}

LatencyFigures LatencyHistogram::figures(std::int64_t now_ns) const
{
    LatencyFigures all;
    std::array<std::uint64_t, CLASSES> classes{};
    const std::int64_t oldest = now_ns / PART_NS - static_cast<std::int64_t>(PARTS) + 1;
    for (const Part &part : parts_) {
        if (part.number < 0 || part.number < oldest) {
            continue;
        }
        all.count += part.count;
        all.missed += part.missed;
        all.most_ms = std::max(all.most_ms, static_cast<double>(part.most_ns) * 1e-6);
        for (std::size_t i = 0; i < CLASSES; ++i) {
            classes[i] += part.classes[i];
        }
    }
    const auto percentile = [&](double share) {
        const auto wanted =
            static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(all.count)));
        std::uint64_t seen = 0;
        for (std::size_t i = 0; i < CLASSES; ++i) {
            seen += classes[i];
            if (seen >= wanted) {
                return std::min(upper_ms(i), all.most_ms);
            }
        }
        return all.most_ms;
    };
    if (all.count > 0) {
        all.p50_ms = percentile(0.5);
        all.p99_ms = percentile(0.99);
        all.p999_ms = percentile(0.999);
    }
    return all;
}

}  // namespace opms_host
