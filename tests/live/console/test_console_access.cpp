/* SPDX-License-Identifier: Apache-2.0 */
/* Where the interface may listen, and the token that opens it. */
#include <cstdio>
#include <fstream>
#include <set>
#include <string>

#include <sys/stat.h>
#include <unity.h>

#include "access_token.hpp"
#include "listen_address.hpp"

using namespace opms_host;

static const char FILE_NAME[] = "test_console_access.token";

void setUp(void)
{
}

void tearDown(void)
{
    std::remove(FILE_NAME);
}

static ListenAddress address(const char *text)
{
    ListenAddress listen;
    TEST_ASSERT_EQUAL_STRING("", parse_listen_address(text, listen).c_str());
    return listen;
}

static void test_addresses_are_read_in_all_their_forms(void)
{
    TEST_ASSERT_EQUAL_STRING("127.0.0.1", address("localhost:80").address.c_str());
    TEST_ASSERT_EQUAL_INT(80, address("localhost:80").port);
    TEST_ASSERT_EQUAL_INT(CONSOLE_PORT, address("0.0.0.0").port);
    TEST_ASSERT_EQUAL_STRING("::1", address("[::1]:0").address.c_str());
    TEST_ASSERT_EQUAL_STRING("[fe80::2]", address("fe80::2").url_host().c_str());
    ListenAddress listen;
    for (const char *wrong : {"", ":80", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:65536", "a.b:80",
                              "[::1", "[::1]80", "[::1]:", "127.0.0.1:80:80", "127.1:80"}) {
        TEST_ASSERT_NOT_EQUAL(0, parse_listen_address(wrong, listen).size());
    }
}

static void test_only_loopback_addresses_are_loopback(void)
{
    for (const char *own : {"127.0.0.1", "127.9.8.7", "[::1]:1", "localhost"}) {
        TEST_ASSERT_TRUE(address(own).is_loopback);
    }
    for (const char *other : {"0.0.0.0", "128.0.0.1", "[::]:1", "192.168.1.2", "::ffff:10.0.0.1"}) {
        TEST_ASSERT_FALSE(address(other).is_loopback);
    }
}

static void test_the_network_needs_a_token_file_and_tls(void)
{
    const ListenAddress net = address("0.0.0.0"), own = address("127.0.0.1");
    const auto refused = [](const ListenAddress &listen, ListenSafety safety) {
        return !listen_refusal(listen, safety).empty();
    };
    TEST_ASSERT_FALSE(refused(own, {false, false, false}));
    TEST_ASSERT_TRUE(refused(net, {false, false, false}));
    TEST_ASSERT_TRUE(refused(net, {false, true, false}));
    TEST_ASSERT_TRUE(refused(net, {true, false, false}));
    TEST_ASSERT_TRUE(refused(net, {false, false, true})); /* the token is never dropped */
    TEST_ASSERT_FALSE(refused(net, {true, true, false}));
    TEST_ASSERT_FALSE(refused(net, {true, false, true}));
    TEST_ASSERT_TRUE(refused(net, {true, true, true}));
}

static void test_each_token_made_is_another_one_and_valid(void)
{
    std::set<std::string> tokens;
    for (int i = 0; i < 100; i++) {
        const std::string token = access_token_make();
        TEST_ASSERT_EQUAL_INT(43, static_cast<int>(token.size()));
        TEST_ASSERT_TRUE(access_token_is_valid(token));
        tokens.insert(token);
    }
    TEST_ASSERT_EQUAL_INT(100, static_cast<int>(tokens.size()));
}

static void test_tokens_are_equal_only_to_themselves(void)
{
    TEST_ASSERT_TRUE(access_token_equal("0123456789abcdef", "0123456789abcdef"));
    TEST_ASSERT_FALSE(access_token_equal("0123456789abcdeF", "0123456789abcdef"));
    TEST_ASSERT_FALSE(access_token_equal("", "0123456789abcdef"));
    TEST_ASSERT_FALSE(access_token_equal(std::string("0123456789abcdef\0", 17),
                                         "0123456789abcdef"));
}

static bool read_file(const std::string &content, mode_t mode, std::string &token,
                      std::string &error)
{
    std::remove(FILE_NAME);
    std::ofstream(FILE_NAME) << content;
    TEST_ASSERT_EQUAL_INT(0, chmod(FILE_NAME, mode));
    return access_token_read(FILE_NAME, token, error);
}

static void test_a_token_file_that_others_can_read_is_refused(void)
{
    std::string token, error;
    TEST_ASSERT_TRUE(read_file("0123456789abcdef\r\nrest\n", 0600, token, error));
    TEST_ASSERT_EQUAL_STRING("0123456789abcdef", token.c_str());
    for (const mode_t mode : {0640, 0604, 0620, 0602}) {
        TEST_ASSERT_FALSE(read_file("0123456789abcdef\n", mode, token, error));
        TEST_ASSERT_NOT_EQUAL(std::string::npos, error.find("chmod 600"));
    }
    for (const std::string &wrong : {std::string(), std::string("short"), std::string(257, 'a'),
                                     std::string("0123456789 abcdef"), std::string(5000, 'a')}) {
        TEST_ASSERT_FALSE(read_file(wrong, 0600, token, error));
    }
    TEST_ASSERT_FALSE(access_token_read("no such file", token, error));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_addresses_are_read_in_all_their_forms);
    RUN_TEST(test_only_loopback_addresses_are_loopback);
    RUN_TEST(test_the_network_needs_a_token_file_and_tls);
    RUN_TEST(test_each_token_made_is_another_one_and_valid);
    RUN_TEST(test_tokens_are_equal_only_to_themselves);
    RUN_TEST(test_a_token_file_that_others_can_read_is_refused);
    return UNITY_END();
}
