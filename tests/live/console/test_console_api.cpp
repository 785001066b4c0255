/* SPDX-License-Identifier: Apache-2.0 */
/* The interface as a function from requests to responses, over a session that is a double. */
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>
#include <unity.h>

#include "api_handler.hpp"
#include "fake_control.hpp"
#include "json_limits.hpp"

using namespace opms_host;
using Json = nlohmann::json;

static const std::string TOKEN = "0123456789abcdefghij";

/** The interface over a double, as a loopback server has it. */
struct Bench {
    FakeControl control;
    std::shared_ptr<const PoseRecord> pose;
    ApiHandler api{{control, {TOKEN, {}}, [this] { return pose; }}};

    HttpRequest request(const std::string &method, const std::string &target,
                        const std::string &body = "") const
    {
        HttpRequest made;
        made.method = method;
        made.target = target;
        made.headers = {{"Host", "127.0.0.1:47660"}, {"Authorization", "Bearer " + TOKEN}};
        made.body = body;
        if (!body.empty()) {
            made.headers.push_back({"Content-Type", "application/json"});
            made.headers.push_back({"Content-Length", std::to_string(body.size())});
        }
        return made;
    }
    HttpResponse call(const std::string &method, const std::string &target,
                      const std::string &body = "") const
    {
        return api.handle(request(method, target, body));
    }
};

void setUp(void)
{
}

void tearDown(void)
{
}

static Json body_of(const HttpResponse &response)
{
    return Json::parse(response.body);
}

static void assert_error(int status, const char *code, const HttpResponse &response)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(status, response.status, response.body.c_str());
    const Json body = body_of(response);
    TEST_ASSERT_EQUAL_STRING(code, body["error"]["code"].get<std::string>().c_str());
    TEST_ASSERT_FALSE(body["error"]["message"].get<std::string>().empty());
}

static std::string replaced_header(HttpRequest &request, const std::string &name,
                                   const std::string &value)
{
    for (HttpHeader &header : request.headers) {
        if (header.name == name) {
            return std::exchange(header.value, value);
        }
    }
    request.headers.push_back({name, value});
    return "";
}

static void test_a_scan_is_started_under_the_masters_name_and_stopped(void)
{
    Bench bench;
    const HttpResponse started = bench.call("POST", "/api/v1/scan", R"({"name":"lane 3"})");
    TEST_ASSERT_EQUAL_INT(201, started.status);
    TEST_ASSERT_EQUAL_STRING("lane 3", body_of(started)["scan"].get<std::string>().c_str());
    assert_error(409, "state", bench.call("POST", "/api/v1/scan"));
    TEST_ASSERT_EQUAL_STRING(
        "ready", body_of(bench.call("GET", "/api/v1/state"))["state"].get<std::string>().c_str());
    TEST_ASSERT_EQUAL_INT(202, bench.call("POST", "/api/v1/start").status);
    assert_error(409, "state", bench.call("POST", "/api/v1/start"));
    const HttpResponse stopped = bench.call("POST", "/api/v1/scan/stop");
    TEST_ASSERT_EQUAL_INT(200, stopped.status);
    TEST_ASSERT_EQUAL_STRING("2027-01-15T08:00:00.250Z",
                             body_of(stopped)["ended"].get<std::string>().c_str());
    assert_error(409, "state", bench.call("DELETE", "/api/v1/scan"));
}

static void test_a_scan_without_a_name_gets_one(void)
{
    Bench bench;
    TEST_ASSERT_EQUAL_INT(201, bench.call("POST", "/api/v1/scan", "{}").status);
    TEST_ASSERT_EQUAL_INT(200, bench.call("DELETE", "/api/v1/scan").status);
    TEST_ASSERT_EQUAL_INT(201, bench.call("POST", "/api/v1/scan").status);
}

