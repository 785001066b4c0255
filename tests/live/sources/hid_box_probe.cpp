/* SPDX-License-Identifier: Apache-2.0 */
/* Opens a box by its text, does what stdin says, and prints its items as JSON lines:
 *
 *     hid_box_probe BOX [wait]
 *
 * The test in Python drives it. */
#include <cstdio>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>

#include "open_devices.hpp"

using namespace opms_host;

static void print_item(const opms_box_item_t &item)
{
    switch (item.kind) {
    case OPMS_ITEM_TRIGGER:
        std::printf("{\"item\":\"trigger\",\"session\":%u,\"number\":%u}\n",
                    item.as.trigger.session_id, item.as.trigger.trigger_number);
        break;
    case OPMS_ITEM_HISTORY:
        std::printf("{\"item\":\"history\",\"number\":%u}\n", item.as.history.entry.number);
        break;
    case OPMS_ITEM_PONG: std::printf("{\"item\":\"pong\"}\n"); break;
    case OPMS_ITEM_EVENT:
        std::printf("{\"item\":\"event\",\"kind\":%d}\n", static_cast<int>(item.as.event.kind));
        break;
    case OPMS_ITEM_LINK:
        std::printf("{\"item\":\"link\",\"change\":%d}\n",
                    static_cast<int>(item.as.link.change));
        break;
    default: return;
    }
    std::fflush(stdout);
}

static bool carry_out(BoxPort &box, const std::string &command, std::string &error)
{
    opms_settings_report_t report = {};
    opms_identity_report_t identity = {};
    if (command == "arm") {
        return box.arm(4711, error);
    }
    if (command == "disarm") {
        return box.disarm(error);
    }
    if (command == "start") {
        return box.press_start(error);
    }
    if (command == "settings") {
        return box.settings(report, error) && box.set_settings(report.settings, error);
    }
    error = "not connected";
    return command == "identity" && box.identity(identity);
}

int main(int argc, char **argv)
{
    OpenRequest request;
    request.box = argc > 1 ? argv[1] : "hid";
    request.source = "none";
    request.wait_for_missing = argc > 2;
    Devices devices;
    OpenError failure;
    if (!open_devices(request, devices, failure)) {
        std::printf("{\"reply\":\"open\",\"ok\":false,\"kind\":%d,\"text\":\"%s\"}\n",
                    static_cast<int>(failure.kind), failure.text.c_str());
        return 1;
    }
    std::printf("{\"reply\":\"open\",\"ok\":true,\"name\":\"%s\"}\n",
                devices.box->name().c_str());
    std::fflush(stdout);
    bool going = true;
    std::mutex mutex; /* of `going` */
    std::thread reader([&] {
        opms_box_item_t item;
        for (;;) {
            devices.box->poll(60000, item); /* wake() must end it */
            print_item(item);
            const std::lock_guard<std::mutex> lock(mutex);
            if (!going) {
                return;
            }
        }
    });
    for (std::string command; std::getline(std::cin, command) && command != "close";) {
        std::string error;
        const bool ok = carry_out(*devices.box, command, error);
        std::printf("{\"reply\":\"%s\",\"ok\":%s,\"text\":\"%s\"}\n", command.c_str(),
                    ok ? "true" : "false", ok ? "" : error.c_str());
        std::fflush(stdout);
    }
    {
        const std::lock_guard<std::mutex> lock(mutex);
        going = false;
    }
    devices.box->wake();
    reader.join();
    std::printf("{\"reply\":\"close\",\"ok\":true}\n");
    return 0;
}
