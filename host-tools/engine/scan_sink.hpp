/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where a scan's records go: to a recording. An interface, so that tests may look at what is handed
 * over, and so that the engine can be built without the recording. */
#ifndef OPMS_ENGINE_SCAN_SINK_HPP
#define OPMS_ENGINE_SCAN_SINK_HPP

#include <memory>
#include <string>

#include "recorder.hpp"
#include "scan_listener.hpp"

namespace opms_host {

/** As Recorder. */
class ScanSink {
public:
    virtual ~ScanSink() = default;
    virtual void add(const FrameRecord &record, const FramePtr &picture) = 0;
    virtual void add(const TriggerRecord &record) = 0;
    virtual void add(const PairRecord &record) = 0;
    virtual void add(const std::shared_ptr<const PoseRecord> &record) = 0;
    virtual void add(const EventRecord &record) = 0;
    virtual void add(const ClockRecord &record) = 0;
    virtual void add(const BoxReportRecord &record) = 0;
    virtual void add(const SensorRecord &record) = 0;
    virtual RecorderFigures figures() const = 0;
    /** Of this scan's folder, without those above it. */
    virtual std::string name() const = 0;
    virtual bool end(const ScanEnd &end, std::string &error) = 0;
};

/** A Recorder. Fails with a message where this build has none. */
std::shared_ptr<ScanSink> make_recorder_sink(const RecorderOptions &options,
                                             const ScanHeader &header,
                                             std::shared_ptr<HostClock> clock,
                                             std::string &error);

}  // namespace opms_host
#endif
