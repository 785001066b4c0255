/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_sink.hpp"

#include <utility>

namespace opms_host {
#ifdef OPMS_ENGINE_HAVE_RECORDING
namespace {

class RecorderSink : public ScanSink {
public:
    explicit RecorderSink(std::unique_ptr<Recorder> recorder) : recorder_(std::move(recorder)) {}

    void add(const FrameRecord &record, const FramePtr &picture) override
    {
        recorder_->add(record, picture);
    }
    void add(const TriggerRecord &record) override { recorder_->add(record); }
    void add(const PairRecord &record) override { recorder_->add(record); }
    void add(const std::shared_ptr<const PoseRecord> &record) override { recorder_->add(record); }
    void add(const EventRecord &record) override { recorder_->add(record); }
    void add(const ClockRecord &record) override { recorder_->add(record); }
    void add(const BoxReportRecord &record) override { recorder_->add(record); }
    void add(const SensorRecord &record) override { recorder_->add(record); }
    RecorderFigures figures() const override { return recorder_->figures(); }
    std::string name() const override
    {
        std::string path = recorder_->folder();
        while (!path.empty() && path.back() == '/') {
            path.pop_back();
        }
        return path.substr(path.rfind('/') + 1);
    }
    bool end(const ScanEnd &end, std::string &error) override { return recorder_->end(end, error); }

private:
    std::unique_ptr<Recorder> recorder_;
};

}  // namespace

std::shared_ptr<ScanSink> make_recorder_sink(const RecorderOptions &options,
                                             const ScanHeader &header,
                                             std::shared_ptr<HostClock> clock,
                                             std::string &error)
{
    ScanHeader named = header;
    named.name = scan_free_name(options.folder, header.name, header.begun_wall_ns, error);
    if (named.name.empty()) {
        return nullptr;
    }
    std::unique_ptr<Recorder> recorder = Recorder::begin(options, named, std::move(clock), error);
    return recorder ? std::make_shared<RecorderSink>(std::move(recorder)) : nullptr;
}
#else
std::shared_ptr<ScanSink> make_recorder_sink(const RecorderOptions &, const ScanHeader &,
                                             std::shared_ptr<HostClock>, std::string &error)
{
    error = "this program was built without the recording (SQLite was not found)";
    return nullptr;
}
#endif

}  // namespace opms_host
