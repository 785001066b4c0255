/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated camera on the wires of the emulated box: the real firmware's pulses and strobes,
 * judged by the emulator's clock. Needs OPMS_BOX_PORT and OPMS_WIRES_PORT. */
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <opms/hid.h>
#include <opms/pair.h>
#include <unity.h>

#include "simulated_factory.hpp"

using namespace opms_host;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

static constexpr std::uint32_t SESSION = 41;
static constexpr double PATIENCE_S = 60;

static std::uint16_t port_of(const char *name)
{
    const char *const text = std::getenv(name);
    TEST_ASSERT_NOT_NULL_MESSAGE(text, name);
    return static_cast<std::uint16_t>(std::atoi(text));
}

/** The box, the camera and what is made of both. */
struct Bench {
    opms_box_t *box = nullptr;
    Devices devices;
    opms_pairer_t *pairer = nullptr;
    opms_box_state_t state = OPMS_BOX_IDLE;
    std::uint32_t triggers = 0, stops = 0, pongs = 0;
    std::map<std::uint32_t, std::int64_t> trigger_ns; /**< of the box, by number */
    std::map<std::uint32_t, opms_trigger_report_t> strobes; /**< the report that tells of it */
    std::vector<Frame> frames;
    std::vector<opms_pair_result_t> results;
};

static void take_item(Bench &bench, const opms_box_item_t &item)
{
    switch (item.kind) {
    case OPMS_ITEM_TRIGGER:
        bench.triggers = std::max(bench.triggers, item.as.trigger.trigger_number);
        bench.trigger_ns[item.as.trigger.trigger_number] = opms_box_time_ns(item.as.trigger.time);
        bench.strobes[item.as.trigger.strobe_for_trigger] = item.as.trigger;
        opms_pairer_push_trigger(bench.pairer, &item.as.trigger, item.t_host_ns, nullptr);
        break;
    case OPMS_ITEM_PONG:
        ++bench.pongs;
        opms_pairer_push_pong(bench.pairer, item.as.pong.t_sent_host_ns, &item.as.pong.report,
                              item.t_host_ns, nullptr);
        break;
    case OPMS_ITEM_STATUS:
        opms_pairer_push_status(bench.pairer, &item.as.status, nullptr);
        break;
    case OPMS_ITEM_EVENT:
        bench.state = item.as.event.state;
        bench.stops += item.as.event.kind == OPMS_EVENT_STOP ? 1 : 0;
        opms_pairer_push_event(bench.pairer, &item.as.event, nullptr);
        break;
    default: break;
    }
}

static void take_frame(Bench &bench, const SourceItem &item)
{
    if (item.frame) {
        opms_frame_t frame = {};
        frame.frame_id = item.frame->frame_id;
        frame.camera_time_ticks = item.frame->camera_time_ticks;
        frame.arrival_host_ns = item.frame->arrival_host_ns;
        frame.tag = bench.frames.size();
        bench.frames.push_back(*item.frame);
        bench.frames.back().memory.reset();
        TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_push_frame(bench.pairer, &frame, nullptr));
    }
}

/** Take what comes until it is enough. */
template <typename Enough> static void run_until(Bench &bench, const char *what, Enough enough)
{
    const auto begin = std::chrono::steady_clock::now();
    while (!enough()) {
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
        TEST_ASSERT_TRUE_MESSAGE(passed.count() < PATIENCE_S, what);
        opms_box_item_t item;
        SourceItem news;
        opms_box_poll(bench.box, 5, &item, nullptr);
        take_item(bench, item);
        bench.devices.source->wait(5, news);
        take_frame(bench, news);
        opms_pairer_advance(bench.pairer, bench.devices.clock->now_ns(), nullptr);
        opms_pair_result_t results[16];
        std::uint32_t count = 0;
        opms_pairer_poll(bench.pairer, results, 16, &count, nullptr);
        bench.results.insert(bench.results.end(), results, results + count);
    }
}

static void open_bench(Bench &bench)
{
    opms_error_t error = {};
    opms_box_options_t place;
    opms_box_options_init(&place);
    place.transport = OPMS_BOX_EMULATED;
    place.emulated_port = port_of("OPMS_BOX_PORT");
    place.open_timeout_ms = 30000;
    place.ping_interval_ms = 100;
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_box_open(&place, &bench.box, &error), error.message);
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.strobe_enabled = true;
    TEST_ASSERT_EQUAL_MESSAGE(
        OPMS_OK, opms_box_set_settings(bench.box, &settings, 20000, nullptr, &error),
        error.message);

    SimulatedRequest request;
    request.source_options = "pictures=blank,camera_drift_ppm=0,exposure_us=1500,wires=" +
                             std::to_string(port_of("OPMS_WIRES_PORT"));
    OpenError problem;
    TEST_ASSERT_TRUE_MESSAGE(simulated_devices(request, bench.devices, problem),
                             problem.text.c_str());
    std::string text;
    TEST_ASSERT_TRUE_MESSAGE(bench.devices.source->start(SourceStart(), text), text.c_str());

    opms_pair_options_t options;
    opms_pair_options_init(&options);
    options.camera = bench.devices.source->traits().profile;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_create(&options, &bench.pairer, nullptr));
    opms_identity_report_t identity;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_box_get_identity(bench.box, &identity, nullptr, nullptr));
    run_until(bench, "pongs", [&] { return bench.pongs >= 12; });
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_box_arm(bench.box, SESSION, 20000, &error),
                              error.message);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_open(bench.pairer, identity.boot_id, SESSION,
                                                &settings, nullptr));
}

