/* SPDX-License-Identifier: Apache-2.0 */
/* Checks of pulses: preamble, START and run, their reports, stop, and the box's memory of them. */
#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "box_json.hpp"
#include "box_selftest.hpp"

namespace {

using std::chrono::milliseconds;

constexpr milliseconds PATIENCE(3000);
constexpr int64_t TIME_TOLERANCE_NS = 1000;
constexpr double LATENCY_MAX_MS = 20;
constexpr uint32_t RUN_PULSES_MIN = 3, RUN_PULSES_MAX = 20, RUN_US = 3000000;
constexpr uint64_t START_HIGH_NS = 20'000'000;

int64_t time_ns(const SelftestRecord::Trigger &trigger)
{
    return opms_box_time_ns(trigger.report.time);
}

/** Are the numbers 1, 2, 3, ... without a hole? @return "" or what is wrong. */
std::string numbering_fault(const std::map<uint32_t, SelftestRecord::Trigger> &triggers)
{
    uint32_t due = 1;
    for (const auto &entry : triggers) {
        if (entry.first != due) {
            return box_text("the report of pulse %u is missing", due);
        }
        ++due;
    }
    return "";
}

} // namespace

bool Selftest::check_arm()
{
    record_.begin_session();
    session_id_ = box_new_session();
    opms_error_t error = {};
    if (!called("arm", opms_box_arm(device_.get(), session_id_, 0, &error), error)) {
        return false;
    }
    pass("arm", box_text("session %u", session_id_));
    return true;
}

bool Selftest::check_preamble()
{
    uint32_t total_ms = 0;
    for (const uint16_t gap_ms : settings_.preamble_gap_ms) {
        total_ms += gap_ms;
    }
    const auto is_waiting = [this] { return record_.event(OPMS_EVENT_WAITING) != nullptr; };
    if (!record_.pump(milliseconds(total_ms) + PATIENCE, is_waiting)) {
        fail("preamble", "the box does not get ready for START");
        return false;
    }
    if (total_ms == 0) {
        skip("preamble", "is off; 'opms box settings --preamble 100,200,100,300,100' turns it on");
        return true;
    }
    const size_t due = box_preamble_gaps(settings_) + 1;
    record_.pump(PATIENCE, [&] { return record_.triggers().size() >= due; });
    const size_t count = record_.triggers().size();
    const std::string fault = numbering_fault(record_.triggers());
    if (count != due || !fault.empty()) {
        fail("preamble", box_text("%zu pulses reported, should be %zu. ", count, due) + fault);
        return true;
    }
    if (check_gaps()) {
        pass("preamble", box_text("%zu pulses, gaps ", count) + box_preamble_text(settings_));
    }
    return true;
}

bool Selftest::check_gaps()
{
    const auto &triggers = record_.triggers();
    for (size_t i = 0; i < box_preamble_gaps(settings_); ++i) {
        const auto &before = triggers.at(static_cast<uint32_t>(i) + 1);
        const auto &after = triggers.at(static_cast<uint32_t>(i) + 2);
        const int64_t gap_ns = time_ns(after) - time_ns(before);
        const int64_t due_ns = settings_.preamble_gap_ms[i] * int64_t{1000000};
        if (std::llabs(gap_ns - due_ns) > TIME_TOLERANCE_NS) {
            fail("preamble", box_text("gap %zu is %.6f ms, should be %u ms", i + 1,
                                      static_cast<double>(gap_ns) / 1e6,
                                      settings_.preamble_gap_ms[i]));
            return false;
        }
        if (after.report.gap_us[0] != after.report.time.us - before.report.time.us) {
            fail("preamble", box_text("the report of pulse %zu tells a gap of %u us, its time %llu",
                                      i + 2, after.report.gap_us[0],
                                      static_cast<unsigned long long>(after.report.time.us -
                                                                      before.report.time.us)));
            return false;
        }
    }
    return true;
}

void Selftest::check_reports()
{
    std::vector<double> latencies;
    size_t delayed = 0;
    for (const auto &entry : record_.triggers()) {
        delayed += (entry.second.report.flags & OPMS_TRIGGER_DELAYED) ? 1 : 0;
        if (entry.second.has_latency) {
            latencies.push_back(entry.second.latency_ms);
        }
    }
    if (latencies.empty()) {
        skip("reports", "no pulse, no report");
        return;
    }
    std::sort(latencies.begin(), latencies.end());
    const double median_ms = latencies[latencies.size() / 2];
    const std::string text =
        box_text("%zu reports, %.2f ms after their pulses, %.2f ms at most, %zu marked as delayed",
                 latencies.size(), median_ms, latencies.back(), delayed);
    if (median_ms > LATENCY_MAX_MS) {
        fail("reports", text + ": late; is this machine very busy?");
    } else {
        pass("reports", text);
    }
}

