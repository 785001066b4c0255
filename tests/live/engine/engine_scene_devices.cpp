/* SPDX-License-Identifier: Apache-2.0 */
#include <chrono>

#include "engine_scene.hpp"

namespace engine_scene {

using namespace std::chrono_literals;

bool SceneBox::poll(std::uint32_t timeout_ms, opms_box_item_t &item)
{
    std::unique_lock<std::mutex> lock(mutex);
    polling = true;
    filled.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                    [this] { return woken || !items.empty(); });
    woken = false;
    item = {};
    if (!items.empty()) {
        polling = false;
        item = items.front();
        items.pop_front();
    }
    return true;
}

void SceneBox::wake()
{
    const std::lock_guard<std::mutex> lock(mutex);
    woken = true;
    filled.notify_all();
}

bool SceneBox::arm(std::uint32_t id, std::string &error)
{
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (refuses || !is_there) {
            error = "it refuses";
            return false;
        }
        session_id = id;
    }
    if (on_arm) {
        on_arm();
    }
    return true;
}

bool SceneBox::disarm(std::string &error)
{
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!is_there) {
            error = "it is not there";
            return false;
        }
    }
    if (on_disarm) {
        on_disarm();
    }
    return true;
}

bool SceneBox::settings(opms_settings_report_t &report, std::string &)
{
    const std::lock_guard<std::mutex> lock(mutex);
    report = {};
    report.settings = in_force;
    return true;
}

bool SceneBox::set_settings(const opms_settings_t &settings, std::string &)
{
    const std::lock_guard<std::mutex> lock(mutex);
    in_force = settings;
    return true;
}

bool SceneBox::identity(opms_identity_report_t &identity) const
{
    const std::lock_guard<std::mutex> lock(mutex);
    identity = {};
    identity.boot_id = boot_id;
    return is_there;
}

bool SceneBox::press_start(std::string &)
{
    if (on_start) {
        on_start();
    }
    return true;
}

void SceneBox::put(const opms_box_item_t &item)
{
    const std::lock_guard<std::mutex> lock(mutex);
    items.push_back(item);
    filled.notify_all();
}

bool SceneBox::all_taken() const
{
    const std::lock_guard<std::mutex> lock(mutex);
    return items.empty() && polling;
}

bool SceneCamera::start(const SourceStart &start, std::string &error)
{
    if (starts_refused > 0) {
        --starts_refused;
        error = "it is not there";
        return false;
    }
    started = start;
    ++starts;
    return true;
}

void SceneCamera::wait(std::uint32_t timeout_ms, SourceItem &item)
{
    std::unique_lock<std::mutex> lock(mutex);
    waiting = true;
    filled.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                    [this] { return woken || !items.empty(); });
    woken = false;
    item = SourceItem();
    if (!items.empty()) {
        waiting = false;
        item = std::move(items.front());
        items.pop_front();
    }
}

void SceneCamera::wake()
{
    const std::lock_guard<std::mutex> lock(mutex);
    woken = true;
    filled.notify_all();
}

bool SceneCamera::set_exposure(double exposure_us, double, std::string &)
{
    const std::lock_guard<std::mutex> lock(mutex);
    exposures_set.push_back(exposure_us);
    return true;
}

SourceCounters SceneCamera::counters() const
{
    SourceCounters counters;
    counters.buffers = 16;
    counters.lent = lent;
    counters.no_buffer = no_buffer;
    return counters;
}

void SceneCamera::put(const SourceItem &item)
{
    const std::lock_guard<std::mutex> lock(mutex);
    items.push_back(item);
    filled.notify_all();
}

bool SceneCamera::all_taken() const
{
    const std::lock_guard<std::mutex> lock(mutex);
    return items.empty() && waiting;
}

}  // namespace engine_scene
