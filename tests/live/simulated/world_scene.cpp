/* SPDX-License-Identifier: Apache-2.0 */
#include "world_scene.hpp"

#include <algorithm>
#include <cstdlib>

#include <unity.h>

using namespace opms_host;

WorldOptions scene_options(const std::string &text)
{
    WorldOptions options;
    options.speed = 0;
    options.pictures = PictureMode::blank;
    TEST_ASSERT_EQUAL_STRING("", simulated_options_parse(text, options).c_str());
    return options;
}

WorldScene::WorldScene(const WorldOptions &options)
{
    std::string error;
    world_ = SimulatedWorld::create(options, error);
    TEST_ASSERT_EQUAL_STRING("", error.c_str());
    box_ = world_->make_box();
    source_ = world_->make_source();
}

void WorldScene::start_source(std::uint32_t buffers)
{
    SourceStart start;
    start.buffers = buffers;
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(source_->start(start, error), error.c_str());
}

void WorldScene::take_all()
{
    opms_box_item_t item;
    for (box_->poll(0, item); item.kind != OPMS_ITEM_NONE; box_->poll(0, item)) {
        items.push_back(item);
        if (listener_.on_item) {
            listener_.on_item(item);
        }
    }
    SourceItem news;
    for (source_->wait(0, news); news.kind != SourceItemKind::none; source_->wait(0, news)) {
        if (listener_.on_source) {
            listener_.on_source(news);
        }
        if (news.frame) {
            frames.push_back(*news.frame);
            frames.back().memory.reset();
            frames.back().image.pixels = nullptr;
            news.frame.reset();
        }
        source_items.push_back(news);
    }
}

void WorldScene::run_for(double seconds)
{
    const std::int64_t end = now_ns() + static_cast<std::int64_t>(seconds * 1e9);
    for (bool goes_on = true; goes_on;) {
        goes_on = world_->step(end);
        take_all();
        if (listener_.on_time) {
            listener_.on_time(now_ns());
        }
    }
    TEST_ASSERT_EQUAL_INT64(end, now_ns());
}

std::vector<opms_box_item_t> WorldScene::of_kind(opms_item_kind_t kind) const
{
    std::vector<opms_box_item_t> found;
    std::copy_if(items.begin(), items.end(), std::back_inserter(found),
                 [kind](const opms_box_item_t &item) { return item.kind == kind; });
    return found;
}

std::vector<opms_event_report_t> WorldScene::events(opms_event_kind_t kind) const
{
    std::vector<opms_event_report_t> found;
    for (const opms_box_item_t &item : items) {
        if (item.kind == OPMS_ITEM_EVENT && item.as.event.kind == kind) {
            found.push_back(item.as.event);
        }
    }
    return found;
}

PairedScene::PairedScene(const WorldOptions &options) : scene_(options)
{
    opms_pair_options_t pair;
    opms_pair_options_init(&pair);
    pair.camera = scene_.world().camera_profile();
    opms_error_t error = {};
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_pairer_create(&pair, &pairer_, &error), error.message);
    scene_.start_source();
    SceneListener listener;
    listener.on_item = [this](const opms_box_item_t &item) { push(item); };
    listener.on_source = [this](const SourceItem &item) { push(item); };
    listener.on_time = [this](std::int64_t now) { poll(now); };
    scene_.listen(listener);
}

PairedScene::~PairedScene()
{
    opms_pairer_destroy(pairer_);
}

void PairedScene::session(std::uint32_t session_id, double seconds)
{
    std::string text;
    scene_.run_for(3);
    opms_identity_report_t identity = {};
    opms_settings_report_t settings = {};
    TEST_ASSERT_TRUE(scene_.box().identity(identity));
    TEST_ASSERT_TRUE(scene_.box().settings(settings, text));
    TEST_ASSERT_TRUE_MESSAGE(scene_.box().arm(session_id, text), text.c_str());
    opms_error_t error = {};
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK,
                              opms_pairer_open(pairer_, identity.boot_id, session_id,
                                               &settings.settings, &error),
                              error.message);
    is_open_ = true;
    scene_.run_for(2);
    TEST_ASSERT_TRUE_MESSAGE(scene_.box().press_start(text), text.c_str());
    scene_.run_for(seconds);
    while (!scene_.box().disarm(text)) {
        scene_.run_for(1);  // it is unplugged
    }
    scene_.run_for(10);
    close();
}

