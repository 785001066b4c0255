/* SPDX-License-Identifier: Apache-2.0 */
#include <chrono>
#include <thread>

#include "engine_scene.hpp"

namespace engine_scene {
namespace {

class TapeSink : public ScanSink {
public:
    explicit TapeSink(std::shared_ptr<Tape> tape) : tape_(std::move(tape)) {}

    void add(const FrameRecord &record, const FramePtr &) override
    {
        note([&] { tape_->frames.push_back(record.number); });
    }
    void add(const TriggerRecord &record) override
    {
        note([&] { ++(record.from_history ? tape_->from_history : tape_->triggers); });
    }
    void add(const PairRecord &) override
    {
        note([&] { ++tape_->pairs; });
    }
    void add(const std::shared_ptr<const PoseRecord> &record) override
    {
        note([&] { tape_->poses.push_back(record->number); });
    }
    void add(const EventRecord &) override
    {
        note([&] { ++tape_->events; });
    }
    void add(const ClockRecord &) override
    {
        note([&] { ++tape_->clocks; });
    }
    void add(const BoxReportRecord &) override
    {
        note([&] { ++tape_->reports; });
    }
    void add(const SensorRecord &record) override
    {
        note([&] { tape_->samples.push_back(record); });
    }
    RecorderFigures figures() const override
    {
        RecorderFigures figures;
        figures.state = RecordingState::on;
        return figures;
    }
    std::string name() const override { return "tape"; }
    bool end(const ScanEnd &end, std::string &) override
    {
        const std::lock_guard<std::mutex> lock(tape_->mutex);
        tape_->end = end;
        ++tape_->ended;
        return true;
    }

private:
    template <typename Act> void note(const Act &act)
    {
        const std::lock_guard<std::mutex> lock(tape_->mutex);
        tape_->after_end += tape_->ended == tape_->begun;
        act();
    }
    std::shared_ptr<Tape> tape_;
};

}  // namespace

ScanSinkMaker tape_maker(const std::shared_ptr<Tape> &tape)
{
    return [tape](const RecorderOptions &, const ScanHeader &header, std::shared_ptr<HostClock>,
                  std::string &error) -> std::shared_ptr<ScanSink> {
        const std::lock_guard<std::mutex> lock(tape->mutex);
        if (!tape->refuse_begin.empty()) {
            error = tape->refuse_begin;
            return nullptr;
        }
        ++tape->begun;
        tape->header = header;
        return std::make_shared<TapeSink>(tape);
    };
}

void Notes::on_state(const SessionStatus &status)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    if (states_.empty() || states_.back() != status.state) {
        states_.push_back(status.state);
    }
}

void Notes::on_pose(const std::shared_ptr<const PoseRecord> &pose)
{
    std::this_thread::sleep_for(std::chrono::milliseconds(pose_delay_ms.load()));
    const std::lock_guard<std::mutex> lock(mutex_);
    poses_.push_back(pose);
}

void Notes::on_event(const EventRecord &event)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    ++events_[event.code];
}

std::vector<std::shared_ptr<const PoseRecord>> Notes::poses() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return poses_;
}

std::vector<SessionState> Notes::states() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return states_;
}

int Notes::events(const std::string &code) const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto place = events_.find(code);
    return place == events_.end() ? 0 : place->second;
}

bool Notes::hears(const std::string &code, int times) const
{
    return eventually([&] { return events(code) >= times; }) && events(code) == times;
}

std::size_t Notes::pose_count() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return poses_.size();
}

bool eventually(const std::function<bool()> &is_so)
{
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!is_so()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

}  // namespace engine_scene
