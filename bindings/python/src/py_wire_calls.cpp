/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Bytes to reports and back. */
#include "py_convert.h"

#include <cstdio>

namespace {

using namespace nb::literals;

void check(opms_wire_result_t result)
{
    if (result != OPMS_WIRE_OK) {
        opms_error_t err = {};
        err.code = OPMS_ERR_ARG;
        err.index = -1;
        std::snprintf(err.stage, sizeof err.stage, "wire");
        std::snprintf(err.message, sizeof err.message, "%s", opms_wire_result_name(result));
        py_raise(err);
    }
}

const uint8_t *bytes_of(const nb::bytes &data)
{
    return static_cast<const uint8_t *>(data.data());
}

template <class Report>
using Reader = opms_wire_result_t (*)(const uint8_t *bytes, size_t size, Report *report);
template <class Report> using Writer = void (*)(const Report *report, uint8_t *bytes);

template <class Report> nb::object read_as(Reader<Report> reader, const nb::bytes &data)
{
    Report report = {};
    check(reader(bytes_of(data), data.size(), &report));
    return nb::cast(report);
}

nb::object read(const nb::bytes &data)
{
    uint8_t id = 0;
    check(opms_wire_check(bytes_of(data), data.size(), &id));
    switch (id) {
    case OPMS_REPORT_TRIGGER: return read_as(&opms_wire_read_trigger, data);
    case OPMS_REPORT_PONG: return read_as(&opms_wire_read_pong, data);
    case OPMS_REPORT_STATUS: return read_as(&opms_wire_read_status, data);
    case OPMS_REPORT_EVENT: return read_as(&opms_wire_read_event, data);
    case OPMS_REPORT_COMMAND: return read_as(&opms_wire_read_command, data);
    case OPMS_REPORT_IDENTITY: return read_as(&opms_wire_read_identity, data);
    case OPMS_REPORT_SETTINGS: return read_as(&opms_wire_read_settings, data);
    case OPMS_REPORT_HISTORY: return read_as(&opms_wire_read_history, data);
    default: check(opms_wire_read_bootloader(bytes_of(data), data.size())); return nb::none();
    }
}

/** The C writers trust their caller; what they made is read again, so that Python need not be. */
template <class Report>
void bind_write(nb::module_ &module, Writer<Report> write, Reader<Report> reader)
{
    module.def(
        "wire_write",
        [write, reader](const Report &report) {
            uint8_t bytes[OPMS_WIRE_SIZE];
            write(&report, bytes);
            check(reader(bytes, sizeof bytes, nullptr));
            return nb::bytes(bytes, sizeof bytes);
        },
        "report"_a,
        "The 64 bytes of a report. Raises Error (ERR_ARG) where a field is out of range.");
}

void bind_writers(nb::module_ &module)
{
    bind_write(module, &opms_wire_write_trigger, &opms_wire_read_trigger);
    bind_write(module, &opms_wire_write_pong, &opms_wire_read_pong);
    bind_write(module, &opms_wire_write_status, &opms_wire_read_status);
    bind_write(module, &opms_wire_write_event, &opms_wire_read_event);
    bind_write(module, &opms_wire_write_command, &opms_wire_read_command);
    bind_write(module, &opms_wire_write_identity, &opms_wire_read_identity);
    bind_write(module, &opms_wire_write_settings, &opms_wire_read_settings);
    bind_write(module, &opms_wire_write_settings_set, &opms_wire_read_settings_set);
    bind_write(module, &opms_wire_write_history_request, &opms_wire_read_history_request);
    bind_write(module, &opms_wire_write_history, &opms_wire_read_history);
    module.def(
        "wire_write_bootloader",
        [] {
            uint8_t bytes[OPMS_WIRE_SIZE];
            opms_wire_write_bootloader(bytes);
            return nb::bytes(bytes, sizeof bytes);
        },
        "The 64 bytes of BOOTLOADER with its magic word.");
}

void bind_readers(nb::module_ &module)
{
    module.def("wire_read", &read, "data"_a,
               nb::sig("def wire_read(data: bytes) -> TriggerReport | PongReport | StatusReport | "
                       "EventReport | CommandReport | IdentityReport | SettingsReport | "
                       "HistoryReport | None"),
               R"(The report in 64 bytes, by its id; None for BOOTLOADER, which has no fields.

SETTINGS and HISTORY as the box answers a GET. Raises Error (ERR_ARG) that says what is wrong.)");
    module.def(
        "wire_read_settings_set",
        [](const nb::bytes &data) { return read_as(&opms_wire_read_settings_set, data); },
        "data"_a, nb::sig("def wire_read_settings_set(data: bytes) -> BoxSettings"),
        "SETTINGS as the host sends it with a SET. Raises Error (ERR_ARG).");
    module.def(
        "wire_read_history_request",
        [](const nb::bytes &data) { return read_as(&opms_wire_read_history_request, data); },
        "data"_a, nb::sig("def wire_read_history_request(data: bytes) -> HistoryRequest"),
        "HISTORY as the host sends it with a SET. Raises Error (ERR_ARG).");
    module.def(
        "wire_check",
        [](const nb::bytes &data) {
            return opms_wire_check(bytes_of(data), data.size(), nullptr);
        },
        "data"_a, "Are length, id, version and CRC of a report right?");
    module.def(
        "wire_crc16",
        [](const nb::bytes &data) { return opms_wire_crc16(bytes_of(data), data.size()); },
        "data"_a, "CRC-16/IBM-3740, which every report ends with.");
}

} // namespace

void py_bind_wire_calls(nb::module_ &module)
{
    bind_readers(module);
    bind_writers(module);
    module.def(
        "wire_default_settings",
        [] {
            opms_settings_t settings;
            opms_wire_default_settings(&settings);
            return settings;
        },
        "The settings of a box whose flash holds none.");
    module.def("wire_check_settings", &opms_wire_check_settings, "settings"_a,
               nb::sig("def wire_check_settings(settings: BoxSettings) -> str | None"),
               "None where all is in range, else a message that names the field and its range.");
}
