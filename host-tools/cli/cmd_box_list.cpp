/* SPDX-License-Identifier: Apache-2.0 */
/* opms box list: the boxes that are plugged in, and Picos that wait to be flashed. */
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "box_device.hpp"
#include "box_json.hpp"
#include "cmd_box.hpp"
#include "commands.hpp"
#include "result_stream.hpp"

namespace {

struct ListArguments {
    std::string box = "hid";
    bool json = false;
};

/** One line of the list. */
struct Found {
    const char *kind; /* "box" or "bootloader" */
    std::string unique_id, product, place, note;
};

std::string first_word(const std::filesystem::path &file)
{
    std::ifstream stream(file);
    std::string word;
    stream >> word;
    return word;
}

/** Picos in their bootloader are USB drives, no HID devices: the system's list of USB devices
 * shows them. */
std::vector<Found> bootloaders()
{
    std::vector<Found> found;
    std::error_code none;
    for (const auto &entry : std::filesystem::directory_iterator("/sys/bus/usb/devices", none)) {
        if (first_word(entry.path() / "idVendor") == "2e8a" &&
            first_word(entry.path() / "idProduct") == "0003") {
            found.push_back({"bootloader", "", "RP2040 in its bootloader",
                             "usb " + entry.path().filename().string(),
                             "ready for 'opms box flash'"});
        }
    }
    return found;
}

opms_status_t usb_boxes(std::vector<Found> &found, opms_error_t &error)
{
    uint32_t count = 0;
    std::vector<opms_box_entry_t> entries(64);
    const opms_status_t status = opms_box_list(
        entries.data(), static_cast<uint32_t>(entries.size()), &count, &error);
    if (status != OPMS_OK && status != OPMS_ERR_CAPACITY) {
        return status;
    }
    entries.resize(std::min<size_t>(entries.size(), count));
    for (const opms_box_entry_t &entry : entries) {
        found.push_back({"box", entry.unique_id, entry.product, entry.path,
                         entry.accessible ? "" : "no permission: install 70-opms-box.rules"});
    }
    return OPMS_OK;
}

bool find_all(const ListArguments &arguments, std::vector<Found> &found, int &exit_code)
{
    if (arguments.box.rfind("emulated", 0) == 0) {
        const auto device = BoxDevice::open(arguments.box, 0, exit_code);
        if (device) {
            found.push_back({"box", box_id_text(device->identity()), "emulated box",
                             arguments.box, ""});
        }
        return device != nullptr;
    }
    opms_error_t error = {};
    const opms_status_t status = usb_boxes(found, error);
    if (status != OPMS_OK) {
        box_talk(error.message);
        exit_code = box_exit_code(status);
        return false;
    }
    const std::vector<Found> picos = bootloaders();
    found.insert(found.end(), picos.begin(), picos.end());
    return true;
}

std::string json_line(const Found &found)
{
    const BoxJson row = {{"schema", "opms.box.list/1"}, {"kind", found.kind},
                         {"unique_id", found.unique_id}, {"product", found.product},
                         {"place", found.place},         {"accessible", found.note.empty() ||
                                                             found.unique_id.empty()}};
    return row.dump();
}

std::string table_line(const Found &found)
{
    const char *const id = found.unique_id.empty() ? "-" : found.unique_id.c_str();
    std::string line = box_text("%-16s  %-18s  %s", id, found.place.c_str(),
                                found.product.c_str());
    return found.note.empty() ? line : line + " (" + found.note + ")";
}

int list(const ListArguments &arguments)
{
    int exit_code = EXIT_CODE_OK;
    std::vector<Found> found;
    if (!find_all(arguments, found, exit_code)) {
        return exit_code;
    }
    if (found.empty()) {
        box_talk("no trigger box is plugged in");
    }
    ResultStream out;
    for (const Found &one : found) {
        if (!out.write_line(arguments.json ? json_line(one) : table_line(one))) {
            return EXIT_CODE_INPUT;
        }
    }
    return EXIT_CODE_OK;
}

} // namespace

void add_box_list(CLI::App &box, int &exit_code)
{
    const auto arguments = std::make_shared<ListArguments>();
    CLI::App *cmd =
        box.add_subcommand("list", "Which boxes are plugged in? Picos to be flashed, too.");
    add_box_option(*cmd, arguments->box);
    cmd->add_flag("--json", arguments->json, "One JSON object a line (schema opms.box.list/1)");
    cmd->callback([arguments, &exit_code] { exit_code = list(*arguments); });
}
