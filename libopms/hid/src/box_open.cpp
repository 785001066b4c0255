/* SPDX-License-Identifier: Apache-2.0 */
/* Finding, opening, polling and closing: the calls that do not talk to the box. */
#include <algorithm>
#include <cstring>
#include <memory>

#include "box_handle.hpp"
#include "hid_fail.hpp"
#include "hidapi_transport.hpp"

using namespace opms_hid;

namespace {

constexpr uint32_t QUEUE_MIN = 16, QUEUE_MAX = 1000000;
constexpr uint32_t OPEN_TIMEOUT_MAX_MS = 600000;

/** Is there a NUL within, and 16 hex digits or nothing before it? */
bool is_id_field(const char (&id)[OPMS_BOX_ID_SIZE])
{
    return std::memchr(id, 0, sizeof id) && (id[0] == 0 || is_unique_id(id));
}

opms_status_t check(const opms_box_options_t &options, opms_error_t *err)
{
    int transport = 0; /* C callers can put any number in an enum */
    std::memcpy(&transport, &options.transport, sizeof transport);
    if (transport != OPMS_BOX_USB && transport != OPMS_BOX_EMULATED) {
        return fail(err, OPMS_ERR_ARG, "options->transport is unknown");
    }
    if (!is_id_field(options.unique_id)) {
        return fail(err, OPMS_ERR_ARG, "options->unique_id must be 16 hex digits, or empty");
    }
    if (options.queue_items < QUEUE_MIN || options.queue_items > QUEUE_MAX) {
        return fail(err, OPMS_ERR_ARG, "options->queue_items must be 16 to 1000000");
    }
    if (options.open_timeout_ms == 0 || options.open_timeout_ms > OPEN_TIMEOUT_MAX_MS) {
        return fail(err, OPMS_ERR_ARG, "options->open_timeout_ms must be 1 to 600000");
    }
    if (transport == OPMS_BOX_EMULATED && options.emulated_port == 0) {
        return fail(err, OPMS_ERR_ARG, "options->emulated_port must be 1 to 65535");
    }
    return OPMS_OK;
}

opms_status_t take_options(const opms_box_options_t *options, opms_box_options_t &used,
                           opms_error_t *err)
{
    opms_box_options_init(&used);
    if (!options) {
        return OPMS_OK;
    }
    if (options->struct_size < sizeof used) {
        return fail(err, OPMS_ERR_ARG,
                    "options->struct_size is too small; use opms_box_options_init()");
    }
    used = *options;
    return check(used, err);
}

opms_status_t open_box(const opms_box_options_t &options, opms_box_t **box, opms_error_t *err)
{
    auto handle = std::make_unique<opms_box>();
    std::unique_ptr<BoxTransport> transport;
    if (options.transport == OPMS_BOX_EMULATED) {
        auto emulated = std::make_unique<EmulatedTransport>(options.emulated_port);
        handle->emulated = emulated.get();
        transport = std::move(emulated);
    } else {
        transport = make_hidapi_transport();
    }
    handle->core = std::make_shared<BoxCore>(options, std::move(transport));
    const OpenResult result = handle->core->open();
    if (result.status != OPMS_OK) {
        handle->core->close();
        return fail(err, result.status, result.message);
    }
    *box = handle.release();
    return OPMS_OK;
}

} // namespace

opms_status_t opms_box_list(opms_box_entry_t *entries, uint32_t capacity, uint32_t *count,
                            opms_error_t *err)
{
    return guarded(err, [&] {
        if (!count || (!entries && capacity > 0)) {
            return fail(err, OPMS_ERR_ARG, count ? "entries is NULL" : "count is NULL");
        }
        const std::vector<opms_box_entry_t> boxes = list_hidapi_boxes();
        std::copy_n(boxes.begin(), std::min<size_t>(boxes.size(), capacity), entries);
        *count = static_cast<uint32_t>(boxes.size());
        return boxes.size() > capacity
                   ? fail(err, OPMS_ERR_CAPACITY,
                          "there are " + std::to_string(boxes.size()) + " boxes")
                   : OPMS_OK;
    });
}

void opms_box_options_init(opms_box_options_t *options)
{
    *options = {};
    options->struct_size = sizeof *options;
    options->transport = OPMS_BOX_USB;
    options->emulated_port = OPMS_BOX_EMULATED_PORT;
    options->queue_items = 4096;
    options->open_timeout_ms = 3000;
    options->fill_gaps = true;
}

opms_status_t opms_box_open(const opms_box_options_t *options, opms_box_t **box, opms_error_t *err)
{
    return guarded(err, [&] {
        if (!box) {
            return fail(err, OPMS_ERR_ARG, "box is NULL");
        }
        opms_box_options_t used;
        const opms_status_t status = take_options(options, used, err);
        return status == OPMS_OK ? open_box(used, box, err) : status;
    });
}

void opms_box_close(opms_box_t *box)
{
    if (box) {
        box->core->close();
        delete box;
    }
}

opms_status_t opms_box_poll(opms_box_t *box, uint32_t timeout_ms, opms_box_item_t *item,
                            opms_error_t *err)
{
    if (!box || !item) {
        return fail(err, OPMS_ERR_ARG, box ? "item is NULL" : "box is NULL");
    }
    if (!box->core->pop(*item, Clock::now() + std::chrono::milliseconds(timeout_ms))) {
        *item = {};
    }
    return OPMS_OK;
}

opms_status_t opms_box_get_identity(opms_box_t *box, opms_identity_report_t *identity,
                                    bool *connected, opms_error_t *err)
{
    if (!box || !identity) {
        return fail(err, OPMS_ERR_ARG, box ? "identity is NULL" : "box is NULL");
    }
    bool is_connected = false;
    *identity = box->core->identity(is_connected);
    if (connected) {
        *connected = is_connected;
    }
    return OPMS_OK;
}

opms_status_t opms_box_get_counters(opms_box_t *box, opms_box_counters_t *counters,
                                    opms_error_t *err)
{
    if (!box || !counters) {
        return fail(err, OPMS_ERR_ARG, box ? "counters is NULL" : "box is NULL");
    }
    *counters = box->core->counters();
    return OPMS_OK;
}
