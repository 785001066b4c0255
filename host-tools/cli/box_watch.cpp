/* SPDX-License-Identifier: Apache-2.0 */
#include "box_watch.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#include "box_json.hpp"

namespace {

constexpr size_t PULSES_KEPT = 64;
constexpr size_t NEWS_SHOWN = 5;
constexpr size_t NEWS_MAX = 1000; /* nobody reads more than that in a second */

std::string lost_text(const opms_lost_item_t &lost)
{
    switch (lost.what) {
    case OPMS_LOST_REPORTS: return box_text("%u reports lost on the way", lost.count);
    case OPMS_LOST_TRIGGERS:
        return box_text("pulse %u: %u reports missing, asking HISTORY", lost.first, lost.count);
    case OPMS_LOST_UNFILLED: return box_text("pulse %u: %u lost for good", lost.first, lost.count);
    case OPMS_LOST_ITEMS: return box_text("this program was too slow for %u reports", lost.count);
    }
    return "";
}

} // namespace

BoxWatch::BoxWatch(uint32_t period_us) : period_us_(period_us)
{
    if (opms_clock_create(nullptr, &clock_, nullptr) != OPMS_OK) {
        throw std::bad_alloc();
    }
}

BoxWatch::~BoxWatch()
{
    opms_clock_destroy(clock_);
}

void BoxWatch::take(const opms_box_item_t &item)
{
    switch (item.kind) {
    case OPMS_ITEM_TRIGGER: take_trigger(item.as.trigger, item.t_host_ns); break;
    case OPMS_ITEM_PONG: take_pong(item.as.pong, item.t_host_ns); break;
    case OPMS_ITEM_STATUS: take_status(item.as.status); break;
    case OPMS_ITEM_EVENT:
        take_event(item.as.event);
        tell(item, box_event_text(item.as.event));
        break;
    case OPMS_ITEM_LINK:
        take_link(item.as.link);
        tell(item, item.as.link.message);
        break;
    case OPMS_ITEM_LOST: tell(item, lost_text(item.as.lost)); break;
    case OPMS_ITEM_MALFORMED:
        tell(item, box_text("a report does not read: %s",
                            opms_wire_result_name(item.as.malformed.result)));
        break;
    case OPMS_ITEM_HISTORY:
    case OPMS_ITEM_NONE: break;
    }
}

void BoxWatch::take_trigger(const opms_trigger_report_t &trigger, int64_t t_host_ns)
{
    take_session(trigger.session_id);
    trigger_number_ = trigger.trigger_number;
    first_run_number_ = trigger.first_run_number;
    const int64_t time_ns = opms_box_time_ns(trigger.time);
    int64_t host_ns = 0;
    if (host_time(trigger.time, host_ns)) {
        latency_ms_ = std::max(latency_ms_, static_cast<double>(t_host_ns - host_ns) / 1e6);
    }
    const bool is_newer = pulses_.empty() || trigger.trigger_number > pulses_.back().number;
    if ((trigger.flags & OPMS_TRIGGER_RUN) && is_newer) {
        pulses_.push_back({trigger.trigger_number, time_ns});
        if (pulses_.size() > PULSES_KEPT) {
            pulses_.pop_front();
        }
    }
}

void BoxWatch::take_pong(const opms_pong_item_t &pong, int64_t t_host_ns)
{
    if (pong.t_sent_host_ns != 0) {
        const opms_round_trip_t trip = {pong.t_sent_host_ns,
                                        opms_box_time_ns(pong.report.received),
                                        opms_box_time_ns(pong.report.sent), t_host_ns};
        opms_clock_push(clock_, &trip, nullptr);
    }
}

void BoxWatch::take_status(const opms_status_report_t &status)
{
    state_ = status.state;
    take_session(status.session_id);
    trigger_number_ = status.trigger_number;
    first_run_number_ = status.first_run_number;
    uptime_us_ = status.uptime_us;
    dropped_first_ = has_dropped_ ? dropped_first_ : status.dropped;
    dropped_last_ = status.dropped;
    has_dropped_ = true;
}

void BoxWatch::take_event(const opms_event_report_t &event)
{
    state_ = event.state;
    take_session(event.session_id);
    if (event.kind == OPMS_EVENT_ARMED) {
        pulses_.clear();
        trigger_number_ = first_run_number_ = 0;
    } else if (event.kind == OPMS_EVENT_STOP) {
        pulses_.clear();
    }
}

void BoxWatch::take_link(const opms_link_item_t &link)
{
    connected_ = link.change == OPMS_LINK_CONNECTED ||
                 (connected_ && link.change != OPMS_LINK_DISCONNECTED);
    if (link.change == OPMS_LINK_REBOOTED) {
        forget_boot();
    }
}

/** Another boot: its clock and its counters begin anew. */
void BoxWatch::forget_boot()
{
    opms_clock_reset(clock_);
    dropped_before_ += dropped_last_ - dropped_first_;
    dropped_first_ = dropped_last_ = 0;
    pulses_.clear();
    session_id_ = trigger_number_ = first_run_number_ = 0;
    state_ = OPMS_BOX_IDLE;
}

void BoxWatch::take_session(uint32_t session_id)
{
    if (session_id != session_id_) {
        session_id_ = session_id;
        pulses_.clear();
    }
}

void BoxWatch::tell(const opms_box_item_t &item, const std::string &text)
{
    if (news_.size() < NEWS_MAX) {
        news_.push_back(item);
    }
    last_news_.push_back(text);
    if (last_news_.size() > NEWS_SHOWN) {
        last_news_.pop_front();
    }
}

uint32_t BoxWatch::dropped() const
{
    return dropped_before_ + (dropped_last_ - dropped_first_);
}

double BoxWatch::rate_hz() const
{
    if (pulses_.size() < 2) {
        return 0;
    }
    const Pulse &first = pulses_.front(), &last = pulses_.back();
    return (last.number - first.number) * 1e9 / static_cast<double>(last.time_ns - first.time_ns);
}

int64_t BoxWatch::jitter_ns() const
{
    int64_t worst = 0;
    for (size_t i = 1; i < pulses_.size(); ++i) {
        const int64_t steps = pulses_[i].number - pulses_[i - 1].number;
        const int64_t due = steps * static_cast<int64_t>(period_us_) * 1000;
        worst = std::max<int64_t>(
            worst, std::llabs(pulses_[i].time_ns - pulses_[i - 1].time_ns - due));
    }
    return worst;
}

opms_clock_fit_t BoxWatch::clock() const
{
    opms_clock_fit_t fit = {};
    opms_clock_get(clock_, &fit);
    return fit;
}

bool BoxWatch::host_time(opms_box_time_t time, int64_t &host_ns) const
{
    return opms_clock_host_from_box(clock_, opms_box_time_ns(time), &host_ns, nullptr) == OPMS_OK;
}

double BoxWatch::take_latency_ms()
{
    const double latency_ms = latency_ms_;
    latency_ms_ = -1;
    return latency_ms;
}

std::vector<opms_box_item_t> BoxWatch::take_news()
{
    std::vector<opms_box_item_t> news;
    news.swap(news_);
    return news;
}