/** The camera's stamps are of the emulator's clock: exposure n, as the box saw it, and frame n
 * differ by the same everywhere. The pairer needs a punctual machine and may be unsure, but never
 * wrong. */
static void judge(const Bench &bench)
{
    std::vector<std::int64_t> differences;
    for (const auto &strobe : bench.strobes) {
        if (strobe.first == 0) {
            continue;  // before the first exposure
        }
        const std::int64_t delay_ns = strobe.second.strobe_delay_cycles * 8;
        TEST_ASSERT_INT64_WITHIN(100, 30000, delay_ns);
        TEST_ASSERT_INT64_WITHIN(100, 1500000, strobe.second.strobe_length_cycles * 8);
        TEST_ASSERT_TRUE(strobe.first <= bench.frames.size());
        const auto stamp =
            static_cast<std::int64_t>(bench.frames[strobe.first - 1].camera_time_ticks);
        differences.push_back(bench.trigger_ns.at(strobe.first) + delay_ns - stamp);
    }
    TEST_ASSERT_GREATER_THAN(25, differences.size());
    TEST_ASSERT_EQUAL(bench.trigger_ns.size(), bench.frames.size());
    const auto ends = std::minmax_element(differences.begin(), differences.end());
    TEST_ASSERT_TRUE(*ends.second - *ends.first <= 200);
    for (const opms_pair_result_t &result : bench.results) {
        if (result.frame_state == OPMS_FRAME_PAIRED) {
            TEST_ASSERT_EQUAL_UINT64(result.frame.tag + 1, result.trigger_number);
        }
    }
}

static void test_the_firmwares_pulses_expose_and_their_strobes_come_back_to_it(void)
{
    Bench bench;
    open_bench(bench);
    run_until(bench, "WAITING", [&] { return bench.state == OPMS_BOX_WAITING; });
    TEST_ASSERT_EQUAL(OPMS_OK, opms_box_emulate_line(bench.box, OPMS_EMULATED_START, true, 1000,
                                                     nullptr));
    run_until(bench, "30 triggers", [&] { return bench.triggers >= 30; });
    TEST_ASSERT_EQUAL(OPMS_OK, opms_box_disarm(bench.box, 20000, nullptr));
    run_until(bench, "STOP", [&] { return bench.stops > 0; });
    run_until(bench, "the last frames",
              [&] { return bench.frames.size() >= bench.trigger_ns.size(); });
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_close(bench.pairer, nullptr));
    run_until(bench, "results", [&] {
        opms_pair_summary_t summary;
        opms_pairer_summary(bench.pairer, &summary);
        return bench.results.size() >= summary.counters.triggers;
    });
    judge(bench);
    bench.devices.source->stop();
    opms_pairer_destroy(bench.pairer);
    opms_box_close(bench.box);
}

static void test_a_camera_that_sends_nonsense_is_cut_off_and_the_next_one_is_served(void)
{
    const int raw = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_of("OPMS_WIRES_PORT"));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    TEST_ASSERT_EQUAL(0, connect(raw, reinterpret_cast<sockaddr *>(&address), sizeof address));
    const char nonsense[] = "no message of any kind";
    TEST_ASSERT_EQUAL(sizeof nonsense, send(raw, nonsense, sizeof nonsense, MSG_NOSIGNAL));
    char answer = 0;
    TEST_ASSERT_TRUE(recv(raw, &answer, 1, 0) <= 0);
    close(raw);

    SimulatedRequest request;
    request.source_options =
        "pictures=blank,wires=" + std::to_string(port_of("OPMS_WIRES_PORT"));
    Devices devices;
    OpenError problem;
    std::string text;
    TEST_ASSERT_TRUE(simulated_devices(request, devices, problem));
    TEST_ASSERT_TRUE_MESSAGE(devices.source->start(SourceStart(), text), text.c_str());
    SourceStart free_running;
    free_running.hardware_trigger = false;
    devices.source->stop();
    TEST_ASSERT_FALSE(devices.source->start(free_running, text));
}

static void test_a_port_without_wires_is_told(void)
{
    SimulatedRequest request;
    request.source_options = "pictures=blank,wires=1";
    Devices devices;
    OpenError problem;
    TEST_ASSERT_TRUE(simulated_devices(request, devices, problem));
    std::string text;
    TEST_ASSERT_FALSE(devices.source->start(SourceStart(), text));
    TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(text.c_str(), "--wires 1"), text.c_str());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_firmwares_pulses_expose_and_their_strobes_come_back_to_it);
    RUN_TEST(test_a_camera_that_sends_nonsense_is_cut_off_and_the_next_one_is_served);
    RUN_TEST(test_a_port_without_wires_is_told);
    return UNITY_END();
}
