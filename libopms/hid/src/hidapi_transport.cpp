/* SPDX-License-Identifier: Apache-2.0 */
/* hidapi keeps the text of the last error in the handle and in a global, both unprotected. So the
 * calls on handles that threads share are kept apart: enumeration and opening under one mutex of
 * the process, and one handle for reading and one for the rest. Only hidraw allows two; the libusb
 * back end claims the interface but keeps no error texts, so there one handle serves both. */
#include "hidapi_transport.hpp"

#include <cerrno>
#include <cstdio>
#include <mutex>

#include <unistd.h>

#include <hidapi/hidapi.h>

namespace opms_hid {

namespace {

std::mutex &hidapi_mutex()
{
    static std::mutex mutex;
    return mutex;
}

std::string narrow(const wchar_t *text)
{
    std::string out;
    for (; text && *text; ++text) {
        out += *text >= 0x20 && *text < 0x7F ? static_cast<char>(*text) : '?';
    }
    return out;
}

/** The libusb back end does not tell usages; then the ids must do. */
bool is_box(const hid_device_info &info)
{
    return info.usage_page == 0 ||
           (info.usage_page == OPMS_USB_USAGE_PAGE && info.usage == OPMS_USB_USAGE);
}

opms_box_entry_t entry_of(const hid_device_info &info)
{
    opms_box_entry_t entry = {};
    const std::string serial = narrow(info.serial_number);
    std::snprintf(entry.unique_id, sizeof entry.unique_id, "%s", serial.c_str());
    std::snprintf(entry.product, sizeof entry.product, "%s", narrow(info.product_string).c_str());
    std::snprintf(entry.path, sizeof entry.path, "%s", info.path ? info.path : "");
    entry.release = info.release_number;
    const bool is_node = entry.path[0] == '/';
    entry.accessible = is_node ? access(entry.path, R_OK | W_OK) == 0 : !serial.empty();
    return entry;
}

/** Call with the mutex held. */
std::vector<opms_box_entry_t> enumerate()
{
    std::vector<opms_box_entry_t> boxes;
    hid_device_info *const all = hid_enumerate(OPMS_USB_VENDOR_ID, OPMS_USB_PRODUCT_ID);
    for (const hid_device_info *info = all; info; info = info->next) {
        if (is_box(*info)) {
            boxes.push_back(entry_of(*info));
        }
    }
    hid_free_enumeration(all);
    return boxes;
}

std::string name_of(const opms_box_entry_t &box)
{
    return std::string(box.unique_id[0] ? box.unique_id : "(id not readable)") + " at " + box.path;
}

std::string listed(const std::vector<opms_box_entry_t> &boxes)
{
    std::string text;
    for (const opms_box_entry_t &box : boxes) {
        text += (text.empty() ? "" : ", ") + name_of(box);
    }
    return text;
}

OpenResult absent(const std::string &unique_id, const std::vector<opms_box_entry_t> &boxes)
{
    if (boxes.empty()) {
        return {OPMS_ERR_DEVICE, true,
                unique_id.empty() ? "no trigger box is plugged in"
                                  : "box " + unique_id + " is not plugged in, nor any other", {}};
    }
    return {OPMS_ERR_DEVICE, true,
            "box " + unique_id + " is not plugged in; there is " + listed(boxes), {}};
}

OpenResult choose(const std::string &unique_id, const std::vector<opms_box_entry_t> &boxes,
                  opms_box_entry_t &chosen)
{
    if (unique_id.empty() && boxes.size() > 1) {
        return {OPMS_ERR_DEVICE, false,
                std::to_string(boxes.size()) + " boxes are plugged in, name one by its id: " +
                    listed(boxes), {}};
    }
    for (const opms_box_entry_t &box : boxes) {
        if (unique_id.empty() || same_unique_id(unique_id, box.unique_id)) {
            chosen = box;
            return {OPMS_OK, false, {}, box.unique_id};
        }
    }
    return absent(unique_id, boxes);
}

OpenResult cannot_open(const opms_box_entry_t &box)
{
    const std::string why = box.accessible
                                ? "another program may have it open"
                                : "no permission; install the udev rule 70-opms-box.rules";
    return {OPMS_ERR_DEVICE, false, "box " + name_of(box) + " cannot be opened: " + why, {}};
}

/** hidraw leaves errno as the kernel set it; libusb's back end tells nothing. */
Io failure()
{
    switch (errno) {
    case ENODEV:
    case ENXIO:
    case EIO:
    case EBADF: return Io::gone;
    case ETIMEDOUT: return Io::timed_out;
    default: return Io::stalled;
    }
}

class HidapiTransport : public BoxTransport {
public:
    ~HidapiTransport() override { close(); }

