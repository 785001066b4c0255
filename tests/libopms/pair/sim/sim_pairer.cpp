/* SPDX-License-Identifier: Apache-2.0 */
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "sim_subject.h"

namespace {

void require(opms_status_t status, const opms_error_t &err)
{
    if (status != OPMS_OK) {
        std::fprintf(stderr, "opms_pair_sim: %s: %s\n", err.stage, err.message);
        std::abort();
    }
}

enum class Kind { TRIGGER, HISTORY, STATUS, EVENT, PONG, FRAME, ADVANCE, UNREADABLE };

/** One input, as it comes out of the report parser. */
struct Input {
    Kind kind;
    int64_t at, sent;
    union {
        opms_trigger_report_t trigger;
        opms_history_report_t history;
        opms_status_report_t status;
        opms_event_report_t event;
        opms_pong_report_t pong;
        opms_frame_t frame;
    };
};

Input parse(const uint8_t *bytes, int64_t at, int64_t sent)
{
    Input input{};
    input.at = at;
    input.sent = sent;
    constexpr size_t size = OPMS_WIRE_SIZE;
    if (opms_wire_read_trigger(bytes, size, &input.trigger) == OPMS_WIRE_OK) {
        input.kind = Kind::TRIGGER;
    } else if (opms_wire_read_history(bytes, size, &input.history) == OPMS_WIRE_OK) {
        input.kind = Kind::HISTORY;
    } else if (opms_wire_read_status(bytes, size, &input.status) == OPMS_WIRE_OK) {
        input.kind = Kind::STATUS;
    } else if (opms_wire_read_event(bytes, size, &input.event) == OPMS_WIRE_OK) {
        input.kind = Kind::EVENT;
    } else if (opms_wire_read_pong(bytes, size, &input.pong) == OPMS_WIRE_OK) {
        input.kind = Kind::PONG;
    } else {
        input.kind = Kind::UNREADABLE;
    }
    return input;
}

opms_status_t push(opms_pairer_t *pairer, const Input &input, opms_error_t *err)
{
    switch (input.kind) {
    case Kind::TRIGGER: return opms_pairer_push_trigger(pairer, &input.trigger, input.at, err);
    case Kind::HISTORY: return opms_pairer_push_history(pairer, &input.history, err);
    case Kind::STATUS: return opms_pairer_push_status(pairer, &input.status, err);
    case Kind::EVENT: return opms_pairer_push_event(pairer, &input.event, err);
    case Kind::PONG:
        return opms_pairer_push_pong(pairer, input.sent, &input.pong, input.at, err);
    case Kind::FRAME: return opms_pairer_push_frame(pairer, &input.frame, err);
    case Kind::ADVANCE: return opms_pairer_advance(pairer, input.at, err);
    case Kind::UNREADABLE: break;
    }
    return OPMS_OK;
}

opms_pairer_t *create(Profile profile, const CameraState &camera, uint32_t first_number)
{
    opms_pair_options_t options;
    opms_pair_options_init(&options);
    options.first_number = first_number;
    options.camera.frame_id_bits = camera.bits;
    options.camera.frame_id_skips_0 = camera.skips_0;
    options.camera.has_strobe = has_strobe(profile);
    options.camera.has_camera_time = has_stamp(profile);
    options.camera.camera_time_bits = 64;
    options.camera.camera_tick_hz = 125000000;
    opms_pairer_t *pairer = nullptr;
    opms_error_t err{};
    require(opms_pairer_create(&options, &pairer, &err), err);
    return pairer;
}

class Pairer : public Subject {
public:
    Pairer(Profile profile, const CameraState &camera, uint32_t first_number)
        : pairer_(create(profile, camera, first_number)),
          timed_(create(profile, camera, first_number))
    {
    }
    ~Pairer() override
    {
        opms_pairer_destroy(pairer_);
        opms_pairer_destroy(timed_);
    }
    Pairer(const Pairer &) = delete;
    Pairer &operator=(const Pairer &) = delete;

    void open(uint32_t boot_id, uint32_t session_id, const opms_settings_t &settings) override
    {
        boot_id_ = boot_id;
        session_id_ = session_id;
        settings_ = settings;
        opened_at_ = inputs_.size();
        require(opms_pairer_open(pairer_, boot_id, session_id, &settings, &err_), err_);
    }
    void report(const uint8_t *bytes, int64_t at) override { take_up(parse(bytes, at, at)); }
    void pong(int64_t sent, const uint8_t *bytes, int64_t at) override
    {
        take_up(parse(bytes, at, sent));
    }
    void frame(const opms_frame_t &frame) override
    {
        Input input{};
        input.kind = Kind::FRAME;
        input.frame = frame;
        take_up(input);
    }
    void advance(int64_t now) override
    {
        Input input{};
        input.kind = Kind::ADVANCE;
        input.at = now;
        take_up(input);
    }
    void close() override
    {
        require(opms_pairer_close(pairer_, &err_), err_);
        poll();
        replay();
    }
    std::vector<opms_pair_gap_t> gaps() override
    {
        std::vector<opms_pair_gap_t> found(8);
        uint32_t count = 0;
        require(opms_pair_gaps(pairer_, found.data(), uint32_t(found.size()), &count, &err_), err_);
        found.resize(count);
        return found;
    }
    const std::vector<opms_pair_result_t> &take() override
    {
        taken_.swap(results_);
        results_.clear();
        return taken_;
    }
    bool locked() const override { return summary().state == OPMS_PAIR_LOCKED; }
    bool sums_hold() const override { return summary().sums_hold != 0; }
    int64_t spent_ns() const override { return spent_ns_; }

private:
    void take_up(const Input &input)
    {
        inputs_.push_back(input);
        require(push(pairer_, input, &err_), err_);
        poll();
    }

    /** The session again, on another pairer, by the processor's clock and with nothing else. */
    void replay()
    {
        opms_pair_result_t some[16];
        uint32_t count = 0;
        const std::clock_t start = std::clock();
        for (size_t i = 0; i < inputs_.size(); ++i) {
            if (i == opened_at_) {
                require(opms_pairer_open(timed_, boot_id_, session_id_, &settings_, &err_), err_);
            }
            require(push(timed_, inputs_[i], &err_), err_);
            do {
                require(opms_pairer_poll(timed_, some, 16, &count, &err_), err_);
            } while (count == 16);
        }
        require(opms_pairer_close(timed_, &err_), err_);
        do {
            require(opms_pairer_poll(timed_, some, 16, &count, &err_), err_);
        } while (count == 16);
        spent_ns_ += int64_t(double(std::clock() - start) * (1e9 / CLOCKS_PER_SEC));
        inputs_.clear();
    }

    opms_pair_summary_t summary() const
    {
        opms_pair_summary_t now;
        opms_pairer_summary(pairer_, &now);
        return now;
    }
    void poll()
    {
        uint32_t count = 0;
        do {
            opms_pair_result_t some[16];
            require(opms_pairer_poll(pairer_, some, 16, &count, &err_), err_);
            results_.insert(results_.end(), some, some + count);
        } while (count == 16);
    }

    opms_pairer_t *pairer_, *timed_;
    opms_error_t err_{};
    std::vector<Input> inputs_;
    uint32_t boot_id_ = 0, session_id_ = 0;
    opms_settings_t settings_{};
    size_t opened_at_ = 0;
    std::vector<opms_pair_result_t> results_, taken_;
    int64_t spent_ns_ = 0;
};

} // namespace

std::unique_ptr<Subject> make_pairer(Profile profile, const CameraState &camera,
                                     uint32_t first_number)
{
    return std::make_unique<Pairer>(profile, camera, first_number);
}
