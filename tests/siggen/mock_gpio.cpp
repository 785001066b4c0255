/* SPDX-License-Identifier: Apache-2.0 */
#include "mock_gpio.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace {

/* Numbers that the kernel gives out dynamically; any will do here. */
constexpr int CHIP_MAJOR = 254, LINE_MAJOR = 10, LINE_MINOR = 100;

std::string line_node(unsigned line)
{
    return "/dev/mockline" + std::to_string(line);
}

/** The struct that an ioctl points to. */
template <class T> UMockdevIoctlData *fetch(UMockdevIoctlData *argument, T &value)
{
    UMockdevIoctlData *data = umockdev_ioctl_data_resolve(argument, 0, sizeof value, nullptr);
    std::memcpy(&value, data->data, sizeof value);
    return data;
}

template <class T> void store(UMockdevIoctlData *data, const T &value)
{
    umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8 *>(const_cast<T *>(&value)),
                               sizeof value);
}

void check(bool good, GError *error)
{
    if (!good) {
        throw std::runtime_error(error->message);
    }
}

}  // namespace

MockGpio::MockGpio(UMockdevTestbed *testbed)
    : testbed_(testbed), chip_handler_(umockdev_ioctl_base_new())
{
    GError *error = nullptr;
    add_device("gpiochip0", CHIP_MAJOR, 0, "gpio");
    g_signal_connect(chip_handler_, "handle-ioctl", G_CALLBACK(on_chip), this);
    check(umockdev_testbed_attach_ioctl(testbed, "/dev/gpiochip0", chip_handler_, &error), error);
    nodes_.reserve(LINES); /* their addresses are given away */
    for (unsigned line = 0; line < LINES; ++line) {
        add_device(line_node(line).substr(5), LINE_MAJOR, LINE_MINOR + static_cast<int>(line),
                   "misc");
        nodes_.push_back({this, line, umockdev_ioctl_base_new()});
        g_signal_connect(nodes_.back().handler, "handle-ioctl", G_CALLBACK(on_line),
                         &nodes_.back());
        check(umockdev_testbed_attach_ioctl(testbed, line_node(line).c_str(),
                                            nodes_.back().handler, &error),
              error);
        /* The node is a terminal; the bytes of edges must pass through it as they are. */
        termios settings;
        const int fd = umockdev_testbed_get_dev_fd(testbed, line_node(line).c_str());
        if (tcgetattr(fd, &settings) == 0) {
            cfmakeraw(&settings);
            tcsetattr(fd, TCSANOW, &settings);
        }
    }
}

MockGpio::~MockGpio()
{
    umockdev_testbed_detach_ioctl(testbed_, "/dev/gpiochip0", nullptr);
    g_object_unref(chip_handler_);
    for (const Node &node : nodes_) {
        umockdev_testbed_detach_ioctl(testbed_, line_node(node.line).c_str(), nullptr);
        g_object_unref(node.handler);
    }
}

void MockGpio::add_device(const std::string &name, int major, int minor, const char *subsystem)
{
    const std::string numbers = std::to_string(major) + ":" + std::to_string(minor);
    const std::string text = "P: /devices/platform/mock/" + name + "\nN: " + name +
                             "\nE: SUBSYSTEM=" + subsystem + "\nE: DEVNAME=/dev/" + name +
                             "\nE: MAJOR=" + std::to_string(major) +
                             "\nE: MINOR=" + std::to_string(minor) + "\nA: dev=" + numbers +
                             "\\n\n\n";
    GError *error = nullptr;
    check(umockdev_testbed_add_from_string(testbed_, text.c_str(), &error), error);
}

gboolean MockGpio::on_chip(UMockdevIoctlBase *, UMockdevIoctlClient *client, gpointer self)
{
    const int result =
        static_cast<MockGpio *>(self)->handle_chip(umockdev_ioctl_client_get_request(client),
                                                   umockdev_ioctl_client_get_arg(client));
    umockdev_ioctl_client_complete(client, result < 0 ? -1 : 0, result < 0 ? -result : 0);
    return TRUE;
}

gboolean MockGpio::on_line(UMockdevIoctlBase *, UMockdevIoctlClient *client, gpointer data)
{
    const auto *const node = static_cast<Node *>(data);
    const int result =
        node->gpio->handle_line(node->line, umockdev_ioctl_client_get_request(client),
                                umockdev_ioctl_client_get_arg(client));
    umockdev_ioctl_client_complete(client, result < 0 ? -1 : 0, result < 0 ? -result : 0);
    return TRUE;
}

int MockGpio::handle_chip(unsigned long request, UMockdevIoctlData *argument)
{
    switch (request) {
    case GPIO_GET_CHIPINFO_IOCTL: return get_info(argument);
    case GPIO_GET_LINEINFO_IOCTL: return get_line_info(argument);
    case GPIO_GET_LINEHANDLE_IOCTL: return request_handle_v1(argument);
    case GPIO_GET_LINEEVENT_IOCTL: return request_event_v1(argument);
    case GPIO_V2_GET_LINE_IOCTL: return request_v2(argument);
    default: return -ENOTTY;
    }
}

int MockGpio::get_info(UMockdevIoctlData *argument)
{
    gpiochip_info info{};
    std::strcpy(info.name, "gpiochip0");
    std::strcpy(info.label, "mock");
    info.lines = LINES;
    gpiochip_info asked;
    store(fetch(argument, asked), info);
    return 0;
}

