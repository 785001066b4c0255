/* SPDX-License-Identifier: Apache-2.0 */
/* From the session's threads to the clients' outboxes: nothing waits, nothing is lost unsaid. */
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>
#include <unity.h>

#include "publish_queue.hpp"
#include "stream_hub.hpp"
#include "stream_outbox.hpp"

using namespace opms_host;
using Json = nlohmann::json;

void setUp(void)
{
}

void tearDown(void)
{
}

static std::shared_ptr<const PoseRecord> pose_of(std::uint64_t number)
{
    auto pose = std::make_shared<PoseRecord>();
    pose->number = number;
    return pose;
}

static StreamMessagePtr message(StreamKind kind, const std::string &text, StreamCounts lost = {})
{
    auto made = std::make_shared<StreamMessage>();
    made->kind = kind;
    made->text = text;
    made->lost = lost;
    return made;
}

static std::string popped(StreamOutbox &outbox)
{
    const auto text = outbox.pop();
    return text ? *text : "nothing";
}

static void test_a_full_queue_refuses_and_keeps_what_it_has(void)
{
    PublishQueue<int> queue(4);
    for (int round = 0; round < 3; round++) { /* over the ring's wrap */
        for (int i = 0; i < 4; i++) {
            int item = 10 * round + i;
            TEST_ASSERT_TRUE(queue.push(item));
        }
        int refused = 99, item = -1;
        TEST_ASSERT_FALSE(queue.push(refused));
        TEST_ASSERT_EQUAL_INT(99, refused);
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_TRUE(queue.pop(item));
            TEST_ASSERT_EQUAL_INT(10 * round + i, item);
        }
        TEST_ASSERT_FALSE(queue.pop(item));
    }
}

static void test_four_threads_publish_and_each_ones_order_is_kept(void)
{
    constexpr int THREADS = 4, EACH = 20000;
    PublishQueue<int> queue(64);
    std::atomic<int> refused{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < THREADS; t++) {
        threads.emplace_back([&queue, &refused, t] {
            for (int i = 0; i < EACH; i++) {
                int item = t * EACH + i;
                if (!queue.push(item)) {
                    ++refused;
                }
            }
        });
    }
    std::vector<int> last(THREADS, -1);
    int taken = 0;
    while (taken + refused < THREADS * EACH) {
        int item = 0;
        if (!queue.pop(item)) {
            std::this_thread::yield();
            continue;
        }
        ++taken;
        TEST_ASSERT_GREATER_THAN_INT(last[static_cast<std::size_t>(item / EACH)], item % EACH);
        last[static_cast<std::size_t>(item / EACH)] = item % EACH;
    }
    for (std::thread &thread : threads) {
        thread.join();
    }
    TEST_ASSERT_GREATER_THAN_INT(0, taken);
}

static void test_an_outbox_leaves_out_the_oldest_and_says_how_many(void)
{
    StreamOutbox outbox(3);
    for (int i = 0; i < 5; i++) {
        outbox.push(message(StreamKind::pose, "pose " + std::to_string(i)));
    }
    outbox.push(message(StreamKind::event, "event"));
    const Json missed = Json::parse(popped(outbox));
    TEST_ASSERT_EQUAL_STRING("opms.missed/1", missed["schema"].get<std::string>().c_str());
    TEST_ASSERT_EQUAL_INT(3, missed["missed"]["pose"].get<int>());
    TEST_ASSERT_EQUAL_INT(0, missed["missed"]["event"].get<int>());
    TEST_ASSERT_EQUAL_STRING("pose 3", popped(outbox).c_str());
    TEST_ASSERT_EQUAL_STRING("pose 4", popped(outbox).c_str());
    TEST_ASSERT_EQUAL_STRING("event", popped(outbox).c_str());
    TEST_ASSERT_EQUAL_STRING("nothing", popped(outbox).c_str());
    TEST_ASSERT_EQUAL_UINT64(3, outbox.missed_total()[0]);
}

static void test_what_the_hub_lost_is_missed_by_who_wanted_it(void)
{
    StreamOutbox outbox(3);
    StreamChoice choice;
    choice.kinds = {true, false, false};
    outbox.choose(choice);
    outbox.push(message(StreamKind::event, "not wanted", {7, 5, 3}));
    const Json missed = Json::parse(popped(outbox));
    TEST_ASSERT_EQUAL_INT(7, missed["missed"]["pose"].get<int>());
    TEST_ASSERT_EQUAL_INT(0, missed["missed"]["event"].get<int>());
    TEST_ASSERT_EQUAL_INT(0, missed["missed"]["state"].get<int>());
    TEST_ASSERT_EQUAL_STRING("nothing", popped(outbox).c_str());
}

static void test_a_reply_goes_first_and_is_never_left_out(void)
{
    StreamOutbox outbox(1);
    outbox.push_reply("reply");
    outbox.push(message(StreamKind::pose, "old"));
    outbox.push(message(StreamKind::pose, "new"));
    TEST_ASSERT_TRUE(outbox.has_replies());
    TEST_ASSERT_EQUAL_STRING("reply", popped(outbox).c_str());
    TEST_ASSERT_NOT_NULL(std::strstr(popped(outbox).c_str(), "missed"));
    TEST_ASSERT_EQUAL_STRING("new", popped(outbox).c_str());
}

