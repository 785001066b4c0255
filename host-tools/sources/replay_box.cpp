/* SPDX-License-Identifier: Apache-2.0 */
#include "replay_box.hpp"

#include <atomic>
#include <utility>

namespace opms_host {
namespace {

class ReplayBox : public BoxPort {
public:
    explicit ReplayBox(std::shared_ptr<ReplayScan> scan) : scan_(std::move(scan)) {}

    std::string name() const override { return "replay:" + scan_->folder(); }

    bool poll(uint32_t timeout_ms, opms_box_item_t &item) override
    {
        item = opms_box_item_t();
        if (!told_.exchange(true)) {
            item.kind = OPMS_ITEM_LINK;
            item.t_host_ns = scan_->now_ns();
            item.as.link.change = OPMS_LINK_CONNECTED;
            item.as.link.boot_id = scan_->header().boot_id;
            return true;
        }
        return scan_->take_box(timeout_ms, item) != ReplayScan::Took::end;
    }
    void wake() override { scan_->wake_box(); }

    bool arm(uint32_t session_id, std::string &error) override
    {
        if (session_id == 0 || armed_.exchange(true)) {
            error = "a recording is replayed once; open it again";
            return false;
        }
        scan_->arm(session_id);
        return true;
    }
    /* What was recorded goes on to its end: there is nothing to stop. */
    bool disarm(std::string &) override { return true; }

    bool settings(opms_settings_report_t &report, std::string &) override
    {
        report = opms_settings_report_t();
        report.settings = scan_->header().box_settings;
        report.stored = true;
        report.settings_crc = opms_wire_settings_crc(&report.settings);
        return true;
    }
    bool set_settings(const opms_settings_t &settings, std::string &error) override
    {
        const bool same = opms_wire_settings_crc(&settings) ==
                          opms_wire_settings_crc(&scan_->header().box_settings);
        error = same ? "" : "the box of a recording has the settings that it had";
        return same;
    }
    bool identity(opms_identity_report_t &identity) const override
    {
        identity = scan_->header().box_identity;
        identity.boot_id = scan_->header().boot_id;
        return true;
    }
    bool press_start(std::string &error) override
    {
        error = "a recording starts by itself where it was started";
        return false;
    }

private:
    const std::shared_ptr<ReplayScan> scan_;
    std::atomic<bool> told_{false}, armed_{false};
};

}  // namespace

std::unique_ptr<BoxPort> make_replay_box(std::shared_ptr<ReplayScan> scan)
{
    return std::make_unique<ReplayBox>(std::move(scan));
}

}  // namespace opms_host
