/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a request of the Master PC's interface, and as a message of its stream.
 *
 * The first byte: bit 0 asks for a WebSocket, bit 1 came over TLS, bit 2 takes the token along.
 * Then "METHOD TARGET\n", headers as "NAME:VALUE\n", an empty line, and the body. */
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <nlohmann/json.hpp>

#include "api_handler.hpp"
#include "fake_control.hpp"

using namespace opms_host;

namespace {

const char TOKEN[] = "token-of-the-fuzzer-0123456789";

void require(bool holds)
{
    if (!holds) {
        std::abort();
    }
}

std::string take_until(std::string &rest, char end)
{
    const std::size_t at = std::min(rest.find(end), rest.size());
    std::string part = rest.substr(0, at);
    rest.erase(0, std::min(at + 1, rest.size()));
    return part;
}

HttpRequest request_of(std::uint8_t flags, std::string rest)
{
    HttpRequest request;
    request.upgrade = (flags & 1) != 0;
    request.secure = (flags & 2) != 0;
    request.method = take_until(rest, ' ');
    request.target = take_until(rest, '\n');
    if ((flags & 4) != 0) {
        request.headers.push_back({"Host", "localhost"});
        request.headers.push_back({"Authorization", std::string("Bearer ") + TOKEN});
    }
    while (!rest.empty() && rest[0] != '\n') {
        HttpHeader header;
        header.name = take_until(rest, ':');
        header.value = take_until(rest, '\n');
        request.headers.push_back(std::move(header));
    }
    take_until(rest, '\n');
    request.body = std::move(rest);
    return request;
}

bool holds_token(const HttpRequest &request)
{
    for (const HttpHeader &header : request.headers) {
        if (header.value.find(TOKEN) != std::string::npos) {
            return true;
        }
    }
    return false;
}

void check_response(const HttpRequest &request, const HttpResponse &response)
{
    require(response.status >= 200 && response.status < 600);
    require(response.status != 500);
    if (response.status >= 400) {
        const auto body = nlohmann::json::parse(response.body);
        require(body.at("error").at("code").is_string() &&
                !body.at("error").at("message").get<std::string>().empty());
    } else {
        require(holds_token(request));
    }
    for (const HttpHeader &header : response.headers) {
        require(header.value.find_first_of("\r\n") == std::string::npos);
    }
}

/** Nothing that a name or a sample brings may leave the bounds that are promised. */
void check_session(FakeControl &control)
{
    require(control.now.scan.find('/') == std::string::npos &&
            control.now.scan.size() <= 100);
    require(control.asked_for.find('/') == std::string::npos);
    for (const SensorRecord &sample : control.samples) {
        require(!sample.sensor.empty() && sample.sensor.size() <= 64);
        require(sample.values.size() <= 4096);
        require(sample.data_json.empty() ||
                nlohmann::json::parse(sample.data_json).is_object());
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, std::size_t size)
{
    if (size == 0) {
        return 0;
    }
    FakeControl control;
    const auto pose = std::make_shared<const PoseRecord>();
    const ApiHandler api({control, {TOKEN, {}}, [&pose] { return pose; }});
    const HttpRequest request =
        request_of(data[0], std::string(reinterpret_cast<const char *>(data) + 1, size - 1));
    const HttpResponse response = api.handle(request);
    check_response(request, response);
    control.now.scan = "lane";
    check_response(request, api.handle(request));
    StreamChoice choice;
    const auto reply = nlohmann::json::parse(api.stream_message(request.body, choice));
    require(reply.at("schema").is_string());
    check_session(control);
    return 0;
}