static void test_names_that_could_leave_the_folder_are_refused(void)
{
    Bench bench;
    for (const char *name : {"", "..", ".hidden", "a/b", "a\\b", "a.", "a ", "\xc3\xa4", "a\nb"}) {
        const std::string body = Json{{"name", name}}.dump();
        assert_error(422, "value", bench.call("POST", "/api/v1/scan", body));
    }
    assert_error(422, "value",
                 bench.call("POST", "/api/v1/scan", Json{{"name", std::string(101, 'a')}}.dump()));
    for (const char *target : {"/api/v1/scans/..", "/api/v1/scans/%2e%2e", "/api/v1/scans/..%2fa",
                               "/api/v1/scans/%2fetc"}) {
        assert_error(404, "name", bench.call("GET", target));
        TEST_ASSERT_EQUAL_STRING("", bench.control.asked_for.c_str());
    }
}

static void test_recorded_scans_are_listed_and_found_by_name(void)
{
    Bench bench;
    const Json all = body_of(bench.call("GET", "/api/v1/scans"));
    TEST_ASSERT_EQUAL_INT(1, static_cast<int>(all["scans"].size()));
    TEST_ASSERT_EQUAL_STRING("broken: no scan.sqlite",
                             all["unreadable"][0].get<std::string>().c_str());
    const Json one = body_of(bench.call("GET", "/api/v1/scans/lane%203"));
    TEST_ASSERT_EQUAL_INT(41, one["poses"].get<int>());
    TEST_ASSERT_TRUE(one["ended"].is_null());
    assert_error(404, "name", bench.call("GET", "/api/v1/scans/lane4"));
    assert_error(404, "path", bench.call("GET", "/api/v1/scans/"));
    assert_error(400, "target", bench.call("GET", "/api/v1/scans/a%zz"));
}

static void test_nobody_enters_without_the_token(void)
{
    Bench bench;
    HttpRequest request = bench.request("GET", "/api/v1/state");
    request.headers.pop_back();
    assert_error(401, "token", bench.api.handle(request));
    for (const std::string &value :
         {"Bearer " + TOKEN + "x", "Bearer " + TOKEN.substr(1), std::string("Bearer "),
          std::string("Basic ") + TOKEN, TOKEN, std::string("Bearer  ") + TOKEN}) {
        request = bench.request("GET", "/api/v1/state");
        replaced_header(request, "Authorization", value);
        assert_error(401, "token", bench.api.handle(request));
    }
    request = bench.request("GET", "/api/v1/state");
    request.headers.push_back({"authorization", "Bearer " + TOKEN});
    assert_error(401, "token", bench.api.handle(request));
    request = bench.request("GET", "/api/v1/nothing");
    replaced_header(request, "Authorization", "Bearer wrong");
    assert_error(401, "token", bench.api.handle(request)); /* nor learns what is there */
}

static void test_a_browsers_token_comes_as_a_subprotocol_of_the_stream_alone(void)
{
    Bench bench;
    HttpRequest request = bench.request("GET", "/api/v1/stream?kinds=pose,event");
    request.headers.pop_back();
    request.headers.push_back({"Sec-WebSocket-Protocol", "opms.v1, opms.token." + TOKEN});
    assert_error(401, "token", bench.api.handle(request));
    request.upgrade = true;
    TEST_ASSERT_FALSE(bench.api.refusal(request).has_value());
    TEST_ASSERT_TRUE(offers_subprotocol(request));
    replaced_header(request, "Sec-WebSocket-Protocol", "opms.v1, opms.token.wrong");
    TEST_ASSERT_EQUAL_INT(401, bench.api.refusal(request)->status);
}

