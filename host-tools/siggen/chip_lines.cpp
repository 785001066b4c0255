/* SPDX-License-Identifier: Apache-2.0 */
/* The real lines and the real clock. */
#include <array>
#include <cerrno>
#include <ctime>
#include <system_error>

#include <sys/prctl.h>

#include "siggen_run.hpp"

namespace opms::siggen {

namespace {

constexpr std::int64_t SECOND_NS = 1000000000;

[[noreturn]] void fail(const char *doing, int code)
{
    throw LineError(std::string(doing) + ": " + std::generic_category().message(code));
}

}  // namespace

MonotonicClock::MonotonicClock()
{
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
}

std::int64_t MonotonicClock::now_ns()
{
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * SECOND_NS + t.tv_nsec;
}

void MonotonicClock::sleep_until_ns(std::int64_t t_ns)
{
    const timespec t = {static_cast<time_t>(t_ns / SECOND_NS), static_cast<long>(t_ns % SECOND_NS)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
    }
}

ChipLines::ChipLines(const gpio_config_t &config)
{
    char error[200];
    if (gpio_lines_open(&config, &lines_, error, sizeof error) != 0) {
        throw LineError(error);
    }
}

ChipLines::~ChipLines()
{
    gpio_lines_close(lines_);
}

void ChipLines::set(gpio_role_t output, bool active)
{
    const int code = gpio_lines_set(lines_, output, active);
    if (code != 0) {
        fail("a line cannot be driven", code);
    }
}

std::vector<gpio_edge_t> ChipLines::wait(std::int64_t timeout_ns)
{
    std::array<gpio_edge_t, 64> edges;
    const int count =
        gpio_lines_wait(lines_, timeout_ns, edges.data(), static_cast<std::uint32_t>(edges.size()));
    if (count < 0) {
        fail("TRIG cannot be read", -count);
    }
    return {edges.begin(), edges.begin() + count};
}

}  // namespace opms::siggen
