/* SPDX-License-Identifier: Apache-2.0 */
/* opms::hid has the threads, seeks a box that was unplugged and fills gaps from HISTORY. Here its
 * items pass through one queue, so that a wake() can end a poll(). A box that was never there when
 * the program began is sought by a thread that tries to open it, once a second. */
#include "hid_box.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <mutex>
#include <thread>

#include "host_clock.hpp"

namespace opms_host {
namespace {

constexpr uint32_t PING_INTERVAL_MS = 100; /* the clock model wants 31 round trips soon */
constexpr std::size_t QUEUE_MOST = 65536;  /* 10 minutes at 100 Hz that nobody polled */
constexpr uint64_t PRESS_NS = 20'000'000;  /* longer than the longest debounce */
constexpr auto SEEK_INTERVAL = std::chrono::seconds(1);

std::string id_text(const opms_identity_report_t &identity)
{
    static const char digits[] = "0123456789abcdef";
    std::string text;
    for (const uint8_t byte : identity.unique_id) {
        text += digits[byte >> 4];
        text += digits[byte & 15];
    }
    return text;
}

class HidBox : public BoxPort {
public:
    explicit HidBox(const opms_box_options_t &place) : options_(place)
    {
        options_.ping_interval_ms = PING_INTERVAL_MS;
        options_.on_item = [](void *user, const opms_box_item_t *item) {
            static_cast<HidBox *>(user)->take(*item);
        };
        options_.user = this;
    }

    ~HidBox() override
    {
        {
            const std::lock_guard<std::mutex> lock(seek_mutex_);
            closing_ = true;
        }
        seek_wakes_.notify_all();
        if (seeker_.joinable()) {
            seeker_.join();
        }
        opms_box_close(box_.load());
    }

    bool open(bool wait_for_missing, std::string &error)
    {
        opms_error_t why = {};
        const opms_status_t status = try_open(why);
        if (status == OPMS_OK) {
            return true;
        }
        error = why.message;
        const bool may_come = status == OPMS_ERR_DEVICE || status == OPMS_ERR_TIMEOUT;
        if (!wait_for_missing || !may_come) {
            return false;
        }
        tell_missing(why.message);
        seeker_ = std::thread([this] { seek(); });
        return true;
    }

    std::string name() const override
    {
        if (options_.transport == OPMS_BOX_EMULATED) {
            return "emulated:" + std::to_string(options_.emulated_port);
        }
        opms_identity_report_t seen = {};
        opms_box_t *const box = box_;
        if (box && opms_box_get_identity(box, &seen, nullptr, nullptr) == OPMS_OK) {
            return "hid:" + id_text(seen);
        }
        return options_.unique_id[0] ? std::string("hid:") + options_.unique_id : "hid";
    }

    bool poll(uint32_t timeout_ms, opms_box_item_t &item) override
    {
        item = opms_box_item_t();
        std::unique_lock<std::mutex> lock(mutex_);
        came_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                       [this] { return !items_.empty() || woken_; });
        if (!items_.empty()) {
            item = items_.front();
            items_.pop_front();
        } else {
            woken_ = false;
        }
        return true;
    }

    void wake() override
    {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            woken_ = true;
        }
        came_.notify_all();
    }

    bool arm(uint32_t session_id, std::string &error) override
    {
        return call(error, [&](opms_box_t *box, opms_error_t *why) {
            return opms_box_arm(box, session_id, 0, why);
        });
    }
    bool disarm(std::string &error) override
    {
        return call(error, [](opms_box_t *box, opms_error_t *why) {
            return opms_box_disarm(box, 0, why);
        });
    }
    bool settings(opms_settings_report_t &report, std::string &error) override
    {
        return call(error, [&](opms_box_t *box, opms_error_t *why) {
            return opms_box_get_settings(box, 0, &report, why);
        });
    }
    bool set_settings(const opms_settings_t &settings, std::string &error) override
    {
        return call(error, [&](opms_box_t *box, opms_error_t *why) {
            return opms_box_set_settings(box, &settings, 0, nullptr, why);
        });
    }

