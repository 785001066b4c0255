/* SPDX-License-Identifier: Apache-2.0 */
#include "access_token.hpp"

#include <algorithm>
#include <array>
#include <fstream>

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>
#include <sys/stat.h>

namespace opms_host {

namespace {

constexpr std::size_t RANDOM_BYTES = 32, TOKEN_MIN = 16, TOKEN_MAX = 256;
constexpr char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

using Digest = std::array<unsigned char, SHA256_DIGEST_LENGTH>;

/* Digests have one length, so that comparing them tells nothing of the texts' lengths. */
Digest digest(const std::string &text)
{
    Digest sum{};
    SHA256(reinterpret_cast<const unsigned char *>(text.data()), text.size(), sum.data());
    return sum;
}

}  // namespace

std::string access_token_make()
{
    std::array<unsigned char, RANDOM_BYTES> bytes{};
    if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
        return "";
    }
    std::string token;
    unsigned bits = 0, count = 0;
    for (const unsigned char byte : bytes) {
        bits = (bits << 8) | byte;
        for (count += 8; count >= 6; count -= 6) {
            token.push_back(DIGITS[(bits >> (count - 6)) & 63]);
        }
    }
    token.push_back(DIGITS[(bits << (6 - count)) & 63]);
    return token;
}

bool access_token_is_valid(const std::string &token)
{
    const auto is_good = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_' || c == '.' || c == '~';
    };
    return token.size() >= TOKEN_MIN && token.size() <= TOKEN_MAX &&
           std::all_of(token.begin(), token.end(), is_good);
}

bool access_token_read(const std::string &path, std::string &token, std::string &error)
{
    struct stat info = {};
    std::ifstream file(path);
    if (!file || stat(path.c_str(), &info) != 0) {
        error = path + ": cannot be read";
        return false;
    }
    if ((info.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
        error = path + ": others can read or change this secret: chmod 600 it";
        return false;
    }
    std::string line(TOKEN_MAX + 2, '\0');
    file.read(line.data(), static_cast<std::streamsize>(line.size()));
    line.resize(static_cast<std::size_t>(file.gcount()));
    line.resize(std::min(line.find('\n'), line.size()));
    if (!line.empty() && line.back() == '\r') {
        line.pop_back();
    }
    if (!access_token_is_valid(line)) {
        error = path + ": its first line must be the token: 16 to 256 letters, digits, '-', '_', "
                       "'.' or '~'";
        return false;
    }
    token = line;
    return true;
}

bool access_token_equal(const std::string &given, const std::string &wanted)
{
    const Digest a = digest(given), b = digest(wanted);
    return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace opms_host
