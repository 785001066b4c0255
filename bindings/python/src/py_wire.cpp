/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reports of the trigger box as values; the names are those of opms/wire.h. */
#include "py_convert.h"
#include "py_fields.h"

namespace {

void bind_report_enums(nb::module_ &module)
{
    nb::enum_<opms_report_id_t>(module, "ReportId", nb::is_arithmetic(), "Ids of reports.")
        .value("TRIGGER", OPMS_REPORT_TRIGGER)
        .value("PONG", OPMS_REPORT_PONG)
        .value("STATUS", OPMS_REPORT_STATUS)
        .value("EVENT", OPMS_REPORT_EVENT)
        .value("COMMAND", OPMS_REPORT_COMMAND)
        .value("IDENTITY", OPMS_REPORT_IDENTITY)
        .value("SETTINGS", OPMS_REPORT_SETTINGS)
        .value("HISTORY", OPMS_REPORT_HISTORY)
        .value("BOOTLOADER", OPMS_REPORT_BOOTLOADER);

    nb::enum_<opms_wire_result_t>(module, "WireResult", nb::is_arithmetic(),
                                  "What is wrong with the bytes of a report.")
        .value("OK", OPMS_WIRE_OK)
        .value("LENGTH", OPMS_WIRE_LENGTH, "Not 64 bytes.")
        .value("ID", OPMS_WIRE_ID, "Unknown, or not the id that was asked for.")
        .value("VERSION", OPMS_WIRE_VERSION, "Another protocol version.")
        .value("CRC", OPMS_WIRE_CRC)
        .value("VALUE", OPMS_WIRE_VALUE, "A field out of range, or a reserved byte not 0.");
}

void bind_box_enums(nb::module_ &module)
{
    nb::enum_<opms_box_state_t>(module, "BoxState", nb::is_arithmetic(), "States of the box.")
        .value("IDLE", OPMS_BOX_IDLE)
        .value("ARMED", OPMS_BOX_ARMED, "Told to get ready.")
        .value("PREAMBLE", OPMS_BOX_PREAMBLE, "Sends the preamble's pulses.")
        .value("WAITING", OPMS_BOX_WAITING, "For the hardware start.")
        .value("RUNNING", OPMS_BOX_RUNNING, "A pulse each period since the start edge.");

    nb::enum_<opms_reset_cause_t>(module, "ResetCause", nb::is_arithmetic(),
                                  "Why the box started up.")
        .value("UNKNOWN", OPMS_RESET_UNKNOWN)
        .value("POWER", OPMS_RESET_POWER)
        .value("PIN", OPMS_RESET_PIN)
        .value("WATCHDOG", OPMS_RESET_WATCHDOG, "The program hung.")
        .value("SOFTWARE", OPMS_RESET_SOFTWARE);

    nb::enum_<opms_sync_mode_t>(module, "SyncMode", nb::is_arithmetic(),
                                "What SYNC sends while RUNNING.")
        .value("OFF", OPMS_SYNC_OFF)
        .value("ONE_HZ", OPMS_SYNC_1HZ, "1 Hz from the start edge on, each 100 ms high.")
        .value("RUN", OPMS_SYNC_RUN, "High from the start edge to the stop.");
}

void bind_event_enums(nb::module_ &module)
{
    nb::enum_<opms_event_kind_t>(module, "EventKind", nb::is_arithmetic(), "Kinds of EVENT.")
        .value("ARMED", OPMS_EVENT_ARMED)
        .value("WAITING", OPMS_EVENT_WAITING)
        .value("START", OPMS_EVENT_START)
        .value("STOP", OPMS_EVENT_STOP)
        .value("GLITCH", OPMS_EVENT_GLITCH)
        .value("START_REFUSED", OPMS_EVENT_START_REFUSED)
        .value("PREAMBLE_CUT", OPMS_EVENT_PREAMBLE_CUT)
        .value("STROBE_MISSING", OPMS_EVENT_STROBE_MISSING)
        .value("WAIT_TIMEOUT", OPMS_EVENT_WAIT_TIMEOUT)
        .value("REFUSED", OPMS_EVENT_REFUSED)
        .value("SETTINGS_STORED", OPMS_EVENT_SETTINGS_STORED)
        .value("ENDPOINT_HEALED", OPMS_EVENT_ENDPOINT_HEALED);

    nb::enum_<opms_refusal_t>(module, "Refusal", nb::is_arithmetic(), "Why the box refused.")
        .value("NONE", OPMS_REFUSAL_NONE)
        .value("STATE", OPMS_REFUSAL_STATE, "Not in this state.")
        .value("LENGTH", OPMS_REFUSAL_LENGTH)
        .value("ID", OPMS_REFUSAL_ID)
        .value("VERSION", OPMS_REFUSAL_VERSION)
        .value("CRC", OPMS_REFUSAL_CRC)
        .value("VALUE", OPMS_REFUSAL_VALUE)
        .value("MAGIC", OPMS_REFUSAL_MAGIC, "BOOTLOADER without its magic word.")
        .value("FLASH", OPMS_REFUSAL_FLASH, "The flash did not keep what was written.")
        .value("BUSY", OPMS_REFUSAL_BUSY, "The one before is still being carried out.");

    nb::enum_<opms_command_opcode_t>(module, "CommandOpcode", nb::is_arithmetic(),
                                     "Opcodes of COMMAND.")
        .value("PING", OPMS_COMMAND_PING)
        .value("ARM", OPMS_COMMAND_ARM)
        .value("DISARM", OPMS_COMMAND_DISARM);
}

void bind_pulse_reports(nb::module_ &module)
{
    py_bind_fields(module, "BoxTime", "Time of the box since it started up.",
                   py_field("us", &opms_box_time_t::us, "Whole microseconds."),
                   py_field("cycles", &opms_box_time_t::cycles, "0 to 124, of 8 ns, beyond us."));

    using Trigger = opms_trigger_report_t;
    py_bind_fields(
        module, "TriggerReport", "0x01 TRIGGER: one pulse, as it left the box.",
        py_field("flags", &Trigger::flags, "Bits of opms.wire.TriggerFlag."),
        py_field("boot_id", &Trigger::boot_id, "Random, another one at each start-up; never 0."),
        py_field("session_id", &Trigger::session_id, "Set by the host when it armed."),
        py_field("report_number", &Trigger::report_number,
                 "Of all input reports since start-up, from 1."),
        py_field("trigger_number", &Trigger::trigger_number,
                 "Pulses since arming, the preamble included, from 1."),
        py_field("time", &Trigger::time, "Rising edge (of active TRIG)."),
        py_field("start_edge", &Trigger::start_edge, "START's edge; zero before the run."),
        py_field("first_run_number", &Trigger::first_run_number,
                 "Number of the run's first pulse; 0 before the run."),
        py_field("strobe_for_trigger", &Trigger::strobe_for_trigger,
                 "The pulse that the last completed exposure followed; 0 if none."),
        py_field("strobe_delay_cycles", &Trigger::strobe_delay_cycles,
                 "From that pulse to the exposure's start, of 8 ns."),
        py_field("strobe_length_cycles", &Trigger::strobe_length_cycles,
                 "Length of that exposure, of 8 ns."),
        py_field("gap_us", &Trigger::gap_us,
                 "Whole us from the pulse before this one, and from the one before that to it."),
        py_field("dropped", &Trigger::dropped,
                 "Pulses whose number and time were lost; stays at 65535."));
}

void bind_other_inputs(nb::module_ &module)
{
    using Pong = opms_pong_report_t;
    py_bind_fields(module, "PongReport", "0x02 PONG: the answer to a ping.",
                   py_field("boot_id", &Pong::boot_id, "Never 0."),
                   py_field("report_number", &Pong::report_number, "Of all input reports."),
                   py_field("ping_id", &Pong::ping_id, "As the host sent it."),
                   py_field("received", &Pong::received, "When the ping came."),
                   py_field("sent", &Pong::sent, "When the answer was handed to USB."));

    using Status = opms_status_report_t;
    py_bind_fields(
        module, "StatusReport", "0x03 STATUS: all that the box counts.",
        py_field("state", &Status::state, "A BoxState."),
        py_field("reset_cause", &Status::reset_cause, "A ResetCause."),
        py_field("boot_id", &Status::boot_id, "Never 0."),
        py_field("session_id", &Status::session_id, "Armed last; 0 before the first."),
        py_field("report_number", &Status::report_number, "Of all input reports."),
        py_field("uptime_us", &Status::uptime_us, "Since start-up."),
        py_field("trigger_number", &Status::trigger_number, "Of the last pulse; 0 if none."),
        py_field("first_run_number", &Status::first_run_number, "0 before the run."),
        py_field("glitches", &Status::glitches, "START was high for less than the debounce."),
        py_field("starts_refused", &Status::starts_refused, "START edges in another state."),
        py_field("strobes_missing", &Status::strobes_missing, "Exposures that did not come."),
        py_field("dropped", &Status::dropped, "Pulses whose number and time were lost."),
        py_field("commands_refused", &Status::commands_refused, "Requests not carried out."),
        py_field("reenumerations", &Status::reenumerations, "Wedged endpoints healed."),
        py_field("settings_crc", &Status::settings_crc, "CRC of the settings in force."));

    using Event = opms_event_report_t;
    py_bind_fields(module, "EventReport", "0x04 EVENT: something happened.",
                   py_field("kind", &Event::kind, "An EventKind."),
                   py_field("state", &Event::state, "After the event."),
                   py_field("boot_id", &Event::boot_id, "Never 0."),
                   py_field("session_id", &Event::session_id, "Armed last; 0 before the first."),
                   py_field("report_number", &Event::report_number, "Of all input reports."),
                   py_field("event_number", &Event::event_number, "A gap is a lost event."),
                   py_field("time", &Event::time, "Of the event."),
                   py_field("argument", &Event::argument, "By kind, see docs/wire.md."),
                   py_field("detail", &Event::detail, "By kind, else 0."));
}

void bind_host_reports(nb::module_ &module)
{
    using Command = opms_command_report_t;
    py_bind_fields(module, "CommandReport", "0x10 COMMAND.",
                   py_field("opcode", &Command::opcode, "A CommandOpcode."),
                   py_field("argument", &Command::argument, "Ping id or session id."));

    using Identity = opms_identity_report_t;
    py_bind_fields(
        module, "IdentityReport", "0x20 IDENTITY.",
        py_field("hardware_version", &Identity::hardware_version, "Of the board."),
        py_field("firmware_version", &Identity::firmware_version, "Major, minor, patch."),
        py_field("firmware_modified", &Identity::firmware_modified,
                 "Built from a tree with uncommitted changes."),
        py_field("capabilities", &Identity::capabilities, "Bits of opms.wire.Capability."),
        py_field("unique_id", &Identity::unique_id, "Of the board, 8 numbers."),
        py_field("git_hash", &Identity::git_hash, "First 20 hex digits."),
        py_field("boot_id", &Identity::boot_id, "Never 0."),
        py_field("clock_hz", &Identity::clock_hz, "Of the cycles."),
        py_field("start_cycles", &Identity::start_cycles,
                 "Start edge to first pulse beyond the debounce."),
        py_field("ring_entries", &Identity::ring_entries, "Remembered without the CPU."),
        py_field("history_entries", &Identity::history_entries, "That HISTORY can return."));

    using Settings = opms_settings_t;
    py_bind_fields(
        module, "BoxSettings", "Settings of the box, kept in its flash.",
        py_field("period_us", &Settings::period_us, "10,000 to 10,000,000."),
        py_field("width_us", &Settings::width_us, "10 to period - 1,000."),
        py_field("debounce_cycles", &Settings::debounce_cycles, "0 to 1,250,000, of 8 ns."),
        py_field("trig_active_low", &Settings::trig_active_low, "TRIG rests high."),
        py_field("start_falling_edge", &Settings::start_falling_edge, "START is active low."),
        py_field("strobe_enabled", &Settings::strobe_enabled, "The exposure output is wired."),
        py_field("strobe_active_low", &Settings::strobe_active_low, "STROBE is active low."),
        py_field("sync", &Settings::sync, "A SyncMode."),
        py_field("preamble_gap_ms", &Settings::preamble_gap_ms,
                 "8 gaps of 10 to 10,000 ms; the first 0 ends the list."),
        py_field("wait_timeout_s", &Settings::wait_timeout_s, "In WAITING; 0 waits for ever."));

    using Answer = opms_settings_report_t;
    py_bind_fields(module, "SettingsReport", "0x21 SETTINGS, as it is read back.",
                   py_field("settings", &Answer::settings, "Those in force."),
                   py_field("last_set", &Answer::last_set, "What became of the last SET."),
                   py_field("pending", &Answer::pending, "A SET is being written; read again."),
                   py_field("stored", &Answer::stored, "Read from flash, not the defaults."),
                   py_field("settings_crc", &Answer::settings_crc, "Of the settings in force."));
}

void bind_history(nb::module_ &module)
{
    using Request = opms_history_request_t;
    py_bind_fields(module, "HistoryRequest", "0x22 HISTORY, set: what to return next.",
                   py_field("token", &Request::token, "Not 0; comes back with each answer."),
                   py_field("session_id", &Request::session_id, "Of the pulses."),
                   py_field("first_number", &Request::first_number, "From 1."),
                   py_field("count", &Request::count, "1 to 8192."));

    using Entry = opms_history_entry_t;
    py_bind_fields(module, "HistoryEntry", "One pulse out of the box's memory.",
                   py_field("number", &Entry::number, "Of the pulse."),
                   py_field("flags", &Entry::flags, "Bits of opms.wire.TriggerFlag."),
                   py_field("time", &Entry::time, "Of the pulse's edge."),
                   py_field("strobe_delay_cycles", &Entry::strobe_delay_cycles,
                            "From this pulse to its exposure, of 8 ns."),
                   py_field("strobe_length_cycles", &Entry::strobe_length_cycles,
                            "Length of its exposure, of 8 ns."));

    using History = opms_history_report_t;
    py_bind_fields(module, "HistoryReport", "0x22 HISTORY, get.",
                   py_field("token", &History::token, "Of the selection; 0 if there was none."),
                   py_field("boot_id", &History::boot_id, "Never 0."),
                   py_field("session_id", &History::session_id, "Of the entries; 0: not held."),
                   py_field("remaining", &History::remaining, "Entries that follow this report."),
                   py_field("count", &History::count, "Of entries that are filled in."),
                   py_field("entries", &History::entries, "2 entries, of which `count` hold."));
}

} // namespace

void py_bind_wire(nb::module_ &module)
{
    bind_report_enums(module);
    bind_box_enums(module);
    bind_event_enums(module);
    bind_pulse_reports(module);
    bind_other_inputs(module);
    bind_host_reports(module);
    bind_history(module);
    py_bind_wire_calls(module);
}