    bool identity(opms_identity_report_t &identity) const override
    {
        bool connected = false;
        opms_box_t *const box = box_;
        identity = opms_identity_report_t();
        return box && opms_box_get_identity(box, &identity, &connected, nullptr) == OPMS_OK &&
               connected;
    }

    bool press_start(std::string &error) override
    {
        if (options_.transport != OPMS_BOX_EMULATED) {
            error = "the START line of a real box is pressed by hand";
            return false;
        }
        return call(error, [](opms_box_t *box, opms_error_t *why) {
            const opms_status_t status =
                opms_box_emulate_line(box, OPMS_EMULATED_START, true, 0, why);
            return status != OPMS_OK ? status
                                     : opms_box_emulate_line(box, OPMS_EMULATED_START, false,
                                                             PRESS_NS, why);
        });
    }

private:
    template <typename Call> bool call(std::string &error, Call &&what)
    {
        opms_box_t *const box = box_;
        if (!box) {
            error = "the box has not been found yet";
            return false;
        }
        opms_error_t why = {};
        if (what(box, &why) != OPMS_OK) {
            error = why.message;
            return false;
        }
        return true;
    }

    /* What comes before it is open is told after: who hears of a connection may use it at once. */
    opms_status_t try_open(opms_error_t &why)
    {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            opening_ = true;
        }
        opms_box_t *box = nullptr;
        const opms_status_t status = opms_box_open(&options_, &box, &why);
        if (status == OPMS_OK) {
            box_ = box;
        }
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            opening_ = false;
            if (status == OPMS_OK) {
                items_.insert(items_.end(), held_.begin(), held_.end());
            }
            held_.clear();
        }
        came_.notify_one();
        return status;
    }

    void tell_missing(const char *message)
    {
        opms_box_item_t item = {};
        item.kind = OPMS_ITEM_LINK;
        item.t_host_ns = SystemClock().now_ns();
        item.as.link.change = OPMS_LINK_DISCONNECTED;
        /* A message that is longer is cut. */
        const std::size_t size = std::min(std::strlen(message), sizeof item.as.link.message - 1);
        std::memcpy(item.as.link.message, message, size);
        take(item);
    }

    void seek()
    {
        std::unique_lock<std::mutex> lock(seek_mutex_);
        while (!seek_wakes_.wait_for(lock, SEEK_INTERVAL, [this] { return closing_; })) {
            lock.unlock();
            opms_error_t why = {};
            if (try_open(why) == OPMS_OK) {
                return;
            }
            lock.lock();
        }
    }

    /* Where nobody polls for minutes, the newest are left out and counted at that place. */
    void take(const opms_box_item_t &item)
    {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (opening_) {
                held_.push_back(item);
            } else if (items_.size() < QUEUE_MOST) {
                items_.push_back(item);
            } else if (items_.back().kind == OPMS_ITEM_LOST &&
                       items_.back().as.lost.what == OPMS_LOST_ITEMS) {
                ++items_.back().as.lost.count;
            } else {
                opms_box_item_t lost = {};
                lost.kind = OPMS_ITEM_LOST;
                lost.t_host_ns = item.t_host_ns;
                lost.as.lost.what = OPMS_LOST_ITEMS;
                lost.as.lost.count = 1;
                items_.push_back(lost);
            }
        }
        came_.notify_one();
    }

    opms_box_options_t options_;
    std::atomic<opms_box_t *> box_{nullptr};

    std::mutex mutex_;
    std::condition_variable came_;
    std::deque<opms_box_item_t> items_, held_;
    bool woken_ = false, opening_ = false;

    std::thread seeker_;
    std::mutex seek_mutex_;
    std::condition_variable seek_wakes_;
    bool closing_ = false;
};

}  // namespace

std::unique_ptr<BoxPort> open_hid_box(const opms_box_options_t &place, bool wait_for_missing,
                                      std::string &error)
{
    auto box = std::make_unique<HidBox>(place);
    if (!box->open(wait_for_missing, error)) {
        return nullptr;
    }
    return box;
}

}  // namespace opms_host
