/* SPDX-License-Identifier: Apache-2.0 */
#include "box_json.hpp"

#include <cstdarg>
#include <cstdio>

#include "box_device.hpp"

namespace {

const char *sync_name(opms_sync_mode_t sync)
{
    switch (sync) {
    case OPMS_SYNC_1HZ: return "1hz";
    case OPMS_SYNC_RUN: return "run";
    case OPMS_SYNC_OFF: break;
    }
    return "off";
}

std::string version_text(const opms_identity_report_t &identity)
{
    return box_text("%u.%u.%u", identity.firmware_version[0], identity.firmware_version[1],
                    identity.firmware_version[2]);
}

/** What an event's argument means, in words. */
std::string argument_text(const opms_event_report_t &event)
{
    const uint32_t argument = event.argument;
    switch (event.kind) {
    case OPMS_EVENT_ARMED: return box_text("session %u", argument);
    case OPMS_EVENT_WAITING: return box_text("ready for START after %u pulses", argument);
    case OPMS_EVENT_START: return box_text("the run begins with pulse %u", argument);
    case OPMS_EVENT_STOP: return box_text("last pulse %u", argument);
    case OPMS_EVENT_GLITCH: return box_text("START was active for %.3f us", argument * 0.008);
    case OPMS_EVENT_START_REFUSED:
        return box_text("the box was %s",
                        opms_box_state_name(static_cast<opms_box_state_t>(argument)));
    case OPMS_EVENT_PREAMBLE_CUT: return box_text("START came after %u pulses", argument);
    case OPMS_EVENT_STROBE_MISSING: return box_text("no exposure after pulse %u", argument);
    case OPMS_EVENT_WAIT_TIMEOUT: return "no START came";
    case OPMS_EVENT_REFUSED:
        return box_text("report 0x%02x, opcode %u: %s", argument & 0xFFU, argument >> 8,
                        opms_refusal_name(static_cast<opms_refusal_t>(event.detail)));
    case OPMS_EVENT_SETTINGS_STORED: return box_text("CRC %04x", argument);
    case OPMS_EVENT_ENDPOINT_HEALED: return box_text("%u times so far", argument);
    }
    return "";
}

} // namespace

std::string box_text(const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return text;
}

BoxJson box_identity_json(const opms_identity_report_t &identity)
{
    return {{"unique_id", box_id_text(identity)},
            {"hardware_version", identity.hardware_version},
            {"firmware_version", version_text(identity)},
            {"firmware_modified", identity.firmware_modified},
            {"git_hash", identity.git_hash},
            {"protocol_version", OPMS_WIRE_PROTOCOL},
            {"boot_id", identity.boot_id},
            {"clock_hz", identity.clock_hz},
            {"start_cycles", identity.start_cycles},
            {"ring_entries", identity.ring_entries},
            {"history_entries", identity.history_entries},
            {"capabilities",
             {{"strobe", (identity.capabilities & OPMS_CAPABILITY_STROBE) != 0},
              {"sync", (identity.capabilities & OPMS_CAPABILITY_SYNC) != 0},
              {"history", (identity.capabilities & OPMS_CAPABILITY_HISTORY) != 0},
              {"bootloader", (identity.capabilities & OPMS_CAPABILITY_BOOTLOADER) != 0}}}};
}

BoxJson box_status_json(const opms_status_report_t &status)
{
    return {{"state", opms_box_state_name(status.state)},
            {"uptime_us", status.uptime_us},
            {"reset_cause", box_reset_text(status.reset_cause)},
            {"session_id", status.session_id},
            {"trigger_number", status.trigger_number},
            {"first_run_number", status.first_run_number},
            {"glitches", status.glitches},
            {"starts_refused", status.starts_refused},
            {"strobes_missing", status.strobes_missing},
            {"dropped", status.dropped},
            {"commands_refused", status.commands_refused},
            {"reenumerations", status.reenumerations},
            {"settings_crc", status.settings_crc}};
}

BoxJson box_settings_json(const opms_settings_t &settings)
{
    BoxJson preamble = BoxJson::array();
    for (size_t i = 0; i < box_preamble_gaps(settings); ++i) {
        preamble.push_back(settings.preamble_gap_ms[i]);
    }
    return {{"period_us", settings.period_us},
            {"width_us", settings.width_us},
            {"debounce_us", box_debounce_us(settings)},
            {"trig", settings.trig_active_low ? "active-low" : "active-high"},
            {"start", settings.start_falling_edge ? "falling" : "rising"},
            {"strobe", !settings.strobe_enabled    ? "off"
                       : settings.strobe_active_low ? "active-low"
                                                    : "active-high"},
            {"sync", sync_name(settings.sync)},
            {"preamble_ms", preamble},
            {"wait_timeout_s", settings.wait_timeout_s}};
}

BoxJson box_event_json(const opms_event_report_t &event)
{
    return {{"kind", opms_event_name(event.kind)},
            {"number", event.event_number},
            {"state", opms_box_state_name(event.state)},
            {"time_box_ns", opms_box_time_ns(event.time)},
            {"argument", event.argument},
            {"detail", event.detail},
            {"text", box_event_text(event)}};
}

BoxJson box_counters_json(const opms_box_counters_t &counters)
{
    uint64_t malformed = 0;
    for (const uint64_t count : counters.malformed) {
        malformed += count;
    }
    return {{"triggers", counters.triggers},
            {"reports_lost", counters.reports_lost},
            {"reports_repeated", counters.reports_repeated},
            {"triggers_missed", counters.triggers_missed},
            {"triggers_filled", counters.triggers_filled},
            {"triggers_unfilled", counters.triggers_unfilled},
            {"malformed", malformed},
            {"items_lost", counters.items_lost},
            {"connections", counters.connections},
            {"reboots", counters.reboots},
            {"requests_failed", counters.requests_failed}};
}

std::string box_firmware_text(const opms_identity_report_t &identity)
{
    return version_text(identity) + " (git " + std::string(identity.git_hash).substr(0, 12) +
           (identity.firmware_modified ? ", modified)" : ")");
}

std::string box_event_text(const opms_event_report_t &event)
{
    return std::string(opms_event_name(event.kind)) + ": " + argument_text(event);
}

const char *box_reset_text(opms_reset_cause_t cause)
{
    switch (cause) {
    case OPMS_RESET_POWER: return "power";
    case OPMS_RESET_PIN: return "reset pin";
    case OPMS_RESET_WATCHDOG: return "watchdog";
    case OPMS_RESET_SOFTWARE: return "software";
    case OPMS_RESET_UNKNOWN: break;
    }
    return "unknown";
}

size_t box_preamble_gaps(const opms_settings_t &settings)
{
    size_t count = 0;
    while (count < OPMS_BOX_PREAMBLE_MAX && settings.preamble_gap_ms[count] != 0) {
        ++count;
    }
    return count;
}

std::string box_preamble_text(const opms_settings_t &settings)
{
    std::string text;
    for (size_t i = 0; i < box_preamble_gaps(settings); ++i) {
        text += box_text("%u ", settings.preamble_gap_ms[i]);
    }
    return text.empty() ? "off" : text + "ms";
}

double box_debounce_us(const opms_settings_t &settings)
{
    return settings.debounce_cycles / static_cast<double>(OPMS_BOX_CYCLES_PER_US);
}
