/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The two threads of an open box, and what callers and threads share.
 *
 * The reader thread opens the box, reads it and opens it again; the worker thread carries out
 * requests and fills gaps. Both hold the core by shared pointers: where a system call hangs at
 * closing time the core lives until it returns. */
#ifndef OPMS_HID_BOX_CORE_HPP
#define OPMS_HID_BOX_CORE_HPP

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "box_transport.hpp"
#include "history_fill.hpp"
#include "item_queue.hpp"
#include "report_tracker.hpp"

namespace opms_hid {

/** What the box was last seen to be and to say; the counts tell new from old. */
struct Seen {
    uint32_t statuses, refusals, stops;
    opms_box_state_t state;
    uint32_t session_id;
    uint32_t armed_session_id; /**< of the last EVENT ARMED */
    uint32_t refused;          /**< argument of the last EVENT REFUSED */
    opms_refusal_t refusal;
};

class BoxCore : public std::enable_shared_from_this<BoxCore> {
public:
    using Work = std::function<Io(BoxTransport &)>;

    BoxCore(const opms_box_options_t &options, std::unique_ptr<BoxTransport> transport);

    /** Start the threads and wait for the first opening. */
    OpenResult open();
    void close();

    bool pop(opms_box_item_t &item, Clock::time_point deadline);
    opms_identity_report_t identity(bool &connected);
    opms_box_counters_t counters();

    /** Let the worker do that. What `work` uses must be its own: it may outlive the call.
     * @return gone: not plugged in; timed_out: not done by the deadline. */
    Io run(Work work, Clock::time_point deadline);
    /** Send a ping now. For the worker. */
    Io send_ping(BoxTransport &transport, uint32_t ping_id);
    uint32_t next_ping_id();
    void arming(uint32_t session_id);
    Seen seen();
    /** Wait until what was seen satisfies that. @return Whether it did by the deadline. */
    bool wait_seen(const std::function<bool(const Seen &)> &is_enough, Clock::time_point deadline);
    /** HISTORY has one selection: callers take turns, and gaps wait meanwhile.
     * @return Whether it is the caller's turn; end_history_turn() in any case. */
    bool begin_history_turn(Clock::time_point deadline);
    void end_history_turn(bool was_ours);

private:
    struct Request {
        Work work;
        Io io = Io::timed_out;
        bool is_done = false;
    };
    using Lock = std::unique_lock<std::mutex>;

    /* box_reader.cpp: the reader thread */
    void read_thread();
    OpenResult open_once(const std::string &unique_id, int timeout_ms,
                         opms_identity_report_t &identity);
    OpenResult read_identity(opms_identity_report_t &identity);
    void set_connected(const opms_identity_report_t &identity);
    void set_disconnected();
    void read_until_gone();
    void take(const Input &input);
    void note(const opms_box_item_t &item);
    void tell_link(opms_link_change_t change, uint32_t boot_id, const std::string &message);
    bool pause(std::chrono::milliseconds time);

    /* box_worker.cpp: the worker thread */
    void work_thread();
    void do_request(Lock &lock);
    void do_ping(Lock &lock);
    void do_fill(Lock &lock);
    bool may_fill(Clock::time_point now) const;
    Clock::time_point next_wake() const;

    void start_thread(std::thread &thread, void (BoxCore::*body)());
    void join_or_leave(std::thread &thread, bool is_over);
    void deliver(const opms_box_item_t *items, size_t count);

    const opms_box_options_t options_;
    const std::unique_ptr<BoxTransport> transport_;
    ItemQueue queue_;
    std::mutex deliver_mutex_; /* of is_closed_ and the callback */
    bool is_closed_ = false;
    std::thread reader_, worker_;

    std::mutex mutex_; /* of all below */
    std::condition_variable changed_;
    bool stopping_ = false;
    int running_ = 0; /* threads */
    bool opened_ = false;
    OpenResult outcome_ = {};
    bool connected_ = false;
    bool announced_ = false; /* that it is: items of the worker come after that word */
    uint32_t connection_ = 0; /* which one it is */
    opms_identity_report_t identity_ = {};
    Seen seen_ = {};
    ReportTracker tracker_;
    ReportTracker::Result taken_; /* of the reader thread alone */
    std::deque<std::shared_ptr<Request>> requests_;
    uint64_t requests_failed_ = 0, filled_ = 0, unfilled_ = 0;
    std::deque<Gap> new_gaps_;
    int history_wanted_ = 0; /* by callers */
    bool history_taken_ = false;
    uint32_t ping_id_;
    Clock::time_point next_ping_;

    HistoryFill fill_; /* of the worker thread alone, as is what follows */
    HistoryFill::Result fill_result_;
    uint32_t fill_connection_ = 0;
    Clock::time_point fill_after_;
};

} // namespace opms_hid

#endif
