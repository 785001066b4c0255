/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The simulated world's camera as the live system sees it. */
#ifndef OPMS_SIMULATED_SIMULATED_SOURCE_HPP
#define OPMS_SIMULATED_SIMULATED_SOURCE_HPP

#include <memory>

#include "frame_source.hpp"
#include "world_core.hpp"

namespace opms_host {

class SimulatedSource : public FrameSource {
public:
    explicit SimulatedSource(std::shared_ptr<WorldCore> core) : core_(std::move(core)) {}
    ~SimulatedSource() override;
    SourceTraits traits() const override;
    bool start(const SourceStart &start, std::string &error) override;
    void stop() override;
    void wait(std::uint32_t timeout_ms, SourceItem &item) override;
    void wake() override;
    bool set_exposure(double exposure_us, double gain_db, std::string &error) override;
    SourceCounters counters() const override;

private:
    const std::shared_ptr<WorldCore> core_;
    std::uint64_t delivered_ = 0, damaged_ = 0; /**< under the world's lock */
};

}  // namespace opms_host
#endif