static void test_pages_of_other_origins_and_borrowed_names_are_refused(void)
{
    Bench bench;
    for (const char *host : {"evil.example", "evil.example:47660", "127.0.0.1.evil.example", ""}) {
        HttpRequest request = bench.request("GET", "/api/v1/state");
        replaced_header(request, "Host", host);
        assert_error(403, "host", bench.api.handle(request));
    }
    for (const char *host : {"localhost", "LOCALHOST:47660", "[::1]:47660", "127.0.0.1"}) {
        HttpRequest request = bench.request("GET", "/api/v1/state");
        replaced_header(request, "Host", host);
        TEST_ASSERT_EQUAL_INT(200, bench.api.handle(request).status);
    }
    for (const char *origin : {"http://evil.example", "null", "https://127.0.0.1:47660",
                               "http://127.0.0.1:1", ""}) {
        HttpRequest request = bench.request("GET", "/api/v1/state");
        request.headers.push_back({"Origin", origin});
        assert_error(403, "origin", bench.api.handle(request));
    }
    HttpRequest request = bench.request("GET", "/api/v1/state");
    request.headers.push_back({"Origin", "http://127.0.0.1:47660"});
    TEST_ASSERT_EQUAL_INT(200, bench.api.handle(request).status);
    request.headers.push_back({"Sec-Fetch-Site", "cross-site"});
    assert_error(403, "origin", bench.api.handle(request));
    request = bench.request("GET", "/api/v1/state");
    request.headers.erase(request.headers.begin());
    assert_error(400, "host", bench.api.handle(request));
}

static void test_bodies_are_refused_by_kind_length_depth_and_form(void)
{
    Bench bench;
    HttpRequest request = bench.request("POST", "/api/v1/samples", "{}");
    replaced_header(request, "Content-Type", "text/plain");
    assert_error(415, "content-type", bench.api.handle(request));
    replaced_header(request, "Content-Type", "application/json; charset=utf-8");
    assert_error(422, "value", bench.api.handle(request));
    assert_error(411, "length", bench.call("POST", "/api/v1/samples"));
    assert_error(400, "json", bench.call("POST", "/api/v1/samples", "{"));
    assert_error(400, "json", bench.call("POST", "/api/v1/samples", "\"\xff\""));
    assert_error(400, "json", bench.call("POST", "/api/v1/samples", R"({"values":[1e999]})"));
    assert_error(400, "json", bench.call("POST", "/api/v1/samples",
                                         std::string(500000, '[') + std::string(500000, ']')));
    assert_error(400, "json", bench.call("POST", "/api/v1/samples", std::string(17, '[')));
    assert_error(413, "size",
                 bench.call("POST", "/api/v1/samples", std::string(HTTP_BODY_BYTES_MAX + 1, ' ')));
    assert_error(400, "body", bench.call("POST", "/api/v1/start", "{}"));
    assert_error(405, "method", bench.call("PUT", "/api/v1/scan"));
    assert_error(426, "upgrade", bench.call("GET", "/api/v1/stream"));
    for (const char *target : {"", "*", "http://a/api/v1/state", "/api/v1/state?%00=1"}) {
        assert_error(400, "target", bench.call("GET", target));
    }
    for (const char *target : {"/", "/api/v1", "/api/v1/", "/api/v2/state", "/api/v1/state/"}) {
        assert_error(404, "path", bench.call("GET", target));
    }
}

static void test_a_wrong_method_is_told_the_right_ones(void)
{
    Bench bench;
    const HttpResponse response = bench.call("GET", "/api/v1/scan");
    assert_error(405, "method", response);
    TEST_ASSERT_EQUAL_STRING("Allow", response.headers.at(0).name.c_str());
    TEST_ASSERT_EQUAL_STRING("POST, DELETE", response.headers.at(0).value.c_str());
}

