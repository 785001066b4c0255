/* SPDX-License-Identifier: Apache-2.0 */
/* The frame of the self-test: the order of its checks, and what they look at. */
#include "box_selftest.hpp"

#include <utility>

namespace {

constexpr uint32_t POLL_MS = 20;
constexpr uint32_t PERIOD_US = 100000; /* until the settings are read */

} // namespace

void SelftestRecord::take(const opms_box_item_t &item)
{
    watch_.take(item);
    if (item.kind == OPMS_ITEM_TRIGGER) {
        int64_t host_ns = 0;
        const bool known = watch_.host_time(item.as.trigger.time, host_ns);
        const double latency_ms = static_cast<double>(item.t_host_ns - host_ns) / 1e6;
        triggers_[item.as.trigger.trigger_number] = {item.as.trigger, known, latency_ms};
    } else if (item.kind == OPMS_ITEM_EVENT) {
        events_.push_back(item.as.event);
    } else if (item.kind == OPMS_ITEM_STATUS) {
        status_ = item.as.status;
        ++statuses_;
    } else if (item.kind == OPMS_ITEM_PONG && item.as.pong.t_sent_host_ns != 0) {
        ++pongs_;
    }
}

bool SelftestRecord::pump(std::chrono::milliseconds longest,
                          const std::function<bool()> &is_enough)
{
    const auto deadline = std::chrono::steady_clock::now() + longest;
    while (!is_enough()) {
        if (std::chrono::steady_clock::now() >= deadline) {
            return false;
        }
        opms_box_item_t item = {};
        if (opms_box_poll(device_.get(), POLL_MS, &item, nullptr) == OPMS_OK) {
            take(item);
        }
    }
    return true;
}

void SelftestRecord::begin_session()
{
    triggers_.clear();
    events_.clear();
}

const opms_event_report_t *SelftestRecord::event(opms_event_kind_t kind) const
{
    for (const opms_event_report_t &event : events_) {
        if (event.kind == kind) {
            return &event;
        }
    }
    return nullptr;
}

size_t SelftestRecord::count_events(opms_event_kind_t kind) const
{
    size_t count = 0;
    for (const opms_event_report_t &event : events_) {
        count += event.kind == kind ? 1 : 0;
    }
    return count;
}

Selftest::Selftest(const BoxDevice &device, const SelftestOptions &options, Tell tell)
    : device_(device), options_(options), tell_(std::move(tell)), record_(device, PERIOD_US)
{
}

void Selftest::pass(const std::string &name, const std::string &text)
{
    tell_({name, CheckResult::ok, text});
}

void Selftest::fail(const std::string &name, const std::string &text)
{
    ++failed_;
    tell_({name, CheckResult::failed, text});
}

void Selftest::skip(const std::string &name, const std::string &text)
{
    tell_({name, CheckResult::skipped, text});
}

bool Selftest::called(const std::string &name, opms_status_t status, const opms_error_t &error)
{
    if (status != OPMS_OK) {
        fail(name, error.message);
    }
    return status == OPMS_OK;
}

void Selftest::run()
{
    check_identity();
    if (!check_status() || !check_idle() || !check_settings()) {
        check_losses();
        return;
    }
    check_clock();
    if (check_arm()) {
        if (check_preamble() && wait_start()) {
            check_run("run");
        }
        check_reports();
        check_stop();
        check_history();
    }
    check_loopback();
    check_losses();
}
