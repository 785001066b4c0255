/* SPDX-License-Identifier: Apache-2.0 */
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "sim_subject.h"

namespace {

void require(opms_status_t status, const opms_error_t &err)
{
    if (status != OPMS_OK) {
        std::fprintf(stderr, "opms_pair_sim: %s: %s\n", err.stage, err.message);
        std::abort();
    }
}

/** Adds up the time between its making and its end. */
class Stopwatch {
public:
    explicit Stopwatch(int64_t &sum) : sum_(sum), start_(std::chrono::steady_clock::now()) {}
    ~Stopwatch()
    {
        const auto spent = std::chrono::steady_clock::now() - start_;
        sum_ += std::chrono::duration_cast<std::chrono::nanoseconds>(spent).count();
    }
    Stopwatch(const Stopwatch &) = delete;
    Stopwatch &operator=(const Stopwatch &) = delete;

private:
    int64_t &sum_;
    std::chrono::steady_clock::time_point start_;
};

class Pairer : public Subject {
public:
    Pairer(Profile profile, const CameraState &camera, uint32_t first_number)
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
        require(opms_pairer_create(&options, &pairer_, &err_), err_);
    }
    ~Pairer() override { opms_pairer_destroy(pairer_); }
    Pairer(const Pairer &) = delete;
    Pairer &operator=(const Pairer &) = delete;

    void open(uint32_t boot_id, uint32_t session_id, const opms_settings_t &settings) override
    {
        require(opms_pairer_open(pairer_, boot_id, session_id, &settings, &err_), err_);
    }
    void report(const uint8_t *bytes, int64_t at) override
    {
        const Stopwatch watch(spent_);
        opms_trigger_report_t trigger;
        opms_event_report_t event;
        opms_status_report_t status;
        opms_history_report_t history;
        if (opms_wire_read_trigger(bytes, OPMS_WIRE_SIZE, &trigger) == OPMS_WIRE_OK) {
            require(opms_pairer_push_trigger(pairer_, &trigger, at, &err_), err_);
        } else if (opms_wire_read_history(bytes, OPMS_WIRE_SIZE, &history) == OPMS_WIRE_OK) {
            require(opms_pairer_push_history(pairer_, &history, &err_), err_);
        } else if (opms_wire_read_status(bytes, OPMS_WIRE_SIZE, &status) == OPMS_WIRE_OK) {
            require(opms_pairer_push_status(pairer_, &status, &err_), err_);
        } else if (opms_wire_read_event(bytes, OPMS_WIRE_SIZE, &event) == OPMS_WIRE_OK) {
            require(opms_pairer_push_event(pairer_, &event, &err_), err_);
        }
        poll();
    }
    void pong(int64_t sent, const uint8_t *bytes, int64_t at) override
    {
        const Stopwatch watch(spent_);
        opms_pong_report_t pong;
        if (opms_wire_read_pong(bytes, OPMS_WIRE_SIZE, &pong) == OPMS_WIRE_OK) {
            require(opms_pairer_push_pong(pairer_, sent, &pong, at, &err_), err_);
        }
        poll();
    }
    void frame(const opms_frame_t &frame) override
    {
        const Stopwatch watch(spent_);
        require(opms_pairer_push_frame(pairer_, &frame, &err_), err_);
        poll();
    }
    void advance(int64_t now) override
    {
        const Stopwatch watch(spent_);
        require(opms_pairer_advance(pairer_, now, &err_), err_);
        poll();
    }
    void close() override
    {
        require(opms_pairer_close(pairer_, &err_), err_);
        poll();
    }
    std::vector<opms_pair_gap_t> gaps() override
    {
        const Stopwatch watch(spent_);
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
    int64_t spent_ns() const override { return spent_; }

private:
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

    opms_pairer_t *pairer_ = nullptr;
    opms_error_t err_{};
    std::vector<opms_pair_result_t> results_, taken_;
    int64_t spent_ = 0;
};

} // namespace

std::unique_ptr<Subject> make_pairer(Profile profile, const CameraState &camera,
                                     uint32_t first_number)
{
    return std::make_unique<Pairer>(profile, camera, first_number);
}
