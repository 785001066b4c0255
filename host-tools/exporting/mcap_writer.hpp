/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Writes MCAP files (https://mcap.dev/spec, version 0): messages in chunks with CRCs and indexes,
 * an attachment, metadata, and the summary that lets readers jump. Uncompressed: what is large in a
 * scan are PNG pictures.
 *
 *     McapWriter writer(file, "opms 0.3.0");
 *     channel = writer.add_channel("/opms/pose", schema);  ...  writer.message(channel, t, json);
 *     writer.finish(); */
#ifndef OPMS_EXPORTING_MCAP_WRITER_HPP
#define OPMS_EXPORTING_MCAP_WRITER_HPP

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "crc32_sum.hpp"
#include "output_file.hpp"

namespace opms_host {

/** A JSON schema by its name. */
struct McapSchema {
    std::string name, json;
};

class McapWriter {
public:
    /** @param file  Stays the caller's, who calls its finish() after this one's. */
    McapWriter(OutputFile &file, const std::string &library);
    McapWriter(const McapWriter &) = delete;
    McapWriter &operator=(const McapWriter &) = delete;

    /** A topic of JSON messages. @return Its channel. At most 65,535. */
    std::uint16_t add_channel(const std::string &topic, const McapSchema &schema);
    /** In any order of times. */
    void message(std::uint16_t channel, std::uint64_t t_ns, const std::string &json);
    void attachment(const std::string &name, const std::string &media_type, std::uint64_t t_ns,
                    const std::string &bytes);
    void metadata(const std::string &name, const std::map<std::string, std::string> &values);
    /** The end of the data, summary, footer. Nothing may follow. */
    void finish();
    std::uint64_t messages() const { return messages_; }

private:
    using MessageTimes = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
    struct TimeRange {
        std::uint64_t first = 0, last = 0;
        bool any = false;
        void take(std::uint64_t t_ns);
    };

    void put(const std::string &bytes);
    void end_chunk();
    std::uint64_t write_message_indexes(std::string &offsets);
    std::string statistics() const;
    void finish_summary(std::uint64_t summary_start, const std::string &summary,
                        const std::string &offsets);

    OutputFile &file_;
    Crc32Sum data_crc_;
    std::map<std::string, std::uint16_t> schemas_;
    std::string schema_records_, channel_records_; /**< for the summary */
    std::string chunk_indexes_, attachment_indexes_, metadata_indexes_;
    std::uint16_t channels_ = 0;
    std::uint32_t chunks_ = 0, attachments_ = 0, metadatas_ = 0;
    std::uint64_t messages_ = 0;
    std::map<std::uint16_t, std::uint64_t> channel_messages_;
    TimeRange times_;
    std::string chunk_; /**< records of the chunk that is being filled */
    TimeRange chunk_times_;
    std::map<std::uint16_t, MessageTimes> chunk_index_;
};

}  // namespace opms_host
#endif
