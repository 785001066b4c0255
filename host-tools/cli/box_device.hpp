/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The option --box, and the box that it means. */
#ifndef OPMS_CLI_BOX_DEVICE_HPP
#define OPMS_CLI_BOX_DEVICE_HPP

#include <memory>
#include <string>

#include <opms/hid.h>

namespace CLI {
class App;
}

/** Add --box to a command. What it refuses is a matter of use. */
void add_box_option(CLI::App &command, std::string &text);

/** What a failed call means for the program's exit code. */
int box_exit_code(opms_status_t status);

/** Say something on stderr. */
void box_talk(const std::string &line);

/** An open box; closed at the end. */
class BoxDevice {
public:
    /** @param text  As --box has it.
     * @param ping_interval_ms  0: no pings of its own.
     * @param[out] exit_code  Set where there is no box; why is said on stderr.
     * @return NULL then. */
    static std::unique_ptr<BoxDevice> open(const std::string &text, uint32_t ping_interval_ms,
                                           int &exit_code);
    ~BoxDevice();
    BoxDevice(const BoxDevice &) = delete;
    BoxDevice &operator=(const BoxDevice &) = delete;

    opms_box_t *get() const { return box_; }
    bool is_emulated() const { return emulated_; }
    opms_identity_report_t identity() const;
    bool is_connected() const;
    opms_box_counters_t counters() const;

private:
    BoxDevice(opms_box_t *box, bool emulated) : box_(box), emulated_(emulated) {}

    opms_box_t *box_;
    bool emulated_;
};

/** 16 hex digits. */
std::string box_id_text(const opms_identity_report_t &identity);

/** A session id that is most likely another one than the last. */
uint32_t box_new_session();

#endif
