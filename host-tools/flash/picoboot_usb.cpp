/* SPDX-License-Identifier: Apache-2.0 */
#include "picoboot_usb.hpp"

#include <array>
#include <cassert>
#include <optional>

#include <libusb.h>

#include "picoboot_protocol.hpp"

namespace opms::flash {

namespace {

constexpr unsigned CONTROL_TIMEOUT_MS = 1000;
constexpr unsigned COMMAND_TIMEOUT_MS = 3000;
/** Erasing a sector takes up to 0.4 s, writing it 16 times 3 ms. */
constexpr unsigned WORK_TIMEOUT_MS = 10000;
constexpr std::uint32_t REBOOT_DELAY_MS = 500; /**< so that the answer still comes */

[[noreturn]] void fail(int code, const std::string &doing)
{
    const std::string text = doing + ": " + libusb_strerror(static_cast<libusb_error>(code));
    switch (code) {
    case LIBUSB_ERROR_ACCESS:
        throw FlashError(Fault::permission,
                         text + ". Install the project's udev rule 70-opms-box.rules (it covers "
                                "the bootloader 2e8a:0003, too), plug the box in again, and run "
                                "the same command again; or run it as root");
    case LIBUSB_ERROR_BUSY:
        throw FlashError(Fault::permission, text + ". Another program uses it: close that first");
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
    case LIBUSB_ERROR_IO:
    case LIBUSB_ERROR_TIMEOUT: throw FlashError(Fault::gone, text);
    default: throw FlashError(Fault::refused, text);
    }
}

int check(int code, const std::string &doing)
{
    if (code < 0) {
        fail(code, doing);
    }
    return code;
}

class Context {
public:
    Context() { check(libusb_init(&context_), "starting libusb"); }
    ~Context() { libusb_exit(context_); }
    Context(const Context &) = delete;
    Context &operator=(const Context &) = delete;
    libusb_context *get() const { return context_; }

private:
    libusb_context *context_ = nullptr;
};

class DeviceList {
public:
    explicit DeviceList(const Context &context)
        : count_(libusb_get_device_list(context.get(), &list_))
    {
        check(static_cast<int>(count_), "listing the USB devices");
    }
    ~DeviceList() { libusb_free_device_list(list_, 1); }
    DeviceList(const DeviceList &) = delete;
    DeviceList &operator=(const DeviceList &) = delete;
    libusb_device **begin() const { return list_; }
    libusb_device **end() const { return list_ + count_; }

private:
    libusb_device **list_ = nullptr;
    ssize_t count_;
};

bool is_bootloader(libusb_device *device)
{
    libusb_device_descriptor descriptor;
    return libusb_get_device_descriptor(device, &descriptor) == 0 &&
           descriptor.idVendor == PICOBOOT_VENDOR && descriptor.idProduct == PICOBOOT_PRODUCT;
}

Place place_of(libusb_device *device)
{
    std::array<std::uint8_t, 8> ports;
    const int depth =
        libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
    Place place{libusb_get_bus_number(device), libusb_get_device_address(device), ""};
    for (int i = 0; i < depth; ++i) {
        place.port += (i ? "." : "") + std::to_string(ports[static_cast<std::size_t>(i)]);
    }
    return place;
}

/** The numbers by which the PICOBOOT interface is reached. */
struct Interface {
    int number;
    std::uint8_t out, in; /**< endpoint addresses */
};

std::optional<Interface> as_picoboot(const libusb_interface_descriptor &setting)
{
    Interface found{setting.bInterfaceNumber, 0, 0};
    for (int i = 0; i < setting.bNumEndpoints; ++i) {
        const libusb_endpoint_descriptor &endpoint = setting.endpoint[i];
        if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_BULK) {
            continue;
        }
        const std::uint8_t address = endpoint.bEndpointAddress;
        (address & LIBUSB_ENDPOINT_IN ? found.in : found.out) = address;
    }
    const bool fits = setting.bInterfaceClass == PICOBOOT_INTERFACE_CLASS && found.in && found.out;
    return fits ? std::optional(found) : std::nullopt;
}

Interface find_interface(libusb_device *device)
{
    libusb_config_descriptor *config = nullptr;
    check(libusb_get_active_config_descriptor(device, &config), "reading the bootloader's layout");
    std::optional<Interface> found;
    for (int i = 0; i < config->bNumInterfaces && !found; ++i) {
        if (config->interface[i].num_altsetting > 0) {
            found = as_picoboot(config->interface[i].altsetting[0]);
        }
    }
    libusb_free_config_descriptor(config);
    if (!found) {
        throw FlashError(Fault::refused, "the bootloader has no PICOBOOT interface");
    }
    return *found;
}

class UsbBootloader : public Bootloader {
public:
    explicit UsbBootloader(const Place &place) { open(place); }

    ~UsbBootloader() override
    {
        libusb_release_interface(handle_, interface_.number);
        libusb_close(handle_);
    }

    void erase(std::uint32_t address, std::uint32_t size) override
    {
        run(command_flash_erase(address, size), nullptr);
    }

    void write(std::uint32_t address, const std::uint8_t *bytes, std::uint32_t size) override
    {
        run(command_write(address, size), const_cast<std::uint8_t *>(bytes));
    }

