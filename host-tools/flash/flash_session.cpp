/* SPDX-License-Identifier: Apache-2.0 */
#include "flash_session.hpp"

#include <algorithm>
#include <cctype>
#include <optional>

namespace opms::flash {

namespace {

template <class T> bool contains(const std::vector<T> &all, const T &one)
{
    return std::find(all.begin(), all.end(), one) != all.end();
}

/** The first of @p now that was not there before. */
template <class T>
std::optional<T> newcomer(const std::vector<T> &before, const std::vector<T> &now)
{
    for (const T &one : now) {
        if (!contains(before, one)) {
            return one;
        }
    }
    return std::nullopt;
}

bool same_id(const std::string &a, const std::string &b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
        return std::toupper(x) == std::toupper(y);
    });
}

std::string listing(const std::vector<Place> &places, const std::vector<std::string> &ids)
{
    std::string text;
    for (const std::string &id : ids) {
        text += "\n  box hid:" + id;
    }
    for (const Place &place : places) {
        text += "\n  bootloader on " + place.name();
    }
    return text;
}

class Session {
public:
    Session(const SessionOptions &options, Bootloaders &bootloaders, Boxes &boxes,
            const SessionHooks &hooks)
        : options_(options), bootloaders_(bootloaders), boxes_(boxes), hooks_(hooks)
    {
    }

    BoxVersion run(const Image &image)
    {
        places_ = bootloaders_.list();
        ids_ = boxes_.list();
        const Place place = choose();
        /* Those that run now: whoever comes in addition is the one that was flashed. */
        ids_.erase(std::remove(ids_.begin(), ids_.end(), entered_), ids_.end());
        std::unique_ptr<Bootloader> bootloader = open(place);
        hooks_.talk("writing to the bootloader on " + place.name());
        write(*bootloader, image);
        reboot(*bootloader);
        bootloader.reset();
        return options_.sees_boxes ? wait_for_box() : BoxVersion{};
    }

private:
    Place choose()
    {
        if (!options_.may_enter) {
            return only_bootloader();
        }
        if (!options_.box_id.empty()) {
            return enter(wanted_box());
        }
        if (places_.size() + ids_.size() > 1) {
            refuse_several("Choose a running box with --box hid:ID, or unplug all but one");
        }
        if (!ids_.empty()) {
            return enter(ids_.front());
        }
        return only_bootloader();
    }

    std::string wanted_box() const
    {
        const auto found = std::find_if(ids_.begin(), ids_.end(), [this](const std::string &id) {
            return same_id(id, options_.box_id);
        });
        if (found == ids_.end()) {
            const bool nothing = places_.empty() && ids_.empty();
            throw FlashError(Fault::no_device,
                             "box " + options_.box_id + " is not there. What is there:" +
                                 (nothing ? " nothing" : listing(places_, ids_)));
        }
        return *found;
    }

    Place only_bootloader() const
    {
        if (places_.size() > 1) {
            refuse_several("Bootloaders cannot be told apart: unplug all but one");
        }
        if (places_.empty()) {
            throw FlashError(Fault::no_device,
                             std::string(options_.may_enter ? "no box and no" : "no") +
                                 " Pico in its bootloader was found. Hold the Pico's BOOTSEL "
                                 "button while you plug it in, then run the same command again");
        }
        return places_.front();
    }

    [[noreturn]] void refuse_several(const std::string &remedy) const
    {
        throw FlashError(Fault::several, "more than one can be flashed. " + remedy + ":" +
                                             listing(places_, options_.may_enter
                                                                  ? ids_
                                                                  : std::vector<std::string>{}));
    }

    Place enter(const std::string &id)
    {
        hooks_.talk("box " + id + " restarts as a bootloader");
        boxes_.enter_bootloader(id);
        entered_ = id;
        for (int waited = 0; waited < SESSION_ENTER_MS; waited += SESSION_POLL_MS) {
            hooks_.sleep_ms(SESSION_POLL_MS);
            if (const auto place = newcomer(places_, bootloaders_.list())) {
                return *place;
            }
        }
        throw FlashError(Fault::gone, "the box did not come up as a bootloader. Hold its BOOTSEL "
                                      "button while you plug it in, then run the same command "
                                      "with --no-enter");
    }

    /** A device that has just come up may not be ours yet: udev sets permissions a little later. */
    std::unique_ptr<Bootloader> open(const Place &place)
    {
        for (int waited = 0;; waited += SESSION_POLL_MS) {
            try {
                return bootloaders_.open(place);
            } catch (const FlashError &error) {
                if (error.fault() != Fault::permission || entered_.empty() ||
                    waited >= SESSION_SETTLE_MS) {
                    throw;
                }
            }
            hooks_.sleep_ms(SESSION_POLL_MS);
        }
    }

    void write(Bootloader &bootloader, const Image &image)
    {
        try {
            flash_write(bootloader, image, hooks_.progress);
        } catch (const FlashError &error) {
            if (error.fault() != Fault::gone) {
                throw;
            }
            throw FlashError(Fault::gone,
                             std::string(error.what()) +
                                 ". Nothing is broken: the box still comes up as a bootloader (the "
                                 "drive RPI-RP2). Plug it in again and run the same command again");
        }
    }

    static void reboot(Bootloader &bootloader)
    {
        try {
            bootloader.reboot();
        } catch (const FlashError &error) {
            if (error.fault() != Fault::gone) { /* gone: it was quick about it */
                throw;
            }
        }
    }

    BoxVersion wait_for_box()
    {
        hooks_.talk("written and verified; waiting for the box to come back");
        for (int waited = 0; waited < SESSION_RETURN_MS; waited += SESSION_POLL_MS) {
            hooks_.sleep_ms(SESSION_POLL_MS);
            if (const auto id = newcomer(ids_, boxes_.list())) {
                return ask(*id);
            }
        }
        throw FlashError(Fault::no_return,
                         "the firmware was written and verified, but no box came back. Unplug it, "
                         "plug it in again, and see whether `opms box list` shows it");
    }

    BoxVersion ask(const std::string &id)
    {
        for (int waited = 0;; waited += SESSION_POLL_MS) {
            try {
                return boxes_.version(id);
            } catch (const FlashError &error) {
                if (error.fault() != Fault::no_device || waited >= SESSION_SETTLE_MS) {
                    throw FlashError(Fault::no_return,
                                     "the firmware was written and verified and box " + id +
                                         " is back, but it does not tell its version: " +
                                         error.what());
                }
            }
            hooks_.sleep_ms(SESSION_POLL_MS);
        }
    }

    const SessionOptions &options_;
    Bootloaders &bootloaders_;
    Boxes &boxes_;
    const SessionHooks &hooks_;
    std::vector<Place> places_;
    std::vector<std::string> ids_;
    std::string entered_;
};

}  // namespace

BoxVersion flash_session(const Image &image, const SessionOptions &options,
                         Bootloaders &bootloaders, Boxes &boxes, const SessionHooks &hooks)
{
    return Session(options, bootloaders, boxes, hooks).run(image);
}

}  // namespace opms::flash