int MockGpio::get_line_info(UMockdevIoctlData *argument)
{
    gpioline_info info;
    UMockdevIoctlData *const data = fetch(argument, info);
    if (info.line_offset >= LINES) {
        return -EINVAL;
    }
    info.flags = static_cast<int>(info.line_offset) == busy_line ? GPIOLINE_FLAG_KERNEL : 0;
    store(data, info);
    return 0;
}

int MockGpio::open_line(unsigned line, const Request &request, int active)
{
    if (line >= LINES) {
        return -EINVAL;
    }
    if (static_cast<int>(line) == busy_line) {
        return -EBUSY;
    }
    requests[line] = request;
    if (request.output) {
        drive(line, active);
    }
    return open(line_node(line).c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
}

int MockGpio::request_handle_v1(UMockdevIoctlData *argument)
{
    gpiohandle_request request;
    UMockdevIoctlData *const data = fetch(argument, request);
    if (request.lines != 1) {
        return -EINVAL;
    }
    const Request mine{(request.flags & GPIOHANDLE_REQUEST_OUTPUT) != 0,
                       (request.flags & GPIOHANDLE_REQUEST_ACTIVE_LOW) != 0,
                       false, false, request.consumer_label, 0};
    request.fd = open_line(request.lineoffsets[0], mine, request.default_values[0]);
    if (request.fd < 0) {
        return request.fd;
    }
    store(data, request);
    return 0;
}

int MockGpio::request_event_v1(UMockdevIoctlData *argument)
{
    gpioevent_request request;
    UMockdevIoctlData *const data = fetch(argument, request);
    const Request mine{false, (request.handleflags & GPIOHANDLE_REQUEST_ACTIVE_LOW) != 0,
                       (request.eventflags & GPIOEVENT_REQUEST_RISING_EDGE) != 0,
                       (request.eventflags & GPIOEVENT_REQUEST_FALLING_EDGE) != 0,
                       request.consumer_label, 0};
    v2_ = false;
    request.fd = open_line(request.lineoffset, mine, 0);
    if (request.fd < 0) {
        return request.fd;
    }
    store(data, request);
    return 0;
}

int MockGpio::request_v2(UMockdevIoctlData *argument)
{
    gpio_v2_line_request request;
    UMockdevIoctlData *const data = fetch(argument, request);
    if (request.num_lines != 1) {
        return -EINVAL;
    }
    const auto flags = request.config.flags;
    const Request mine{(flags & GPIO_V2_LINE_FLAG_OUTPUT) != 0,
                       (flags & GPIO_V2_LINE_FLAG_ACTIVE_LOW) != 0,
                       (flags & GPIO_V2_LINE_FLAG_EDGE_RISING) != 0,
                       (flags & GPIO_V2_LINE_FLAG_EDGE_FALLING) != 0, request.consumer,
                       request.event_buffer_size};
    int active = 0;
    for (unsigned i = 0; i < request.config.num_attrs; ++i) {
        if (request.config.attrs[i].attr.id == GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES) {
            active = static_cast<int>(request.config.attrs[i].attr.values & 1);
        }
    }
    v2_ = true;
    request.fd = open_line(request.offsets[0], mine, active);
    if (request.fd < 0) {
        return request.fd;
    }
    store(data, request);
    return 0;
}

int MockGpio::handle_line(unsigned line, unsigned long request, UMockdevIoctlData *argument)
{
    if (request == GPIOHANDLE_SET_LINE_VALUES_IOCTL && requests[line].output) {
        gpiohandle_data values;
        fetch(argument, values);
        drive(line, values.values[0]);
        return 0;
    }
    if (request == GPIO_V2_LINE_SET_VALUES_IOCTL && requests[line].output) {
        gpio_v2_line_values values;
        fetch(argument, values);
        if (values.mask != 1) {
            return -EINVAL;
        }
        drive(line, static_cast<int>(values.bits & 1));
        return 0;
    }
    return -EINVAL;
}

void MockGpio::drive(unsigned line, int active)
{
    const int level = active != requests[line].active_low;
    const auto old = levels.find(line);
    const bool changes = old == levels.end() || old->second != level;
    levels[line] = level;
    if (changes) {
        on_level(line, level);
    }
}

void MockGpio::send_edge(unsigned line, std::int64_t t_ns)
{
    ++edge_number_;
    gpioevent_data old_form{};
    old_form.timestamp = static_cast<std::uint64_t>(t_ns);
    old_form.id = GPIOEVENT_EVENT_RISING_EDGE;
    gpio_v2_line_event new_form{};
    new_form.timestamp_ns = static_cast<std::uint64_t>(t_ns);
    new_form.id = GPIO_V2_LINE_EVENT_RISING_EDGE;
    new_form.offset = line;
    new_form.seqno = new_form.line_seqno = edge_number_;
    const void *const bytes = v2_ ? static_cast<const void *>(&new_form) : &old_form;
    const std::size_t size = v2_ ? sizeof new_form : sizeof old_form;
    const int fd = umockdev_testbed_get_dev_fd(testbed_, line_node(line).c_str());
    if (write(fd, bytes, size) != static_cast<ssize_t>(size)) {
        throw std::runtime_error("an edge did not fit");
    }
}
