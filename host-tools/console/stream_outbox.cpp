/* SPDX-License-Identifier: Apache-2.0 */
#include "stream_outbox.hpp"

#include <algorithm>

namespace opms_host {

namespace {

std::string missed_text(const StreamCounts &counts)
{
    std::string text = R"({"schema":"opms.missed/1","missed":{)";
    for (std::size_t kind = 0; kind < STREAM_KINDS; kind++) {
        text += std::string(kind > 0 ? "," : "") + "\"" + STREAM_KIND_NAMES[kind] +
                "\":" + std::to_string(counts[kind]);
    }
    return text + "}}";
}

}  // namespace

void StreamOutbox::miss(StreamKind kind, std::uint64_t count)
{
    if (choice_.kinds[static_cast<std::size_t>(kind)]) {
        missed_[static_cast<std::size_t>(kind)] += count;
        missed_total_[static_cast<std::size_t>(kind)] += count;
    }
}

void StreamOutbox::push(const StreamMessagePtr &message)
{
    for (std::size_t kind = 0; kind < STREAM_KINDS; kind++) {
        miss(static_cast<StreamKind>(kind), message->lost[kind]);
    }
    if (!choice_.kinds[static_cast<std::size_t>(message->kind)]) {
        return;
    }
    if (waiting_.size() >= most_) {
        miss(waiting_.front().message->kind, 1);
        waiting_.pop_front();
    }
    waiting_.push_back({message, choice_.squares});
}

void StreamOutbox::push_reply(std::string text)
{
    replies_.push_back(std::make_shared<const std::string>(std::move(text)));
}

std::shared_ptr<const std::string> StreamOutbox::pop()
{
    if (!replies_.empty()) {
        auto reply = std::move(replies_.front());
        replies_.pop_front();
        return reply;
    }
    if (std::any_of(missed_.begin(), missed_.end(), [](std::uint64_t n) { return n > 0; })) {
        auto text = std::make_shared<const std::string>(missed_text(missed_));
        missed_ = {};
        return text;
    }
    if (waiting_.empty()) {
        return nullptr;
    }
    const Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    const bool squares = next.squares && !next.message->text_squares.empty();
    /* Shares the message's life instead of copying its text. */
    return {next.message, squares ? &next.message->text_squares : &next.message->text};
}

}  // namespace opms_host
