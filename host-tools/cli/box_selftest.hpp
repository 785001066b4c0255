/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The checks of `opms box selftest`: a real box, end to end, by what it says and does. */
#ifndef OPMS_CLI_BOX_SELFTEST_HPP
#define OPMS_CLI_BOX_SELFTEST_HPP

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "box_device.hpp"
#include "box_watch.hpp"

struct SelftestOptions {
    bool loopback = false;   /**< a jumper joins TRIG and START */
    bool stop = false;       /**< stop a run that is going on */
    double wait_start_s = 0; /**< wait so long for somebody to give START */
};

enum class CheckResult { ok, failed, skipped };

struct Check {
    std::string name;
    CheckResult result;
    std::string text; /**< what was found, or what is wrong and what to do */
};

/** Reads a box's items and keeps what the checks look at. */
class SelftestRecord {
public:
    struct Trigger {
        opms_trigger_report_t report;
        bool has_latency;
        double latency_ms; /**< from pulse to arrival, by the clock model */
    };

    SelftestRecord(const BoxDevice &device, uint32_t period_us) : device_(device), watch_(period_us)
    {
    }

    /** Take items until that holds. @return Whether it did in time. */
    bool pump(std::chrono::milliseconds longest, const std::function<bool()> &is_enough);
    /** Forget triggers and events of before. */
    void begin_session();
    const opms_event_report_t *event(opms_event_kind_t kind) const;
    size_t count_events(opms_event_kind_t kind) const;

    const BoxDevice &device() const { return device_; }
    const BoxWatch &watch() const { return watch_; }
    const std::map<uint32_t, Trigger> &triggers() const { return triggers_; }
    const std::vector<opms_event_report_t> &events() const { return events_; }
    uint32_t statuses() const { return statuses_; }
    const opms_status_report_t &status() const { return status_; }
    uint32_t pongs() const { return pongs_; }

private:
    void take(const opms_box_item_t &item);

    const BoxDevice &device_;
    BoxWatch watch_;
    std::map<uint32_t, Trigger> triggers_; /* by number */
    std::vector<opms_event_report_t> events_;
    opms_status_report_t status_ = {};
    uint32_t statuses_ = 0, pongs_ = 0;
};

class Selftest {
public:
    using Tell = std::function<void(const Check &)>;

    Selftest(const BoxDevice &device, const SelftestOptions &options, Tell tell);

    /** All checks, in an order in which each may rely on those before it. */
    void run();
    unsigned failed() const { return failed_; }
    /** Were pulses or reports lost? */
    bool lost() const { return lost_; }

private:
    void pass(const std::string &name, const std::string &text);
    void fail(const std::string &name, const std::string &text);
    void skip(const std::string &name, const std::string &text);
    /** A call's failure, in its own words. */
    bool called(const std::string &name, opms_status_t status, const opms_error_t &error);

    /* box_selftest_basics.cpp: without a pulse */
    void check_identity();
    bool check_status();
    bool check_idle();
    bool check_settings();
    void check_clock();

    /* box_selftest_pulses.cpp */
    bool check_arm();
    bool check_preamble();
    bool check_gaps();
    void check_reports();
    bool wait_start();
    void check_run(const std::string &name);
    void check_stop();
    void check_history();
    void check_losses();

    /* box_selftest_loopback.cpp */
    void check_loopback();
    bool put_settings(const std::string &name, const opms_settings_t &settings);
    void check_loopback_pulses();
    void check_loopback_run();

    const BoxDevice &device_;
    const SelftestOptions options_;
    const Tell tell_;
    opms_settings_t settings_ = {};
    SelftestRecord record_;
    uint32_t session_id_ = 0;
    unsigned failed_ = 0;
    bool lost_ = false;
};

#endif
