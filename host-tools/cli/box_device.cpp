/* SPDX-License-Identifier: Apache-2.0 */
#include "box_device.hpp"

#include <cstdio>
#include <random>

#include <CLI/CLI.hpp>

#include "box_place.hpp"
#include "commands.hpp"

void add_box_option(CLI::App &command, std::string &text)
{
    const auto check = [](std::string &value) {
        opms_box_options_t options;
        std::string error;
        box_place_parse(value, options, error);
        return error;
    };
    command
        .add_option("--box", text,
                    "hid, hid:ID where there are several, emulated or emulated:PORT [hid]")
        ->type_name("BOX")
        ->check(CLI::Validator(check, ""));
}

int box_exit_code(opms_status_t status)
{
    switch (status) {
    case OPMS_OK: return EXIT_CODE_OK;
    case OPMS_ERR_ARG: return EXIT_CODE_USAGE;
    case OPMS_ERR_REFUSED: return EXIT_CODE_RESULT;
    default: return EXIT_CODE_DEVICE;
    }
}

void box_talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

std::unique_ptr<BoxDevice> BoxDevice::open(const std::string &text, uint32_t ping_interval_ms,
                                           int &exit_code)
{
    opms_box_options_t options;
    std::string why;
    if (!box_place_parse(text, options, why)) {
        box_talk(why);
        exit_code = EXIT_CODE_USAGE;
        return nullptr;
    }
    options.ping_interval_ms = ping_interval_ms;
    opms_box_t *box = nullptr;
    opms_error_t error = {};
    const opms_status_t status = opms_box_open(&options, &box, &error);
    if (status != OPMS_OK) {
        box_talk(error.message);
        exit_code = box_exit_code(status);
        return nullptr;
    }
    return std::unique_ptr<BoxDevice>(
        new BoxDevice(box, options.transport == OPMS_BOX_EMULATED));
}

BoxDevice::~BoxDevice()
{
    opms_box_close(box_);
}

opms_identity_report_t BoxDevice::identity() const
{
    opms_identity_report_t identity = {};
    opms_box_get_identity(box_, &identity, nullptr, nullptr);
    return identity;
}

bool BoxDevice::is_connected() const
{
    opms_identity_report_t identity = {};
    bool connected = false;
    opms_box_get_identity(box_, &identity, &connected, nullptr);
    return connected;
}

opms_box_counters_t BoxDevice::counters() const
{
    opms_box_counters_t counters = {};
    opms_box_get_counters(box_, &counters, nullptr);
    return counters;
}

std::string box_id_text(const opms_identity_report_t &identity)
{
    std::string text;
    for (const uint8_t byte : identity.unique_id) {
        char digits[3];
        std::snprintf(digits, sizeof digits, "%02x", byte);
        text += digits;
    }
    return text;
}

uint32_t box_new_session()
{
    std::random_device random;
    uint32_t session = 0;
    while (session == 0) {
        session = random();
    }
    return session;
}
