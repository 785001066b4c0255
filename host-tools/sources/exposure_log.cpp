/* SPDX-License-Identifier: Apache-2.0 */
#include "exposure_log.hpp"

namespace opms_host {

void ExposureLog::begin(const ExposureSetting &setting)
{
    changes_ = {{INT64_MIN, 0, setting}};
}

void ExposureLog::change(std::int64_t t_host_ns, const ExposureSetting &setting)
{
    changes_.push_back({t_host_ns, unsure_frames_, setting});
}

ExposureSetting ExposureLog::take(std::int64_t t_host_ns)
{
    while (changes_.size() > 1 && changes_[1].t_host_ns <= t_host_ns) {
        changes_.pop_front();
    }
    Change &now = changes_.front();
    if (now.unsure > 0) {
        --now.unsure;
        return ExposureSetting();
    }
    return now.setting;
}

}  // namespace opms_host