static void test_samples_get_their_time_by_what_they_say(void)
{
    Bench bench;
    const char *three = R"([
        {"sensor":"md","t_scan_s":1.25,"t_bound_s":0.001,"number":7,"values":[1,-2.5]},
        {"sensor":"md","t_unix_s":1799999999.5,"values":[3]},
        {"sensor":"gpr","data":{"trace":"a.sgy"}}])";
    assert_error(409, "state", bench.call("POST", "/api/v1/samples", three));
    bench.call("POST", "/api/v1/scan");
    const HttpResponse response = bench.call("POST", "/api/v1/samples", three);
    TEST_ASSERT_EQUAL_INT(202, response.status);
    TEST_ASSERT_EQUAL_INT(3, body_of(response)["samples"].get<int>());
    const SensorRecord &by_scan = bench.control.samples[0];
    TEST_ASSERT_TRUE(by_scan.has_time);
    TEST_ASSERT_EQUAL_INT64(1'250'000'000, by_scan.t_scan_ns);
    TEST_ASSERT_EQUAL_INT64(1'000'000, by_scan.t_bound_ns);
    TEST_ASSERT_EQUAL_UINT64(7, by_scan.number);
    TEST_ASSERT_EQUAL_DOUBLE(-2.5, by_scan.values[1]);
    const SensorRecord &by_world = bench.control.samples[1];
    TEST_ASSERT_FALSE(by_world.has_time); /* half a second before now, on the host's clock */
    TEST_ASSERT_EQUAL_INT64(4'500'000'000, by_world.arrival_host_ns);
    TEST_ASSERT_EQUAL_INT64(5'000'000'000, bench.control.samples[2].arrival_host_ns);
    TEST_ASSERT_EQUAL_STRING(R"({"trace":"a.sgy"})", bench.control.samples[2].data_json.c_str());
}

static void test_one_wrong_sample_keeps_all_of_them_out(void)
{
    Bench bench;
    bench.call("POST", "/api/v1/scan");
    for (const char *wrong :
         {R"({"sensor":"a b","values":[1]})", R"({"values":[1]})", R"({"sensor":"md"})",
          R"({"sensor":"md","values":["1"]})", R"({"sensor":"md","values":[null]})",
          R"({"sensor":"md","values":1})",
          R"({"sensor":"md","values":[1],"t_scan_s":1,"t_unix_s":2})",
          R"({"sensor":"md","values":[1],"t_scan_s":1e8})",
          R"({"sensor":"md","values":[1],"t_unix_s":-1})",
          R"({"sensor":"md","values":[1],"t_bound_s":-1})",
          R"({"sensor":"md","values":[1],"number":-1})",
          R"({"sensor":"md","values":[1],"number":1.5})",
          R"({"sensor":"md","values":[1],"data":[]})",
          R"({"sensor":"md","values":[1],"time":3})", "[]", "7", "null"}) {
        const std::string good = R"({"sensor":"md","values":[1]})";
        const bool is_sample = wrong[0] == '{';
        const std::string body = is_sample ? "[" + good + "," + wrong + "]" : wrong;
        const HttpResponse response = bench.call("POST", "/api/v1/samples", body);
        assert_error(422, "value", response);
        if (is_sample) {
            TEST_ASSERT_NOT_NULL(std::strstr(response.body.c_str(), "sample 1: "));
        }
        TEST_ASSERT_EQUAL_INT(0, static_cast<int>(bench.control.samples.size()));
    }
}

static void test_the_newest_pose_has_no_number_that_json_lacks(void)
{
    Bench bench;
    assert_error(404, "none-yet", bench.call("GET", "/api/v1/pose"));
    auto pose = std::make_shared<PoseRecord>();
    pose->number = 12;
    pose->blur_px = {std::nan(""), 1.5};
    bench.pose = pose;
    const HttpResponse response = bench.call("GET", "/api/v1/pose?squares=1");
    TEST_ASSERT_EQUAL_INT(200, response.status);
    const Json body = body_of(response);
    TEST_ASSERT_EQUAL_INT(12, body["picture"].get<int>());
    TEST_ASSERT_TRUE(body["blur"]["px"][0].is_null());
    TEST_ASSERT_TRUE(body["t_scan_s"].is_null());
    TEST_ASSERT_TRUE(body.contains("squares"));
    assert_error(400, "query", bench.call("GET", "/api/v1/pose?squares=yes"));
}

static void test_the_newest_picture_keeps_its_pixels_as_png(void)
{
    Bench bench;
    assert_error(404, "none-yet", bench.call("GET", "/api/v1/picture"));
    static const unsigned char pixels[2 * 16] = {10, 20, 30, 40};
    auto frame = std::make_shared<Frame>();
    frame->image = {pixels, 4, 2, 16, OPMS_PIXEL_GREY8, 0};
    bench.control.picture = frame;
    const HttpResponse png = bench.call("GET", "/api/v1/picture");
    TEST_ASSERT_EQUAL_INT(200, png.status);
    TEST_ASSERT_EQUAL_STRING("image/png", png.content_type.c_str());
    TEST_ASSERT_EQUAL_STRING_LEN("\x89PNG", png.body.data(), 4);
    const HttpResponse jpeg = bench.call("GET", "/api/v1/picture?format=jpeg");
    TEST_ASSERT_EQUAL_STRING("image/jpeg", jpeg.content_type.c_str());
    TEST_ASSERT_EQUAL_STRING_LEN("\xff\xd8\xff", jpeg.body.data(), 3);
    assert_error(400, "query", bench.call("GET", "/api/v1/picture?format=bmp"));
}

static void test_a_client_of_the_stream_chooses_and_sends_samples(void)
{
    Bench bench;
    bench.call("POST", "/api/v1/scan");
    StreamChoice choice;
    TEST_ASSERT_EQUAL_STRING(
        "", ApiHandler::stream_choice("/api/v1/stream?kinds=event&squares=1", choice).c_str());
    TEST_ASSERT_TRUE(!choice.kinds[0] && choice.kinds[1] && !choice.kinds[2] && choice.squares);
    TEST_ASSERT_NOT_EQUAL(
        0, ApiHandler::stream_choice("/api/v1/stream?kinds=poses", choice).size());
    Json reply = Json::parse(bench.api.stream_message(
        R"({"type":"subscribe","kinds":["pose"],"squares":false,"id":[1]})", choice));
    TEST_ASSERT_EQUAL_STRING("opms.subscribed/1", reply["schema"].get<std::string>().c_str());
    TEST_ASSERT_EQUAL_INT(1, reply["id"][0].get<int>());
    TEST_ASSERT_TRUE(choice.kinds[0] && !choice.kinds[1] && !choice.squares);
    reply = Json::parse(bench.api.stream_message(
        R"({"type":"samples","samples":{"sensor":"md","values":[1]}})", choice));
    TEST_ASSERT_EQUAL_STRING("opms.accepted/1", reply["schema"].get<std::string>().c_str());
    for (const char *wrong :
         {"", "[]", "{}", R"({"type":1})", R"({"type":"stop"})", R"({"type":"samples"})",
          R"({"type":"subscribe","kinds":"pose"})", R"({"type":"subscribe","kinds":["all"]})",
          R"({"type":"subscribe","squares":1})", R"({"type":"subscribe","kind":["pose"]})"}) {
        const StreamChoice before = choice;
        reply = Json::parse(bench.api.stream_message(wrong, choice));
        TEST_ASSERT_EQUAL_STRING_MESSAGE(
            "opms.error/1", reply["schema"].get<std::string>().c_str(), wrong);
        TEST_ASSERT_TRUE(before.kinds == choice.kinds && before.squares == choice.squares);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_scan_is_started_under_the_masters_name_and_stopped);
    RUN_TEST(test_a_scan_without_a_name_gets_one);
    RUN_TEST(test_names_that_could_leave_the_folder_are_refused);
    RUN_TEST(test_recorded_scans_are_listed_and_found_by_name);
    RUN_TEST(test_nobody_enters_without_the_token);
    RUN_TEST(test_a_browsers_token_comes_as_a_subprotocol_of_the_stream_alone);
    RUN_TEST(test_pages_of_other_origins_and_borrowed_names_are_refused);
    RUN_TEST(test_bodies_are_refused_by_kind_length_depth_and_form);
    RUN_TEST(test_a_wrong_method_is_told_the_right_ones);
    RUN_TEST(test_samples_get_their_time_by_what_they_say);
    RUN_TEST(test_one_wrong_sample_keeps_all_of_them_out);
    RUN_TEST(test_the_newest_pose_has_no_number_that_json_lacks);
    RUN_TEST(test_the_newest_picture_keeps_its_pixels_as_png);
    RUN_TEST(test_a_client_of_the_stream_chooses_and_sends_samples);
    return UNITY_END();
}