    void read(std::uint32_t address, std::uint8_t *bytes, std::uint32_t size) override
    {
        run(command_read(address, size), bytes);
    }

    void reboot() override { run(command_reboot(REBOOT_DELAY_MS), nullptr); }

private:
    void open(const Place &place)
    {
        const DeviceList devices(context_);
        for (libusb_device *device : devices) {
            if (is_bootloader(device) && place_of(device) == place) {
                interface_ = find_interface(device);
                check(libusb_open(device, &handle_), "opening the bootloader on " + place.name());
                prepare();
                return;
            }
        }
        throw FlashError(Fault::gone, "the bootloader on " + place.name() + " went away");
    }

    void prepare()
    {
        try {
            check(libusb_claim_interface(handle_, interface_.number),
                  "claiming the bootloader's interface");
            reset();
            run(command_exclusive_access(), nullptr);
            run(command_exit_xip(), nullptr);
        } catch (...) {
            libusb_close(handle_);
            throw;
        }
    }

    /** Out of whatever state a run before this one has left. */
    void reset()
    {
        check(libusb_control_transfer(handle_, vendor_request(LIBUSB_ENDPOINT_OUT),
                                      PICOBOOT_REQUEST_RESET, 0, interface_index(), nullptr, 0,
                                      CONTROL_TIMEOUT_MS),
              "resetting the bootloader");
        libusb_clear_halt(handle_, interface_.out);
        libusb_clear_halt(handle_, interface_.in);
    }

    static std::uint8_t vendor_request(libusb_endpoint_direction direction)
    {
        return static_cast<std::uint8_t>(direction | LIBUSB_REQUEST_TYPE_VENDOR |
                                         LIBUSB_RECIPIENT_INTERFACE);
    }

    std::uint16_t interface_index() const { return static_cast<std::uint16_t>(interface_.number); }

    /** Command, data by its direction, and the empty packet that ends it. */
    void run(const Command &command, std::uint8_t *data)
    {
        auto bytes = command_bytes(command, ++token_);
        transfer(command, interface_.out, bytes.data(), static_cast<int>(bytes.size()),
                 COMMAND_TIMEOUT_MS);
        const std::uint8_t data_endpoint = command.is_in() ? interface_.in : interface_.out;
        if (command.transfer_bytes > 0) {
            transfer(command, data_endpoint, data, static_cast<int>(command.transfer_bytes),
                     WORK_TIMEOUT_MS);
        }
        finish(command);
    }

    /** An empty packet against the direction of the data. A host controller wants room for a
     * packet even where none has bytes. */
    void finish(const Command &command)
    {
        std::array<std::uint8_t, 64> room;
        if (command.is_in()) {
            transfer(command, interface_.out, room.data(), 0, WORK_TIMEOUT_MS);
        } else {
            move(command, interface_.in, room.data(), static_cast<int>(room.size()),
                 WORK_TIMEOUT_MS);
        }
    }

    void transfer(const Command &command, std::uint8_t endpoint, std::uint8_t *bytes, int size,
                  unsigned timeout_ms)
    {
        const int moved = move(command, endpoint, bytes, size, timeout_ms);
        if (moved != size) {
            throw FlashError(Fault::gone, command_name(command) + ": " + std::to_string(moved) +
                                              " of " + std::to_string(size) + " bytes came");
        }
    }

    int move(const Command &command, std::uint8_t endpoint, std::uint8_t *bytes, int size,
             unsigned timeout_ms)
    {
        int moved = 0;
        const int code =
            libusb_bulk_transfer(handle_, endpoint, bytes, size, &moved, timeout_ms);
        if (code == LIBUSB_ERROR_PIPE) {
            fail_refused(command);
        }
        check(code, command_name(command));
        return moved;
    }

    /** The bootloader stalled: ask why, and leave it ready for the next one. */
    [[noreturn]] void fail_refused(const Command &command)
    {
        std::array<std::uint8_t, PICOBOOT_STATUS_BYTES> bytes{};
        const int size = libusb_control_transfer(
            handle_, vendor_request(LIBUSB_ENDPOINT_IN), PICOBOOT_REQUEST_STATUS, 0,
            interface_index(), bytes.data(), static_cast<std::uint16_t>(bytes.size()),
            CONTROL_TIMEOUT_MS);
        std::string why = "it does not say why";
        const CommandStatus status = status_parse(bytes);
        if (size == static_cast<int>(bytes.size()) && status.token == token_) {
            why = status_name(status.code);
        }
        reset();
        throw FlashError(Fault::refused,
                         "the bootloader refused " + command_name(command) + ": " + why);
    }

    Context context_;
    libusb_device_handle *handle_ = nullptr;
    Interface interface_{};
    std::uint32_t token_ = 0;
};

}  // namespace

std::vector<Place> UsbBootloaders::list()
{
    const Context context;
    const DeviceList devices(context);
    std::vector<Place> places;
    for (libusb_device *device : devices) {
        if (is_bootloader(device)) {
            places.push_back(place_of(device));
        }
    }
    return places;
}

std::unique_ptr<Bootloader> UsbBootloaders::open(const Place &place)
{
    return std::make_unique<UsbBootloader>(place);
}

}  // namespace opms::flash