void PairedScene::close()
{
    opms_error_t error = {};
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_pairer_close(pairer_, &error), error.message);
    is_open_ = false;
    poll(scene_.now_ns());
}

void PairedScene::push(const opms_box_item_t &item)
{
    opms_status_t status = OPMS_OK;
    switch (item.kind) {
    case OPMS_ITEM_TRIGGER:
        status = opms_pairer_push_trigger(pairer_, &item.as.trigger, item.t_host_ns, nullptr);
        break;
    case OPMS_ITEM_PONG:
        status = opms_pairer_push_pong(pairer_, item.as.pong.t_sent_host_ns, &item.as.pong.report,
                                       item.t_host_ns, nullptr);
        break;
    case OPMS_ITEM_STATUS:
        status = opms_pairer_push_status(pairer_, &item.as.status, nullptr);
        break;
    case OPMS_ITEM_EVENT:
        status = opms_pairer_push_event(pairer_, &item.as.event, nullptr);
        break;
    case OPMS_ITEM_HISTORY: {
        opms_history_report_t history = {};
        history.token = 1;
        history.boot_id = item.as.history.boot_id;
        history.session_id = item.as.history.session_id;
        history.count = 1;
        history.entries[0] = item.as.history.entry;
        status = opms_pairer_push_history(pairer_, &history, nullptr);
        break;
    }
    default: break;
    }
    TEST_ASSERT_EQUAL(OPMS_OK, status);
}

void PairedScene::push(const SourceItem &item)
{
    if (item.kind != SourceItemKind::frame) {
        return;
    }
    opms_frame_t frame = {};
    frame.frame_id = item.frame->frame_id;
    frame.camera_time_ticks = item.frame->camera_time_ticks;
    frame.arrival_host_ns = item.frame->arrival_host_ns;
    frame.flags = item.frame->flags;
    frame.tag = ++tag_;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_push_frame(pairer_, &frame, nullptr));
}

void PairedScene::poll(std::int64_t now_ns)
{
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_advance(pairer_, now_ns, nullptr));
    opms_pair_result_t results[64];
    std::uint32_t count = 0;
    do {
        TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_poll(pairer_, results, 64, &count, nullptr));
        for (std::uint32_t i = 0; i < count; ++i) {
            frame_results += results[i].frame_state != OPMS_FRAME_NONE ? 1 : 0;
            if (results[i].frame_state == OPMS_FRAME_PAIRED) {
                judge(results[i]);
            }
        }
    } while (count > 0);
}

void PairedScene::judge(const opms_pair_result_t &result)
{
    const TrueFrame truth = scene_.world().true_frame(result.frame.tag - 1);
    ++paired;
    TEST_ASSERT_EQUAL_INT64(truth.arrival_host_ns, result.frame.arrival_host_ns);
    if (truth.trigger_number != result.trigger_number || truth.boot_id != result.boot_id ||
        truth.session_id != result.session_id) {
        ++wrong;
        return;
    }
    constexpr std::uint32_t NEEDED = OPMS_PAIR_HAS_START_EDGE | OPMS_PAIR_HAS_MID_EXPOSURE;
    std::int64_t scan_ns = 0;
    if ((result.known & NEEDED) == NEEDED && scene_.world().true_scan_time(truth, scan_ns)) {
        const std::int64_t told = result.mid_exposure_box_ns - result.start_edge_box_ns;
        worst_time_ns = std::max<std::int64_t>(worst_time_ns, std::llabs(told - scan_ns));
    }
}

opms_pair_summary_t PairedScene::summary() const
{
    opms_pair_summary_t summary;
    opms_pairer_summary(pairer_, &summary);
    return summary;
}
