/* SPDX-License-Identifier: Apache-2.0 */
#include "box_words.hpp"

#include <string>

namespace opms_host {
namespace {

bool say(BoxWords &words, Severity severity, const char *code, std::string text)
{
    words.event.severity = severity;
    words.event.code = code;
    words.event.text = std::move(text);
    return true;
}

bool say_often(BoxWords &words, Severity severity, const char *code, std::string text)
{
    words.may_come_often = true;
    return say(words, severity, code, std::move(text));
}

bool link_words(const opms_link_item_t &link, BoxWords &words)
{
    switch (link.change) {
    case OPMS_LINK_CONNECTED:
        return say(words, Severity::info, "box.connected", link.message);
    case OPMS_LINK_DISCONNECTED: return say(words, Severity::warning, "box.lost", link.message);
    case OPMS_LINK_REBOOTED: return say(words, Severity::error, "box.rebooted", link.message);
    case OPMS_LINK_SILENT: return say_often(words, Severity::warning, "box.silent", link.message);
    case OPMS_LINK_FAILED: return say_often(words, Severity::error, "box.failed", link.message);
    }
    return false;
}

bool lost_words(const opms_lost_item_t &lost, BoxWords &words)
{
    const std::string count = std::to_string(lost.count);
    switch (lost.what) {
    case OPMS_LOST_REPORTS: break;
    case OPMS_LOST_TRIGGERS:
        return say_often(words, Severity::info, "box.reports_lost",
                         count + " pulse(s) from " + std::to_string(lost.first) +
                             " on were not reported; the box's memory is asked");
    case OPMS_LOST_UNFILLED:
        return say_often(words, Severity::warning, "box.pulses_unknown",
                         count + " pulse(s) from " + std::to_string(lost.first) +
                             " on stay unknown: the box holds them no more");
    case OPMS_LOST_ITEMS:
        return say_often(words, Severity::error, "box.items_lost",
                         count + " report(s) found no room: this computer is too slow");
    }
    return false;
}

bool run_words(const opms_event_report_t &event, BoxWords &words)
{
    const std::string argument = std::to_string(event.argument);
    switch (event.kind) {
    case OPMS_EVENT_ARMED: return say(words, Severity::info, "box.armed", "armed");
    case OPMS_EVENT_WAITING:
        return say(words, Severity::info, "box.ready", "ready for the hardware start");
    case OPMS_EVENT_START:
        return say(words, Severity::info, "box.start",
                   "hardware start; first pulse of the run is " + argument);
    case OPMS_EVENT_STOP:
        return say(words, Severity::info, "box.stop", "stopped after pulse " + argument);
    case OPMS_EVENT_WAIT_TIMEOUT:
        return say(words, Severity::warning, "box.wait_timeout",
                   "no hardware start came in time: the box is idle again");
    case OPMS_EVENT_PREAMBLE_CUT:
        return say(words, Severity::warning, "box.preamble_cut",
                   "the hardware start came within the preamble, after " + argument + " pulse(s)");
    default: return false;
    }
}

bool event_words(const opms_event_report_t &event, BoxWords &words)
{
    const std::string argument = std::to_string(event.argument);
    switch (event.kind) {
    case OPMS_EVENT_GLITCH:
        return say_often(words, Severity::warning, "box.glitch",
                         "START was high for " + argument + " cycles of 8 ns only");
    case OPMS_EVENT_START_REFUSED:
        return say_often(words, Severity::warning, "box.start_refused",
                         std::string("a hardware start came while the box was ") +
                             opms_box_state_name(static_cast<opms_box_state_t>(event.argument)));
    case OPMS_EVENT_STROBE_MISSING:
        return say_often(words, Severity::warning, "box.strobe_missing",
                         "the camera did not expose after pulse " + argument);
    case OPMS_EVENT_REFUSED:
        return say_often(words, Severity::warning, "box.refused",
                         std::string("the box refused a request: ") +
                             opms_refusal_name(static_cast<opms_refusal_t>(event.detail)));
    case OPMS_EVENT_SETTINGS_STORED:
        return say(words, Severity::info, "box.settings_stored", "settings are in flash");
    case OPMS_EVENT_ENDPOINT_HEALED:
        return say_often(words, Severity::warning, "box.endpoint_healed",
                         "the box has healed a stuck USB endpoint");
    default: return run_words(event, words);
    }
}

}  // namespace

bool box_item_words(const opms_box_item_t &item, BoxWords &words)
{
    words = BoxWords();
    words.event.t_host_ns = item.t_host_ns;
    switch (item.kind) {
    case OPMS_ITEM_LINK: return link_words(item.as.link, words);
    case OPMS_ITEM_LOST: return lost_words(item.as.lost, words);
    case OPMS_ITEM_EVENT: return event_words(item.as.event, words);
    case OPMS_ITEM_MALFORMED:
        return say_often(words, Severity::warning, "box.malformed",
                         std::string("a report does not read: ") +
                             opms_wire_result_name(item.as.malformed.result));
    default: return false;
    }
}

}  // namespace opms_host
