/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A file that is there as a whole or not at all: written aside, synced, renamed. */
#ifndef OPMS_EXPORTING_OUTPUT_FILE_HPP
#define OPMS_EXPORTING_OUTPUT_FILE_HPP

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace opms_host {

/** One thread at a time. Without finish() nothing of it remains. */
class OutputFile {
public:
    /** @return NULL where the file cannot be made, or is there and must not be replaced; @p error
     * begins with the path. */
    static std::unique_ptr<OutputFile> open(const std::string &path, bool may_replace,
                                            std::string &error);
    ~OutputFile();
    OutputFile(const OutputFile &) = delete;
    OutputFile &operator=(const OutputFile &) = delete;

    /** After a failure nothing more is written, and finish() tells of it. */
    void write(const void *bytes, std::size_t size);
    void write(const std::string &text) { write(text.data(), text.size()); }
    /** Bytes handed over so far. */
    std::uint64_t size() const { return size_; }
    bool failed() const { return error_number_ != 0; }
    /** All of it is on the disk, not yet under its name: what can fail has failed by now. Where
     * two files belong together, both before either finish(). False with @p error. */
    bool seal(std::string &error);
    /** Seal, and give the file its name. False with @p error. */
    bool finish(std::string &error);

private:
    OutputFile(std::string path, std::string aside, int descriptor);
    void flush();
    bool told(std::string &error) const;

    std::string path_, aside_, waiting_;
    int descriptor_;
    int error_number_ = 0;
    std::uint64_t size_ = 0;
};

/** Write a whole file of known content; as OutputFile. */
bool output_file_write(const std::string &path, const std::string &bytes, bool may_replace,
                       std::string &error);

}  // namespace opms_host
#endif
