/* SPDX-License-Identifier: Apache-2.0 */
/* The commands: ping, arm, disarm, bootloader; and the hands of the emulated box. */
#include <memory>

#include "box_calls.hpp"
#include "box_handle.hpp"
#include "hid_fail.hpp"

using namespace opms_hid;

namespace {

Report command_report(opms_command_opcode_t opcode, uint32_t argument)
{
    const opms_command_report_t command = {opcode, argument};
    Report report;
    opms_wire_write_command(&command, report.data());
    return report;
}

Io send_command(BoxCore &core, opms_command_opcode_t opcode, uint32_t argument,
                Clock::time_point deadline)
{
    const Report report = command_report(opcode, argument);
    return core.run([report](BoxTransport &transport) { return transport.write(report); },
                    deadline);
}

bool is_refusal_of(const Seen &now, const Seen &before, uint32_t what)
{
    return now.refusals != before.refusals && now.refused == what;
}

opms_status_t fail_refused(opms_error_t *err, const Seen &seen, const char *what)
{
    std::string message = std::string("the box refuses to ") + what + ": " +
                          opms_refusal_name(seen.refusal);
    if (seen.refusal == OPMS_REFUSAL_STATE) {
        message += std::string(" (it is ") + opms_box_state_name(seen.state) + ")";
    }
    return fail(err, OPMS_ERR_REFUSED, message);
}

/** Wait for what the box says to a request: until `is_done`, or a refusal of `refused`. */
template <typename Done>
opms_status_t wait_answer(BoxCore &core, const Seen &before, uint32_t refused, const char *what,
                          Clock::time_point deadline, opms_error_t *err, Done is_done)
{
    const bool answered = core.wait_seen(
        [&](const Seen &now) { return is_done(now) || is_refusal_of(now, before, refused); },
        deadline);
    const Seen now = core.seen();
    if (answered && !is_done(now)) {
        return fail_refused(err, now, what);
    }
    bool connected = false;
    core.identity(connected);
    return answered ? OPMS_OK : fail_io(err, connected ? Io::timed_out : Io::gone, what);
}

opms_status_t emulate(opms_box_t *box, Message kind, const std::vector<uint8_t> &payload,
                      opms_error_t *err)
{
    if (!box || !box->emulated) {
        return fail(err, OPMS_ERR_ARG, box ? "this box is no emulated one" : "box is NULL");
    }
    return box->emulated->send(kind, payload)
               ? OPMS_OK
               : fail(err, OPMS_ERR_DEVICE, "the emulated box is not running any more");
}

} // namespace

opms_status_t opms_box_ping(opms_box_t *box, uint32_t timeout_ms, uint32_t *ping_id,
                            opms_error_t *err)
{
    return guarded(err, [&] {
        if (!box) {
            return fail(err, OPMS_ERR_ARG, "box is NULL");
        }
        const std::shared_ptr<BoxCore> core = box->core;
        const uint32_t id = core->next_ping_id();
        if (ping_id) {
            *ping_id = id;
        }
        /* The core runs the work while it lives. */
        const Io io = core->run(
            [raw = core.get(), id](BoxTransport &transport) {
                return raw->send_ping(transport, id);
            },
            deadline_of(timeout_ms));
        return fail_io(err, io, "ping");
    });
}

opms_status_t opms_box_arm(opms_box_t *box, uint32_t session_id, uint32_t timeout_ms,
                           opms_error_t *err)
{
    return guarded(err, [&] {
        if (!box || session_id == 0) {
            return fail(err, OPMS_ERR_ARG, box ? "session_id is 0" : "box is NULL");
        }
        BoxCore &core = *box->core;
        const Seen before = core.seen();
        if (before.armed_session_id == session_id) {
            return fail(err, OPMS_ERR_ARG, "session_id is that of the last session");
        }
        const Clock::time_point deadline = deadline_of(timeout_ms);
        core.arming(session_id);
        const Io io = send_command(core, OPMS_COMMAND_ARM, session_id, deadline);
        if (io != Io::done) {
            return fail_io(err, io, "arm");
        }
        return wait_answer(core, before, OPMS_REPORT_COMMAND + 256U * OPMS_COMMAND_ARM, "arm",
                           deadline, err, [&](const Seen &now) {
                               return now.armed_session_id == session_id ||
                                      (now.session_id == session_id &&
                                       now.statuses != before.statuses);
                           });
    });
}

opms_status_t opms_box_disarm(opms_box_t *box, uint32_t timeout_ms, opms_error_t *err)
{
    return guarded(err, [&] {
        if (!box) {
            return fail(err, OPMS_ERR_ARG, "box is NULL");
        }
        BoxCore &core = *box->core;
        const Clock::time_point deadline = deadline_of(timeout_ms);
        const Seen before = core.seen();
        const Io io = send_command(core, OPMS_COMMAND_DISARM, 0, deadline);
        if (io != Io::done) {
            return fail_io(err, io, "disarm");
        }
        return wait_answer(core, before, OPMS_REPORT_COMMAND + 256U * OPMS_COMMAND_DISARM,
                           "disarm", deadline, err, [&](const Seen &now) {
                               return now.stops != before.stops ||
                                      (now.statuses != before.statuses &&
                                       now.state == OPMS_BOX_IDLE);
                           });
    });
}

opms_status_t opms_box_bootloader(opms_box_t *box, uint32_t timeout_ms, opms_error_t *err)
{
    return guarded(err, [&] {
        if (!box) {
            return fail(err, OPMS_ERR_ARG, "box is NULL");
        }
        BoxCore &core = *box->core;
        const Clock::time_point deadline = deadline_of(timeout_ms);
        const Seen before = core.seen();
        Report report;
        opms_wire_write_bootloader(report.data());
        const Io io = core.run(
            [report](BoxTransport &transport) { return transport.set_feature(report); }, deadline);
        bool connected = false;
        core.identity(connected);
        if (io == Io::gone && !connected) {
            return fail_io(err, io, "start the bootloader");
        }
        /* The box leaves the bus, perhaps in the midst of the transfer: that is its answer. */
        core.wait_seen(
            [&](const Seen &now) {
                return is_refusal_of(now, before, OPMS_REPORT_BOOTLOADER);
            },
            deadline);
        const Seen now = core.seen();
        if (is_refusal_of(now, before, OPMS_REPORT_BOOTLOADER)) {
            return fail_refused(err, now, "start the bootloader");
        }
        core.identity(connected);
        return connected ? fail_io(err, Io::timed_out, "start the bootloader") : OPMS_OK;
    });
}

opms_status_t opms_box_emulate_line(opms_box_t *box, opms_emulated_line_t line, bool level,
                                    uint64_t delay_ns, opms_error_t *err)
{
    return guarded(err, [&] {
        std::vector<uint8_t> payload;
        put_field(payload, static_cast<uint64_t>(line), 1);
        put_field(payload, level ? 1 : 0, 1);
        put_field(payload, delay_ns, 8);
        return emulate(box, Message::line, payload, err);
    });
}

opms_status_t opms_box_emulate_plug(opms_box_t *box, bool plugged, opms_error_t *err)
{
    return guarded(err, [&] {
        return emulate(box, Message::plug, {static_cast<uint8_t>(plugged ? 1 : 0)}, err);
    });
}

opms_status_t opms_box_emulate_power(opms_box_t *box, opms_error_t *err)
{
    return guarded(err, [&] { return emulate(box, Message::power, {}, err); });
}
