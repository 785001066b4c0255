/* SPDX-License-Identifier: Apache-2.0 */
#include <deque>

#include "sim_subject.h"

namespace {

class Naive : public Subject {
public:
    explicit Naive(uint32_t first_number) : first_number_(first_number) {}

    void open(uint32_t, uint32_t session_id, const opms_settings_t &) override
    {
        session_id_ = session_id;
        triggers_.clear();
        frames_.clear();
    }
    void report(const uint8_t *bytes, int64_t) override
    {
        opms_trigger_report_t trigger;
        if (opms_wire_read_trigger(bytes, OPMS_WIRE_SIZE, &trigger) == OPMS_WIRE_OK &&
            trigger.session_id == session_id_) {
            triggers_.push_back(trigger.trigger_number);
            pair();
        }
    }
    void frame(const opms_frame_t &frame) override
    {
        frames_.push_back(frame);
        pair();
    }
    void pong(int64_t, const uint8_t *, int64_t) override {}
    void advance(int64_t) override {}
    void close() override {}
    std::vector<opms_pair_gap_t> gaps() override { return {}; }
    const std::vector<opms_pair_result_t> &take() override
    {
        taken_.swap(results_);
        results_.clear();
        return taken_;
    }
    bool locked() const override { return true; }
    bool sums_hold() const override { return true; }
    int64_t spent_ns() const override { return 0; }

private:
    void pair()
    {
        while (!triggers_.empty() && !frames_.empty()) {
            opms_pair_result_t result{};
            result.trigger_state = OPMS_TRIGGER_PAIRED;
            result.frame_state = OPMS_FRAME_PAIRED;
            result.session_id = session_id_;
            result.trigger_count = 1;
            result.trigger_number = first_number_ + uint64_t(triggers_.front() - first_number_);
            result.frame = frames_.front();
            results_.push_back(result);
            triggers_.pop_front();
            frames_.pop_front();
        }
    }

    uint32_t first_number_, session_id_ = 0;
    std::deque<uint32_t> triggers_;
    std::deque<opms_frame_t> frames_;
    std::vector<opms_pair_result_t> results_, taken_;
};

} // namespace

std::unique_ptr<Subject> make_naive(uint32_t first_number)
{
    return std::make_unique<Naive>(first_number);
}
