/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The simulated world's box as the live system sees it. */
#ifndef OPMS_SIMULATED_SIMULATED_BOX_HPP
#define OPMS_SIMULATED_SIMULATED_BOX_HPP

#include <memory>

#include "box_port.hpp"
#include "world_core.hpp"

namespace opms_host {

class SimulatedBox : public BoxPort {
public:
    explicit SimulatedBox(std::shared_ptr<WorldCore> core);
    ~SimulatedBox() override;
    std::string name() const override { return "simulated"; }
    bool poll(uint32_t timeout_ms, opms_box_item_t &item) override;
    void wake() override;
    bool arm(uint32_t session_id, std::string &error) override;
    bool disarm(std::string &error) override;
    bool settings(opms_settings_report_t &report, std::string &error) override;
    bool set_settings(const opms_settings_t &settings, std::string &error) override;
    bool identity(opms_identity_report_t &identity) const override;
    bool press_start(std::string &error) override;

private:
    const std::shared_ptr<WorldCore> core_;
};

}  // namespace opms_host
#endif
