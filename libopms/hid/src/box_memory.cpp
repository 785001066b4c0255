/* SPDX-License-Identifier: Apache-2.0 */
/* What the box keeps: its settings and its last pulses. */
#include <algorithm>
#include <memory>
#include <random>
#include <thread>

#include "box_calls.hpp"
#include "box_handle.hpp"
#include "hid_fail.hpp"

using namespace opms_hid;

namespace {

constexpr uint32_t SET_TIMEOUT_MS = 4000;
constexpr std::chrono::milliseconds SETTINGS_PAUSE(20);
constexpr uint32_t HISTORY_MS_PER_PULSE = 20;
constexpr int HISTORY_FAILURES_MAX = 5;

opms_status_t read_settings(BoxCore &core, Clock::time_point deadline,
                            opms_settings_report_t &report, opms_error_t *err)
{
    struct Answer {
        Report bytes;
        size_t size = 0;
    };
    const auto answer = std::make_shared<Answer>();
    const Io io = core.run(
        [answer](BoxTransport &transport) {
            return transport.get_feature(OPMS_REPORT_SETTINGS, answer->bytes, answer->size);
        },
        deadline);
    if (io != Io::done) {
        return fail_io(err, io, "read the settings");
    }
    const opms_wire_result_t what =
        opms_wire_read_settings(answer->bytes.data(), answer->size, &report);
    return what == OPMS_WIRE_OK ? OPMS_OK
                                : fail(err, OPMS_ERR_DEVICE,
                                       std::string("the box's settings do not read: ") +
                                           opms_wire_result_name(what));
}

/** Poll until the box has written them. While its flash is busy a request may fail. */
opms_status_t wait_written(BoxCore &core, Clock::time_point deadline,
                           opms_settings_report_t &report, opms_error_t *err)
{
    for (;;) {
        std::this_thread::sleep_for(SETTINGS_PAUSE);
        const opms_status_t status = read_settings(core, deadline, report, err);
        if (status == OPMS_ERR_DEVICE || (status == OPMS_OK && !report.pending)) {
            return status;
        }
        if (Clock::now() >= deadline) {
            return fail(err, OPMS_ERR_TIMEOUT, "the box did not finish writing its settings");
        }
    }
}

opms_status_t write_settings(BoxCore &core, const opms_settings_t &settings,
                             Clock::time_point deadline, opms_settings_report_t &report,
                             opms_error_t *err)
{
    Report bytes;
    opms_wire_write_settings_set(&settings, bytes.data());
    const Io io = core.run(
        [bytes](BoxTransport &transport) { return transport.set_feature(bytes); }, deadline);
    if (io != Io::done) {
        return fail_io(err, io, "write the settings");
    }
    const opms_status_t status = wait_written(core, deadline, report, err);
    if (status != OPMS_OK) {
        return status;
    }
    if (report.last_set != OPMS_REFUSAL_NONE) {
        std::string why = opms_refusal_name(report.last_set);
        why += report.last_set == OPMS_REFUSAL_STATE ? ": it takes settings in IDLE only" : "";
        return fail(err, OPMS_ERR_REFUSED, "the box refuses the settings: " + why);
    }
    if (report.settings_crc != opms_wire_settings_crc(&settings)) {
        return fail(err, OPMS_ERR_REFUSED,
                    "the box holds other settings than those written; another program may have "
                    "set them");
    }
    return OPMS_OK;
}

/** One request of HISTORY by the worker. */
struct HistoryStep {
    HistoryReader reader;
    std::vector<opms_history_entry_t> entries;
};

uint16_t even_token()
{
    return static_cast<uint16_t>((std::random_device{}() & 0xFFFEU) | 2U);
}

opms_status_t read_history(BoxCore &core, uint32_t session_id, uint32_t first, uint32_t count,
                           Clock::time_point deadline, opms_history_entry_t *entries,
                           opms_error_t *err)
{
    const auto state = std::make_shared<HistoryStep>(
        HistoryStep{HistoryReader(session_id, first, count, even_token()), {}});
    int failures = 0;
    while (!state->reader.is_done()) {
        const Io io = core.run(
            [state](BoxTransport &transport) {
                uint32_t boot_id = 0;
                return state->reader.step(transport, state->entries, boot_id);
            },
            deadline);
        failures = io == Io::done ? 0 : failures + 1;
        const bool is_late = Clock::now() >= deadline;
        if (io == Io::gone || is_late || failures >= HISTORY_FAILURES_MAX) {
            return fail_io(err, io == Io::done ? Io::timed_out : io, "read the history");
        }
    }
    std::copy(state->entries.begin(), state->entries.end(), entries);
    return OPMS_OK;
}

/** Takes the turn of a caller at HISTORY for a scope. */
class HistoryTurn {
public:
    HistoryTurn(BoxCore &core, Clock::time_point deadline)
        : core_(core), is_ours_(core.begin_history_turn(deadline))
    {
    }
    HistoryTurn(const HistoryTurn &) = delete;
    HistoryTurn &operator=(const HistoryTurn &) = delete;
    ~HistoryTurn() { core_.end_history_turn(is_ours_); }
    bool is_ours() const { return is_ours_; }

private:
    BoxCore &core_;
    const bool is_ours_;
};

} // namespace

opms_status_t opms_box_get_settings(opms_box_t *box, uint32_t timeout_ms,
                                    opms_settings_report_t *report, opms_error_t *err)
{
    return guarded(err, [&] {
        if (!box || !report) {
            return fail(err, OPMS_ERR_ARG, box ? "report is NULL" : "box is NULL");
        }
        opms_settings_report_t read = {};
        const opms_status_t status =
            read_settings(*box->core, deadline_of(timeout_ms), read, err);
        if (status == OPMS_OK) {
            *report = read;
        }
        return status;
    });
}

opms_status_t opms_box_set_settings(opms_box_t *box, const opms_settings_t *settings,
                                    uint32_t timeout_ms, opms_settings_report_t *report,
                                    opms_error_t *err)
{
    return guarded(err, [&] {
        if (!box || !settings) {
            return fail(err, OPMS_ERR_ARG, box ? "settings is NULL" : "box is NULL");
        }
        const char *const wrong = opms_wire_check_settings(settings);
        if (wrong) {
            return fail(err, OPMS_ERR_ARG, wrong);
        }
        opms_settings_report_t read = {};
        const opms_status_t status = write_settings(
            *box->core, *settings, deadline_of(timeout_ms, SET_TIMEOUT_MS), read, err);
        if (status == OPMS_OK && report) {
            *report = read;
        }
        return status;
    });
}

opms_status_t opms_box_history(opms_box_t *box, uint32_t session_id, uint32_t first,
                               uint32_t count, uint32_t timeout_ms,
                               opms_history_entry_t *entries, opms_error_t *err)
{
    return guarded(err, [&] {
        if (!box || !entries) {
            return fail(err, OPMS_ERR_ARG, box ? "entries is NULL" : "box is NULL");
        }
        if (session_id == 0 || first == 0 || count == 0 || count > OPMS_BOX_HISTORY_ENTRIES) {
            return fail(err, OPMS_ERR_ARG,
                        "session_id and first must not be 0, count must be 1 to 8192");
        }
        const Clock::time_point deadline =
            deadline_of(timeout_ms, CALL_TIMEOUT_MS + HISTORY_MS_PER_PULSE * count);
        const HistoryTurn turn(*box->core, deadline);
        if (!turn.is_ours()) {
            return fail_io(err, Io::timed_out, "read the history");
        }
        return read_history(*box->core, session_id, first, count, deadline, entries, err);
    });
}
