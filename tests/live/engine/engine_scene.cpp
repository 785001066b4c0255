/* SPDX-License-Identifier: Apache-2.0 */
#include "engine_scene.hpp"

#include <chrono>
#include <thread>

extern "C" {
#include "unity.h"
}

namespace engine_scene {
namespace {

constexpr std::int64_t FRAME_DELAY_NS = 30 * MS, REPORT_DELAY_NS = MS, PING_EVERY_NS = 200 * MS;

}  // namespace

opms_box_time_t box_time(std::int64_t ns)
{
    return {static_cast<std::uint64_t>(ns / 1000), static_cast<std::uint8_t>(ns % 1000 / 8)};
}

FramePtr small_frame(std::int64_t arrival_host_ns)
{
    const auto pixels = std::make_shared<std::vector<std::uint8_t>>(64, 100);
    auto frame = std::make_shared<Frame>();
    frame->image = {pixels->data(), 8, 8, 8, OPMS_PIXEL_GREY8, 0};
    frame->arrival_host_ns = arrival_host_ns;
    frame->exposure_us = 2000;
    frame->gain_db = 0;
    frame->memory = pixels;
    return frame;
}

Scene::Scene(SessionMode mode, bool with_box)
    : clock(std::make_shared<ManualClock>()), tape(std::make_shared<Tape>())
{
    devices.clock = clock;
    if (with_box) {
        auto own_box = std::make_unique<SceneBox>();
        box = own_box.get();
        opms_wire_default_settings(&box->in_force);
        devices.box = std::move(own_box);
        box->on_arm = [this] { event(OPMS_EVENT_ARMED, OPMS_BOX_ARMED, box->session_id); };
        box->on_disarm = [this] {
            if (trigger_number > 0) {
                event(OPMS_EVENT_STOP, OPMS_BOX_IDLE, trigger_number);
            }
        };
    }
    auto own_camera = std::make_unique<SceneCamera>();
    camera = own_camera.get();
    devices.source = std::move(own_camera);
    opms_camera_profile_t &profile = camera->given.profile;
    profile.has_frame_id = profile.has_camera_time = 1;
    profile.frame_id_bits = profile.camera_time_bits = 64;
    profile.camera_tick_hz = 1'000'000'000;
    profile.has_start_delay = profile.has_exposure = 1;
    profile.start_delay_ns = START_DELAY_NS;
    profile.exposure_ns = EXPOSURE_NS;
    camera->given.name = "scene";
    camera->given.can_trigger = with_box;
    options.mode = mode;
}

Scene::~Scene()
{
    session.reset();
}

void Scene::connect()
{
    std::string error;
    session = LiveSession::create(std::move(devices), options, tape_maker(tape), error);
    TEST_ASSERT_NOT_NULL_MESSAGE(session.get(), error.c_str());
    session->add_listener(&notes);
    TEST_ASSERT_TRUE_MESSAGE(session->connect(error), error.c_str());
    TEST_ASSERT_TRUE(eventually([this] { return session->status().camera_connected; }));
    go(2000);
}

void Scene::ping()
{
    if (!box) {
        return;
    }
    pinged_ns_ = clock->now_ns();
    opms_box_item_t item{};
    item.kind = OPMS_ITEM_PONG;
    item.t_host_ns = clock->now_ns();
    item.as.pong.t_sent_host_ns = clock->now_ns() - 400'000;
    item.as.pong.report.boot_id = box->boot_id;
    item.as.pong.report.report_number = ++report_number_;
    item.as.pong.report.received = box_time(box_ns() - 210'000);
    item.as.pong.report.sent = box_time(box_ns() - 190'000);
    box->put(item);
}

void Scene::go(std::int64_t ms)
{
    for (std::int64_t gone = 0; gone < ms; gone += 10) {
        clock->add(10 * MS);
        if (clock->now_ns() - pinged_ns_ >= PING_EVERY_NS && box && box->is_there) {
            ping();
        }
    }
}

void Scene::event(opms_event_kind_t kind, opms_box_state_t state, std::uint32_t argument)
{
    opms_box_item_t item{};
    item.kind = OPMS_ITEM_EVENT;
    item.t_host_ns = clock->now_ns();
    item.as.event.kind = kind;
    item.as.event.state = state;
    item.as.event.boot_id = box->boot_id;
    item.as.event.session_id = box->session_id;
    item.as.event.report_number = ++report_number_;
    item.as.event.time = box_time(kind == OPMS_EVENT_START ? start_edge_box_ns : box_ns());
    item.as.event.argument = argument;
    box->put(item);
}

void Scene::report_trigger(std::uint16_t flags, const Pulse &how)
{
    const std::int64_t t_ns = last_pulse_box_ns_;
    opms_box_item_t item{};
    item.t_host_ns = clock->now_ns() + REPORT_DELAY_NS;
    if (how.report) {
        item.kind = OPMS_ITEM_TRIGGER;
        opms_trigger_report_t &report = item.as.trigger;
        report.flags = flags;
        report.boot_id = box->boot_id;
        report.session_id = box->session_id;
        report.report_number = ++report_number_;
        report.trigger_number = trigger_number;
        report.time = box_time(t_ns);
        if (first_run_number != 0) {
            report.start_edge = box_time(start_edge_box_ns);
            report.first_run_number = first_run_number;
        }
    } else {
        ++report_number_;
    }
    if (how.history) {
        item.kind = OPMS_ITEM_HISTORY;
        item.as.history = {box->boot_id, box->session_id, {}};
        item.as.history.entry.number = trigger_number;
        item.as.history.entry.flags = flags;
        item.as.history.entry.time = box_time(t_ns);
    }
    if (item.kind != OPMS_ITEM_NONE) {
        box->put(item);
    }
}

void Scene::deliver(const Pulse &how)
{
    if (ids_start_anew) {
        ids_start_anew = false;
        frame_id = 1;
    }
    const std::uint64_t id = frame_id++;
    if (!how.frame) {
        return;
    }
    SourceItem item;
    item.kind = SourceItemKind::frame;
    auto frame = std::make_shared<Frame>(*small_frame(clock->now_ns() + FRAME_DELAY_NS));
    frame->frame_id = id;
    frame->camera_time_ticks = static_cast<std::uint64_t>(last_pulse_box_ns_ + 5'000'000 * MS);
    frame->flags = how.damaged ? OPMS_FRAME_DAMAGED : 0;
    item.frame = frame;
    ++frame_number;
    trigger_of_number[frame_number] = trigger_number;
    scan_time_of_number[frame_number] =
        last_pulse_box_ns_ + START_DELAY_NS + EXPOSURE_NS / 2 - start_edge_box_ns;
    camera->put(item);
}

void Scene::pulse(const Pulse &how)
{
    go(how.after_ms);
    ++trigger_number;
    last_pulse_box_ns_ = box_ns();
    report_trigger(first_run_number ? OPMS_TRIGGER_RUN : OPMS_TRIGGER_PREAMBLE, how);
    deliver(how);
    taken();
}

void Scene::pulses(int count)
{
    for (int i = 0; i < count; ++i) {
        pulse();
    }
}

void Scene::preamble()
{
    event(OPMS_EVENT_ARMED, OPMS_BOX_PREAMBLE, box->session_id);
    for (const int gap_ms : {100, 100, 200, 100, 300, 100}) {
        Pulse how;
        how.after_ms = gap_ms;
        pulse(how);
    }
    event(OPMS_EVENT_WAITING, OPMS_BOX_WAITING, 6);
    go(50);
    taken();
}

void Scene::press()
{
    start_edge_box_ns = box_ns();
    first_run_number = trigger_number + 1;
    event(OPMS_EVENT_START, OPMS_BOX_RUNNING, first_run_number);
}

void Scene::begin(bool record)
{
    ScanRequest request;
    request.name = "one";
    if (record) {
        request.recording = RecorderOptions();
    }
    trigger_number = first_run_number = 0;
    frame_number = 0;
    trigger_of_number.clear();
    scan_time_of_number.clear();
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(session->software_start(request, error), error.c_str());
    if (box) {
        preamble();
        press();
    }
}

bool Scene::stop(ScanEnd *end)
{
    std::atomic<bool> done{false};
    std::thread time([&] {
        while (!done) {
            clock->add(10 * MS);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    });
    std::string error;
    const bool is_well = session->software_stop(end, error);
    done = true;
    time.join();
    return is_well;
}

void Scene::taken() const
{
    TEST_ASSERT_TRUE(eventually(
        [this] { return (!box || box->all_taken()) && camera->all_taken(); }));
}

void Scene::link(opms_link_change_t change)
{
    opms_box_item_t item{};
    item.kind = OPMS_ITEM_LINK;
    item.t_host_ns = clock->now_ns();
    item.as.link.change = change;
    item.as.link.boot_id = box->boot_id;
    {
        const std::lock_guard<std::mutex> lock(box->mutex);
        box->is_there = change != OPMS_LINK_DISCONNECTED;
    }
    box->put(item);
}

void Scene::reboot()
{
    link(OPMS_LINK_DISCONNECTED);
    {
        const std::lock_guard<std::mutex> lock(box->mutex);
        ++box->boot_id;
    }
    report_number_ = 0;
    link(OPMS_LINK_CONNECTED);
    link(OPMS_LINK_REBOOTED);
}

void Scene::status(opms_box_state_t state)
{
    opms_box_item_t item{};
    item.kind = OPMS_ITEM_STATUS;
    item.t_host_ns = clock->now_ns();
    item.as.status.state = state;
    item.as.status.boot_id = box->boot_id;
    item.as.status.session_id = box->session_id;
    item.as.status.report_number = ++report_number_;
    item.as.status.trigger_number = trigger_number;
    item.as.status.first_run_number = first_run_number;
    box->put(item);
}

void Scene::camera_news(SourceItemKind kind)
{
    SourceItem item;
    item.kind = kind;
    item.t_host_ns = clock->now_ns();
    item.text = "by the test";
    camera->put(item);
}

void Scene::free_frame()
{
    go(100);
    SourceItem item;
    item.kind = SourceItemKind::frame;
    item.frame = small_frame(clock->now_ns());
    camera->put(item);
}

}  // namespace engine_scene
