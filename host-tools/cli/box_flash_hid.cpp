/* SPDX-License-Identifier: Apache-2.0 */
#include "box_flash_hid.hpp"

#ifdef OPMS_CLI_HAVE_HID
#include <cstdio>

#include <opms/hid.h>

using opms::flash::BoxVersion;
using opms::flash::Fault;
using opms::flash::FlashError;

namespace {

constexpr std::uint32_t OPEN_TIMEOUT_MS = 8000; /**< a box that has just started up is slow */

void check(opms_status_t status, const opms_error_t &error)
{
    if (status != OPMS_OK) {
        throw FlashError(status == OPMS_ERR_REFUSED || status == OPMS_ERR_VERSION
                             ? Fault::refused
                             : Fault::no_device,
                         error.message);
    }
}

class OpenBox {
public:
    explicit OpenBox(const std::string &unique_id)
    {
        opms_error_t error{};
        opms_box_options_t options;
        opms_box_options_init(&options);
        options.open_timeout_ms = OPEN_TIMEOUT_MS;
        std::snprintf(options.unique_id, sizeof options.unique_id, "%s", unique_id.c_str());
        check(opms_box_open(&options, &box_, &error), error);
    }
    ~OpenBox() { opms_box_close(box_); }
    OpenBox(const OpenBox &) = delete;
    OpenBox &operator=(const OpenBox &) = delete;
    opms_box_t *get() const { return box_; }

private:
    opms_box_t *box_ = nullptr;
};

}  // namespace

std::vector<std::string> HidBoxes::list()
{
    opms_error_t error{};
    std::uint32_t count = 0;
    opms_status_t status = opms_box_list(nullptr, 0, &count, &error);
    std::vector<opms_box_entry_t> entries(count);
    if (count > 0) {
        status = opms_box_list(entries.data(), count, &count, &error);
    }
    if (status != OPMS_ERR_CAPACITY) { /* one was plugged in meanwhile: the next call shows it */
        check(status, error);
    }
    std::vector<std::string> ids;
    for (std::size_t i = 0; i < entries.size() && i < count; ++i) {
        ids.emplace_back(entries[i].unique_id);
    }
    return ids;
}

void HidBoxes::enter_bootloader(const std::string &unique_id)
{
    const OpenBox box(unique_id);
    opms_error_t error{};
    check(opms_box_bootloader(box.get(), 0, &error), error);
}

BoxVersion HidBoxes::version(const std::string &unique_id)
{
    const OpenBox box(unique_id);
    opms_error_t error{};
    opms_identity_report_t identity;
    check(opms_box_get_identity(box.get(), &identity, nullptr, &error), error);
    const auto number = [&](int i) { return std::to_string(identity.firmware_version[i]); };
    return {unique_id, number(0) + "." + number(1) + "." + number(2), identity.git_hash};
}

#else

std::vector<std::string> HidBoxes::list()
{
    return {};
}

void HidBoxes::enter_bootloader(const std::string &)
{
}

opms::flash::BoxVersion HidBoxes::version(const std::string &)
{
    return {};
}

#endif
