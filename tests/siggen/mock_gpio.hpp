/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A GPIO chip of this process, for libgpiod of either API: umockdev shows it in /sys and /dev and
 * hands us the ioctls; edges go into the files that libgpiod reads. */
#ifndef TESTS_SIGGEN_MOCK_GPIO_HPP
#define TESTS_SIGGEN_MOCK_GPIO_HPP

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <umockdev.h>

class MockGpio {
public:
    static constexpr unsigned LINES = 6;

    explicit MockGpio(UMockdevTestbed *testbed);
    ~MockGpio();
    MockGpio(const MockGpio &) = delete;
    MockGpio &operator=(const MockGpio &) = delete;

    /** An edge of @p line with the kernel's time stamp; to be called by on_level. */
    void send_edge(unsigned line, std::int64_t t_ns);
    /** An edge that the kernel had no room for. */
    void drop_edge() { ++edge_number_; }

    /** Called at each change of a level that a program drives. Levels are of the wire, 0 or 1. */
    std::function<void(unsigned line, int level)> on_level = [](unsigned, int) {};
    int busy_line = -1; /**< taken by another program */

    /** What was asked for, by line. */
    struct Request {
        bool output, active_low, rising, falling;
        std::string consumer;
        unsigned kernel_edges; /**< 0: as the kernel likes */
    };
    std::map<unsigned, Request> requests;
    std::map<unsigned, int> levels; /**< of outputs */

private:
    struct Node {
        MockGpio *gpio;
        unsigned line;
        UMockdevIoctlBase *handler;
    };

    static gboolean on_chip(UMockdevIoctlBase *base, UMockdevIoctlClient *client, gpointer self);
    static gboolean on_line(UMockdevIoctlBase *base, UMockdevIoctlClient *client, gpointer node);
    int handle_chip(unsigned long request, UMockdevIoctlData *argument);
    int handle_line(unsigned line, unsigned long request, UMockdevIoctlData *argument);
    int get_info(UMockdevIoctlData *argument);
    int get_line_info(UMockdevIoctlData *argument);
    int request_handle_v1(UMockdevIoctlData *argument);
    int request_event_v1(UMockdevIoctlData *argument);
    int request_v2(UMockdevIoctlData *argument);
    int open_line(unsigned line, const Request &request, int active);
    void drive(unsigned line, int active);
    void add_device(const std::string &name, int major, int minor, const char *subsystem);

    UMockdevTestbed *testbed_;
    UMockdevIoctlBase *chip_handler_;
    std::vector<Node> nodes_;
    bool v2_ = false; /* which API has asked for TRIG */
    std::uint32_t edge_number_ = 0;
};

#endif
