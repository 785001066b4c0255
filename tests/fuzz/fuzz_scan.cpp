/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as the database of a recorded scan: an error for people, or rows. */
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "scan_reader.hpp"

using namespace opms_host;

namespace {

/** A folder of this process; gone with it. */
class Folder {
public:
    Folder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "opms-fuzz-XXXXXX").string();
        if (!::mkdtemp(name.data())) {
            std::abort();
        }
        path = name;
    }
    ~Folder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    std::filesystem::path path;
};

/** A damaged file may claim any number of rows; some are enough. */
template <typename Record> auto some()
{
    return [left = 1000](const Record &) mutable { return --left > 0; };
}

bool read_all(ScanReader &reader, std::string &error)
{
    return reader.each_frame(some<FrameRecord>(), error) &&
           reader.each_trigger(some<TriggerRecord>(), error) &&
           reader.each_pair(some<PairRecord>(), error) &&
           reader.each_pose(some<PoseRecord>(), error) &&
           reader.each_event(some<EventRecord>(), error) &&
           reader.each_clock(some<ClockRecord>(), error) &&
           reader.each_box_report(some<BoxReportRecord>(), error) &&
           reader.each_sensor(some<SensorRecord>(), error) &&
           reader.each_picture(some<PictureRow>(), error);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const Folder folder;
    std::ofstream(folder.path / "scan.sqlite", std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char *>(data), static_cast<std::streamsize>(size));
    std::string error;
    const auto reader = ScanReader::open(folder.path.string(), error);
    const bool good = reader && read_all(*reader, error);
    if (good != error.empty()) {
        std::abort(); /* a failure without words, or words without a failure */
    }
    return 0;
}