/** Takes messages, or stalls until it is let go. */
class Receiver {
public:
    void take(const StreamMessagePtr &message)
    {
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, [this] { return !stalls_; });
        taken_.push_back(message);
        changed_.notify_all();
    }
    void stall(bool stalls)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stalls_ = stalls;
        changed_.notify_all();
    }
    /** Waits until a message satisfies @p is_last. */
    template <typename Test> std::vector<StreamMessagePtr> until(Test is_last)
    {
        std::unique_lock<std::mutex> lock(mutex_);
        const bool came = changed_.wait_for(lock, std::chrono::seconds(60), [this, &is_last] {
            return !taken_.empty() && is_last(*taken_.back());
        });
        TEST_ASSERT_TRUE_MESSAGE(came, "the last message never came");
        return taken_;
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<StreamMessagePtr> taken_;
    bool stalls_ = false;
};

static void test_all_kinds_reach_the_sink_in_order_as_json(void)
{
    StreamHub hub;
    Receiver receiver;
    hub.set_sink([&receiver](const StreamMessagePtr &m) { receiver.take(m); });
    SessionStatus status;
    status.state = SessionState::running;
    EventRecord event;
    event.code = "box.lost";
    event.text = std::string("bad \xff text");
    hub.on_pose(pose_of(1));
    hub.on_event(event);
    hub.on_pose(pose_of(2));
    hub.on_state(status);
    const auto taken =
        receiver.until([](const StreamMessage &m) { return m.kind == StreamKind::state; });
    TEST_ASSERT_EQUAL_INT(4, static_cast<int>(taken.size()));
    TEST_ASSERT_EQUAL_INT(1, Json::parse(taken[0]->text)["picture"].get<int>());
    TEST_ASSERT_EQUAL_STRING("box.lost",
                             Json::parse(taken[1]->text)["code"].get<std::string>().c_str());
    TEST_ASSERT_EQUAL_INT(2, Json::parse(taken[2]->text)["picture"].get<int>());
    TEST_ASSERT_EQUAL_STRING("running",
                             Json::parse(taken[3]->text)["state"].get<std::string>().c_str());
    TEST_ASSERT_EQUAL_UINT64(2, hub.newest_pose()->number);
    TEST_ASSERT_TRUE(taken[0]->text_squares.empty());
    hub.want_squares(1);
    hub.on_pose(pose_of(3));
    const auto more =
        receiver.until([](const StreamMessage &m) { return !m.text_squares.empty(); });
    TEST_ASSERT_TRUE(Json::parse(more.back()->text_squares).contains("squares"));
}

/* The sink stands still all the time that 10,000 poses are published: every call returns, since
 * the calling thread gets to the end of the loop; a call that waited would never return. */
static void test_publishing_goes_on_while_the_sink_stands_still(void)
{
    constexpr std::uint64_t POSES = 10000;
    StreamHub hub(1024);
    Receiver receiver;
    receiver.stall(true);
    hub.set_sink([&receiver](const StreamMessagePtr &m) { receiver.take(m); });
    std::uint64_t returned = 0;
    for (std::uint64_t i = 1; i <= POSES; i++) {
        hub.on_pose(pose_of(i));
        ++returned;
    }
    TEST_ASSERT_EQUAL_UINT64(POSES, returned);
    TEST_ASSERT_EQUAL_UINT64(POSES, hub.published()[0]);
    const std::uint64_t lost = hub.lost()[0];
    TEST_ASSERT_GREATER_OR_EQUAL_UINT64(POSES - 1024 - 1, lost);
    receiver.stall(false);
    while (hub.published()[1] == hub.lost()[1]) { /* until one finds a place again */
        hub.on_event(EventRecord());
        std::this_thread::yield();
    }
    const auto taken =
        receiver.until([](const StreamMessage &m) { return m.kind == StreamKind::event; });
    std::uint64_t told = 0, poses = 0;
    for (const StreamMessagePtr &m : taken) {
        told += m->lost[0];
        poses += m->kind == StreamKind::pose ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_UINT64(lost, told); /* each pose came, or is counted as missed */
    TEST_ASSERT_EQUAL_UINT64(POSES, poses + told);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_full_queue_refuses_and_keeps_what_it_has);
    RUN_TEST(test_four_threads_publish_and_each_ones_order_is_kept);
    RUN_TEST(test_an_outbox_leaves_out_the_oldest_and_says_how_many);
    RUN_TEST(test_what_the_hub_lost_is_missed_by_who_wanted_it);
    RUN_TEST(test_a_reply_goes_first_and_is_never_left_out);
    RUN_TEST(test_all_kinds_reach_the_sink_in_order_as_json);
    RUN_TEST(test_publishing_goes_on_while_the_sink_stands_still);
    return UNITY_END();
}
