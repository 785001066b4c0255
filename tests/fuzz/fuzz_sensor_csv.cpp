/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a table of sensor samples: a line is a sample within bounds, or told to be none. */
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sensor_csv.hpp"

using namespace opms_host;

namespace {

void require(bool holds)
{
    if (!holds) {
        std::abort();
    }
}

void check_sample(const SensorCsv &csv, const SensorSample &sample)
{
    require(sample.record.sensor == "fuzz");
    require(sample.record.values.size() == csv.value_names().size());
    require(sample.time != SampleTime::arrival);
    require(std::llabs(sample.record.t_scan_ns) <= 10'000'000'000'000'000);
    require(sample.t_unix_ns >= 0 && sample.record.t_bound_ns >= 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, std::size_t size)
{
    const std::string_view text(reinterpret_cast<const char *>(data), size);
    SensorCsv csv("fuzz");
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        SensorSample sample;
        std::string error;
        switch (csv.take(text.substr(begin, end - begin), sample, error)) {
        case CsvLine::sample: check_sample(csv, sample); break;
        case CsvLine::error: require(error.rfind("line ", 0) == 0); break;
        case CsvLine::nothing: break;
        }
        begin = end + 1;
    }
    return 0;
}
