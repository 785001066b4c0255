/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sends a plan and listens meanwhile. Lines and clock are interfaces, so that tests can stand in
 * for both. */
#ifndef OPMS_SIGGEN_SIGGEN_RUN_HPP
#define OPMS_SIGGEN_SIGGEN_RUN_HPP

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpio_lines.h"
#include "siggen_plan.hpp"

namespace opms::siggen {

/** The lines cannot be had, or stopped working. */
class LineError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class Lines {
public:
    virtual ~Lines() = default;
    virtual void set(gpio_role_t output, bool active) = 0;
    /** Edges of TRIG, after waiting @p timeout_ns for the first one if there is none. */
    virtual std::vector<gpio_edge_t> wait(std::int64_t timeout_ns) = 0;
};

class Clock {
public:
    virtual ~Clock() = default;
    virtual std::int64_t now_ns() = 0;
    virtual void sleep_until_ns(std::int64_t t_ns) = 0;
};

/** CLOCK_MONOTONIC, by which the kernel stamps edges, too. */
class MonotonicClock : public Clock {
public:
    MonotonicClock(); /**< asks the kernel to wake this thread without its usual slack of 50 us */
    std::int64_t now_ns() override;
    void sleep_until_ns(std::int64_t t_ns) override;
};

/** The lines of a chip, through libgpiod. @throws LineError */
class ChipLines : public Lines {
public:
    explicit ChipLines(const gpio_config_t &config);
    ~ChipLines() override;
    ChipLines(const ChipLines &) = delete;
    ChipLines &operator=(const ChipLines &) = delete;
    void set(gpio_role_t output, bool active) override;
    std::vector<gpio_edge_t> wait(std::int64_t timeout_ns) override;

private:
    gpio_lines_t *lines_ = nullptr;
};

/** "gpiochip0", "0" or a path -> the path of a GPIO chip. */
std::string chip_path(const std::string &chip);

/** An exposure in answer to each TRIG, as a camera would report it. */
struct StrobeOptions {
    bool on = false;
    std::int64_t delay_ns = 0;
    std::int64_t width_ns = 0;
};

struct RunOptions {
    PlanOptions plan;
    bool listens = false; /**< TRIG is wired */
    StrobeOptions strobe; /**< needs TRIG */
};

/** A level that was driven: when it should have changed, and between which times it did. */
struct Sent {
    std::int64_t planned_ns, before_ns, after_ns;

    std::int64_t late_ns() const { return after_ns - planned_ns; }
};

/** All that happened, by the clock's time. */
struct Run {
    std::vector<Sent> starts, start_ends; /**< rising and falling edges of START pulses */
    std::int64_t glitches = 0;
    std::vector<Sent> strobes;             /**< beginnings of exposures */
    std::vector<gpio_edge_t> edges;        /**< of TRIG */
    std::int64_t begin_ns = 0, end_ns = 0; /**< of listening */
    bool stopped = false;                  /**< by the caller, before its end */
};

/** Send and listen. All lines are inactive afterwards.
 * @param stop  Asked now and then whether to end early. */
Run run(const RunOptions &options, Lines &lines, Clock &clock, const std::function<bool()> &stop);

}  // namespace opms::siggen

#endif