/** START, from whoever can give it. @return Whether it came. */
bool Selftest::wait_start()
{
    const auto has_begun = [this] { return record_.event(OPMS_EVENT_START) != nullptr; };
    if (device_.is_emulated()) {
        opms_box_emulate_line(device_.get(), OPMS_EMULATED_START, true, 0, nullptr);
        opms_box_emulate_line(device_.get(), OPMS_EMULATED_START, false, START_HIGH_NS, nullptr);
    } else if (options_.wait_start_s <= 0 && options_.loopback) {
        skip("run", "nobody gives START here; see loopback-run, where TRIG gives it");
        return false;
    } else if (options_.wait_start_s <= 0) {
        skip("run", "nobody gives START here. Wire a 3.3 V signal to the pin START and its ground "
                    "(docs/box.md), call with --wait-start 30 and give an edge meanwhile");
        return false;
    } else {
        box_talk("give START now");
    }
    const auto longest =
        PATIENCE + milliseconds(static_cast<int64_t>(options_.wait_start_s * 1000));
    if (record_.pump(longest, has_begun)) {
        return true;
    }
    const size_t glitches = record_.count_events(OPMS_EVENT_GLITCH);
    fail("run", glitches ? box_text("START was active too short %zu times: less than the debounce "
                                    "of %.3f us", glitches, box_debounce_us(settings_))
                         : std::string("no START came: check the wire to the pin START, its ground "
                                       "and its level, and the edge in the settings"));
    return false;
}

void Selftest::check_run(const std::string &name)
{
    const opms_event_report_t start = *record_.event(OPMS_EVENT_START);
    const uint32_t first = start.argument;
    const uint32_t pulses =
        std::clamp(RUN_US / settings_.period_us, RUN_PULSES_MIN, RUN_PULSES_MAX);
    const uint32_t last = first + pulses - 1;
    const milliseconds longest(settings_.period_us / 1000 * int64_t{pulses} + 3000);
    const auto &triggers = record_.triggers();
    if (!record_.pump(longest, [&] { return triggers.count(last) > 0; })) {
        fail(name, box_text("%zu pulses reported after START, should be %u",
                            static_cast<size_t>(std::distance(triggers.lower_bound(first),
                                                              triggers.end())), pulses));
        return;
    }
    const std::string fault = numbering_fault(triggers);
    if (!fault.empty()) {
        fail(name, fault);
        return;
    }
    const int64_t edge_ns = opms_box_time_ns(start.time);
    const int64_t delay_ns = 8 * (int64_t{settings_.debounce_cycles} + OPMS_BOX_START_CYCLES);
    int64_t worst_ns = 0;
    for (uint32_t number = first; number <= last; ++number) {
        const int64_t due_ns =
            edge_ns + delay_ns + int64_t{number - first} * settings_.period_us * 1000;
        worst_ns = std::max<int64_t>(worst_ns,
                                     std::llabs(time_ns(triggers.at(number)) - due_ns));
    }
    const std::string text = box_text("%u pulses, %.3f us from START to the first, %lld ns off "
                                      "the period of %.3f ms at most", pulses,
                                      static_cast<double>(delay_ns) / 1e3,
                                      static_cast<long long>(worst_ns),
                                      settings_.period_us / 1e3);
    worst_ns > TIME_TOLERANCE_NS ? fail(name, text) : pass(name, text);
}

void Selftest::check_stop()
{
    opms_error_t error = {};
    if (!called("stop", opms_box_disarm(device_.get(), 0, &error), error)) {
        return;
    }
    if (!record_.pump(PATIENCE, [this] { return record_.event(OPMS_EVENT_STOP) != nullptr; })) {
        fail("stop", "no EVENT of the stop came");
        return;
    }
    const uint32_t last = record_.event(OPMS_EVENT_STOP)->argument;
    const auto &triggers = record_.triggers();
    const auto all_came = [&] { return last == 0 || triggers.count(last) > 0; };
    record_.pump(PATIENCE, all_came);
    const uint32_t newest = triggers.empty() ? 0 : triggers.rbegin()->first;
    if (newest != last) {
        fail("stop", box_text("the box says that pulse %u was the last, but %u was reported", last,
                              newest));
    } else {
        pass("stop", box_text("after pulse %u", last));
    }
}

void Selftest::check_history()
{
    const auto &triggers = record_.triggers();
    if (triggers.empty()) {
        skip("history", "no pulse was made");
        return;
    }
    const uint32_t count = triggers.rbegin()->first;
    std::vector<opms_history_entry_t> entries(count);
    opms_error_t error = {};
    if (!called("history",
                opms_box_history(device_.get(), session_id_, 1, count, 0, entries.data(), &error),
                error)) {
        return;
    }
    for (const opms_history_entry_t &entry : entries) {
        const auto trigger = triggers.find(entry.number);
        const bool held = (entry.flags & OPMS_TRIGGER_NOT_HELD) == 0;
        if (!held || (trigger != triggers.end() &&
                      time_ns(trigger->second) != opms_box_time_ns(entry.time))) {
            fail("history", box_text("pulse %u: the box %s", entry.number,
                                     held ? "remembers another time than it reported"
                                          : "does not remember it"));
            return;
        }
    }
    pass("history", box_text("%u pulses, as reported", count));
}

void Selftest::check_losses()
{
    const opms_box_counters_t counters = device_.counters();
    uint64_t malformed = 0;
    for (const uint64_t count : counters.malformed) {
        malformed += count;
    }
    const std::string text = box_text(
        "%llu reports lost, %llu malformed, %llu pulses missed, %u dropped in the box",
        static_cast<unsigned long long>(counters.reports_lost),
        static_cast<unsigned long long>(malformed),
        static_cast<unsigned long long>(counters.triggers_missed), record_.watch().dropped());
    if (!device_.is_connected() || counters.connections > 1 || counters.reboots > 0) {
        fail("losses", "the box went away during the test: check cable and power");
    } else if (counters.reports_lost || malformed || counters.triggers_missed ||
               record_.watch().dropped()) {
        lost_ = true;
        fail("losses", text + ": try another USB port, another cable and no hub");
    } else {
        pass("losses", text);
    }
}