    OpenResult open(const std::string &unique_id, int /*timeout_ms*/) override
    {
        const std::lock_guard<std::mutex> requests(request_mutex_);
        const std::lock_guard<std::mutex> guard(hidapi_mutex());
        opms_box_entry_t box = {};
        OpenResult result = choose(unique_id, enumerate(), box);
        if (result.status != OPMS_OK) {
            return result;
        }
        reader_ = hid_open_path(box.path);
#ifdef OPMS_HID_ONE_HANDLE
        requester_ = reader_;
#else
        requester_ = reader_ ? hid_open_path(box.path) : nullptr;
#endif
        if (!requester_) {
            close_handles();
            return cannot_open(box);
        }
        return result;
    }

    void close() override
    {
        const std::lock_guard<std::mutex> requests(request_mutex_);
        const std::lock_guard<std::mutex> guard(hidapi_mutex());
        close_handles();
    }

    Io read(Input &input, int timeout_ms) override
    {
        const int got =
            hid_read_timeout(reader_, input.bytes.data(), input.bytes.size(), timeout_ms);
        input.t_host_ns = host_now_ns();
        input.size = got > 0 ? static_cast<size_t>(got) : 0;
        return got > 0 ? Io::done : got == 0 ? Io::none : Io::gone;
    }

    Io write(const Report &report) override
    {
        const std::lock_guard<std::mutex> requests(request_mutex_);
        if (!requester_) {
            return Io::gone;
        }
        errno = 0;
        return hid_write(requester_, report.data(), report.size()) < 0 ? failure() : Io::done;
    }

    Io get_feature(uint8_t id, Report &report, size_t &size) override
    {
        const std::lock_guard<std::mutex> requests(request_mutex_);
        if (!requester_) {
            return Io::gone;
        }
        report.fill(0);
        report[0] = id;
        errno = 0;
        const int got = hid_get_feature_report(requester_, report.data(), report.size());
        size = got > 0 ? static_cast<size_t>(got) : 0;
        return got < 0 ? failure() : Io::done;
    }

    Io set_feature(const Report &report) override
    {
        const std::lock_guard<std::mutex> requests(request_mutex_);
        if (!requester_) {
            return Io::gone;
        }
        errno = 0;
        return hid_send_feature_report(requester_, report.data(), report.size()) < 0 ? failure()
                                                                                     : Io::done;
    }

    void interrupt() override {} /* reads are short, and system calls end by themselves */

private:
    void close_handles()
    {
        if (requester_ && requester_ != reader_) {
            hid_close(requester_);
        }
        if (reader_) {
            hid_close(reader_);
        }
        reader_ = requester_ = nullptr;
    }

    std::mutex request_mutex_; /* of requester_ */
    hid_device *reader_ = nullptr;
    hid_device *requester_ = nullptr;
};

} // namespace

std::unique_ptr<BoxTransport> make_hidapi_transport()
{
    return std::make_unique<HidapiTransport>();
}

std::vector<opms_box_entry_t> list_hidapi_boxes()
{
    const std::lock_guard<std::mutex> guard(hidapi_mutex());
    return enumerate();
}

} // namespace opms_hid
