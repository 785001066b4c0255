/* SPDX-License-Identifier: Apache-2.0 */
#include "v4l2_controls.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>

#include <linux/videodev2.h>

namespace opms_host {
namespace {

constexpr double EXPOSURE_UNIT_US = 100.0;

std::string lower(const void *name, std::size_t size)
{
    const char *const text = static_cast<const char *>(name);
    std::string result(text, strnlen(text, size));
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

bool has(const std::string &text, const char *part)
{
    return text.find(part) != std::string::npos;
}

std::optional<V4l2Control> query(V4l2Calls &calls, int fd, std::uint32_t id)
{
    v4l2_queryctrl control = {};
    control.id = id;
    constexpr std::uint32_t useless = V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY;
    if (calls.ioctl(fd, VIDIOC_QUERYCTRL, &control) < 0 || (control.flags & useless) != 0 ||
        control.maximum <= control.minimum) {
        return std::nullopt;
    }
    return V4l2Control{id, control.minimum, control.maximum, std::max(1, control.step)};
}

bool set(V4l2Calls &calls, int fd, std::uint32_t id, std::int64_t value)
{
    v4l2_control control = {};
    control.id = id;
    control.value = static_cast<std::int32_t>(value);
    return calls.ioctl(fd, VIDIOC_S_CTRL, &control) == 0;
}

std::optional<std::int64_t> get(V4l2Calls &calls, int fd, std::uint32_t id)
{
    v4l2_control control = {};
    control.id = id;
    if (calls.ioctl(fd, VIDIOC_G_CTRL, &control) < 0) {
        return std::nullopt;
    }
    return control.value;
}

/* The entry of a menu that means an outside line, or its first one, which means none. */
std::optional<std::int64_t> menu_entry(V4l2Calls &calls, int fd, const V4l2Control &control,
                                       bool outside)
{
    for (std::int64_t i = control.least; i <= control.most; ++i) {
        v4l2_querymenu entry = {};
        entry.id = control.id;
        entry.index = static_cast<std::uint32_t>(i);
        if (calls.ioctl(fd, VIDIOC_QUERYMENU, &entry) < 0) {
            continue;
        }
        const std::string name = lower(entry.name, sizeof entry.name);
        const bool is_outside = has(name, "ext") || has(name, "hardware") || has(name, "line") ||
                                name == "on" || name == "enabled";
        const bool is_none = has(name, "off") || has(name, "disabled") || has(name, "free") ||
                             has(name, "intern") || has(name, "none") || has(name, "master");
        if (outside ? is_outside : is_none) {
            return i;
        }
    }
    return std::nullopt;
}

/* There is no standard control for it: drivers have their own, and its name tells. */
void find_trigger(V4l2Calls &calls, int fd, V4l2Controls &controls)
{
    v4l2_queryctrl next = {};
    next.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    while (!controls.trigger && calls.ioctl(fd, VIDIOC_QUERYCTRL, &next) == 0) {
        const std::string name = lower(next.name, sizeof next.name);
        const bool fits = has(name, "trigger") && (has(name, "mode") || has(name, "enable")) &&
                          (next.flags & V4L2_CTRL_FLAG_DISABLED) == 0;
        const V4l2Control control = {next.id, next.minimum, next.maximum, 1};
        if (fits && next.type == V4L2_CTRL_TYPE_MENU) {
            const auto on = menu_entry(calls, fd, control, true);
            const auto off = menu_entry(calls, fd, control, false);
            if (on && off) {
                controls.trigger = control;
                controls.trigger_on = *on;
                controls.trigger_off = *off;
            }
        } else if (fits && (next.type == V4L2_CTRL_TYPE_BOOLEAN ||
                            (next.type == V4L2_CTRL_TYPE_INTEGER && next.minimum <= 0 &&
                             next.maximum >= 1))) {
            controls.trigger = control;
        }
        next.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
}

std::int64_t fitting(const V4l2Control &control, double wanted)
{
    const double steps = std::round((wanted - static_cast<double>(control.least)) /
                                    static_cast<double>(control.step));
    const double value =
        static_cast<double>(control.least) + steps * static_cast<double>(control.step);
    return static_cast<std::int64_t>(std::clamp(value, static_cast<double>(control.least),
                                                static_cast<double>(control.most)));
}

}  // namespace

V4l2Controls v4l2_find_controls(V4l2Calls &calls, int fd)
{
    V4l2Controls controls;
    controls.exposure = query(calls, fd, V4L2_CID_EXPOSURE_ABSOLUTE);
    controls.gain = query(calls, fd, V4L2_CID_ANALOGUE_GAIN);
    if (!controls.gain) {
        controls.gain = query(calls, fd, V4L2_CID_GAIN);
    }
    find_trigger(calls, fd, controls);
    return controls;
}

void v4l2_take_manual(V4l2Calls &calls, int fd)
{
    /* Each is refused where there is no such control, and then there is nothing to switch off. */
    set(calls, fd, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
    set(calls, fd, V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0);
    set(calls, fd, V4L2_CID_AUTOGAIN, 0);
}

bool v4l2_set_trigger(V4l2Calls &calls, int fd, const V4l2Controls &controls, bool hardware,
                      std::string &error)
{
    if (!controls.trigger) {
        error = "its driver has no control for a trigger";
        return !hardware;
    }
    const std::int64_t value = hardware ? controls.trigger_on : controls.trigger_off;
    if (!set(calls, fd, controls.trigger->id, value) ||
        get(calls, fd, controls.trigger->id) != value) {
        error = std::string("its driver refuses to switch the trigger: ") + std::strerror(errno);
        return false;
    }
    return true;
}

bool v4l2_set_exposure(V4l2Calls &calls, int fd, const V4l2Controls &controls,
                       double gain_step_db, ExposureSetting &setting, std::string &error)
{
    if (!std::isnan(setting.exposure_us)) {
        if (!controls.exposure) {
            error = "its driver has no control for the exposure in 100 us";
            return false;
        }
        if (!set(calls, fd, controls.exposure->id,
                 fitting(*controls.exposure, setting.exposure_us / EXPOSURE_UNIT_US))) {
            error = std::string("its driver refuses the exposure: ") + std::strerror(errno);
            return false;
        }
    }
    if (!std::isnan(setting.gain_db) && controls.gain && gain_step_db > 0 &&
        !set(calls, fd, controls.gain->id,
             fitting(*controls.gain, static_cast<double>(controls.gain->least) +
                                         setting.gain_db / gain_step_db))) {
        error = std::string("its driver refuses the gain: ") + std::strerror(errno);
        return false;
    }
    setting = v4l2_read_exposure(calls, fd, controls, gain_step_db);
    return true;
}

ExposureSetting v4l2_read_exposure(V4l2Calls &calls, int fd, const V4l2Controls &controls,
                                   double gain_step_db)
{
    ExposureSetting setting;
    const auto automatic = get(calls, fd, V4L2_CID_EXPOSURE_AUTO);
    const bool manual = !automatic || *automatic == V4L2_EXPOSURE_MANUAL ||
                        *automatic == V4L2_EXPOSURE_SHUTTER_PRIORITY;
    if (controls.exposure && manual) {
        if (const auto value = get(calls, fd, controls.exposure->id)) {
            setting.exposure_us = EXPOSURE_UNIT_US * static_cast<double>(*value);
        }
    }
    if (get(calls, fd, V4L2_CID_AUTOGAIN).value_or(0) != 0) {
        return setting;
    }
    setting.gain_db = 0.0;
    if (controls.gain && gain_step_db > 0) {
        const auto value = get(calls, fd, controls.gain->id);
        setting.gain_db = value ? gain_step_db * static_cast<double>(*value - controls.gain->least)
                                : NOT_KNOWN;
    }
    return setting;
}

}  // namespace opms_host
