/* SPDX-License-Identifier: Apache-2.0 */
#include "interrupted.hpp"

#include <atomic>
#include <csignal>

namespace {

std::atomic<bool> came{false};

void on_signal(int number)
{
    came = true;
    std::signal(number, SIG_DFL);
}

}  // namespace

void catch_interrupts()
{
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
}

bool interrupted()
{
    return came;
}
