/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Fetches lost pulses from the box's HISTORY, one request at a time, so that what callers ask gets
 * its turn in between. One thread. */
#ifndef OPMS_HID_HISTORY_FILL_HPP
#define OPMS_HID_HISTORY_FILL_HPP

#include <deque>
#include <vector>

#include "box_transport.hpp"
#include "report_tracker.hpp"

namespace opms_hid {

/** One selection of pulses, read to its end; who else selects meanwhile is noticed. */
class HistoryReader {
public:
    HistoryReader(uint32_t session_id, uint32_t first, uint32_t count, uint16_t token);

    bool is_done() const { return left_ == 0; }
    uint32_t next() const { return next_; }
    uint32_t left() const { return left_; }
    /** The box is another one than before, or was away: select again. */
    void select_again() { selected_ = false; }
    /** One request. @param[out] entries  What it brought, to be appended.
     * @return done: went well; others: try again, or give up. */
    Io step(BoxTransport &transport, std::vector<opms_history_entry_t> &entries,
            uint32_t &boot_id);

private:
    Io select(BoxTransport &transport);
    Io take(const opms_history_report_t &report, std::vector<opms_history_entry_t> &entries);

    uint32_t session_id_;
    uint32_t next_, left_;
    uint16_t token_;
    bool selected_ = false;
};

class HistoryFill {
public:
    /** What a step brought. */
    struct Result {
        std::vector<opms_box_item_t> items;
        uint32_t filled, unfilled;
        bool failed; /**< the request: leave the box alone for a moment */
    };

    void add(const Gap &gap);
    bool is_idle() const { return gaps_.empty() && given_up_.empty(); }
    /** The box was unplugged: what it had been asked for is forgotten. */
    void disconnected();
    void step(BoxTransport &transport, Result &result);

private:
    void give_up(const Gap &gap, Result &result);
    void take(const std::vector<opms_history_entry_t> &entries, uint32_t boot_id, Result &result);

    struct Job {
        Gap gap;
        HistoryReader reader;
        int failures;
    };
    std::deque<Job> gaps_;
    std::vector<Gap> given_up_;
    std::vector<opms_history_entry_t> entries_;
    uint16_t token_ = 0;
};

} // namespace opms_hid

#endif
