/* SPDX-License-Identifier: Apache-2.0 */
#include "mcap_writer.hpp"

#include <algorithm>

#include "mcap_bytes.hpp"

namespace opms_host {

namespace {

const std::string MAGIC("\x89MCAP0\r\n", 8);
constexpr std::size_t CHUNK_BYTES = 4 * 1024 * 1024;
/** Type, length, both offsets: the footer's bytes that its CRC covers. */
constexpr std::size_t FOOTER_BYTES_IN_CRC = 1 + 8 + 8 + 8;

}  // namespace

void McapWriter::TimeRange::take(std::uint64_t t_ns)
{
    first = any ? std::min(first, t_ns) : t_ns;
    last = any ? std::max(last, t_ns) : t_ns;
    any = true;
}

McapWriter::McapWriter(OutputFile &file, const std::string &library) : file_(file)
{
    put(MAGIC);
    put(McapBytes().text("").text(library).record(McapOpcode::header));
}

void McapWriter::put(const std::string &bytes)
{
    data_crc_.add(bytes.data(), bytes.size());
    file_.write(bytes);
}

std::uint16_t McapWriter::add_channel(const std::string &topic, const McapSchema &schema)
{
    const auto [known, is_new] =
        schemas_.emplace(schema.name, static_cast<std::uint16_t>(schemas_.size() + 1));
    if (is_new) {
        const std::string record = McapBytes()
                                       .u16(known->second)
                                       .text(schema.name)
                                       .text("jsonschema")
                                       .text(schema.json)
                                       .record(McapOpcode::schema);
        schema_records_ += record;
        chunk_ += record;
    }
    const std::string record = McapBytes()
                                   .u16(++channels_)
                                   .u16(known->second)
                                   .text(topic)
                                   .text("json")
                                   .map(std::map<std::string, std::string>())
                                   .record(McapOpcode::channel);
    channel_records_ += record;
    chunk_ += record;
    return channels_;
}

void McapWriter::message(std::uint16_t channel, std::uint64_t t_ns, const std::string &json)
{
    const auto sequence = static_cast<std::uint32_t>(++channel_messages_[channel]);
    chunk_index_[channel].emplace_back(t_ns, chunk_.size());
    chunk_ += McapBytes()
                  .u16(channel)
                  .u32(sequence)
                  .u64(t_ns)
                  .u64(t_ns)
                  .raw(json)
                  .record(McapOpcode::message);
    messages_++;
    times_.take(t_ns);
    chunk_times_.take(t_ns);
    if (chunk_.size() >= CHUNK_BYTES) {
        end_chunk();
    }
}

/** @param[out] offsets  Where each channel's index stands, as the chunk's index has it. */
std::uint64_t McapWriter::write_message_indexes(std::string &offsets)
{
    const std::uint64_t start = file_.size();
    std::map<std::uint16_t, std::uint64_t> places;
    for (auto &[channel, entries] : chunk_index_) {
        places[channel] = file_.size();
        std::stable_sort(entries.begin(), entries.end(),
                         [](const auto &a, const auto &b) { return a.first < b.first; });
        McapBytes list;
        for (const auto &[t_ns, offset] : entries) {
            list.u64(t_ns).u64(offset);
        }
        put(McapBytes().u16(channel).text(list.bytes()).record(McapOpcode::message_index));
    }
    offsets = McapBytes().map(places).bytes();
    return file_.size() - start;
}

void McapWriter::end_chunk()
{
    if (chunk_.empty()) {
        return;
    }
    Crc32Sum crc;
    crc.add(chunk_.data(), chunk_.size());
    const std::uint64_t start = file_.size();
    put(McapBytes()
            .u64(chunk_times_.first)
            .u64(chunk_times_.last)
            .u64(chunk_.size())
            .u32(crc.value())
            .text("")
            .u64(chunk_.size())
            .raw(chunk_)
            .record(McapOpcode::chunk));
    const std::uint64_t length = file_.size() - start;
    std::string offsets;
    const std::uint64_t indexes_length = write_message_indexes(offsets);
    chunk_indexes_ += McapBytes()
                          .u64(chunk_times_.first)
                          .u64(chunk_times_.last)
                          .u64(start)
                          .u64(length)
                          .raw(offsets)
                          .u64(indexes_length)
                          .text("")
                          .u64(chunk_.size())
                          .u64(chunk_.size())
                          .record(McapOpcode::chunk_index);
    chunks_++;
    chunk_.clear();
    chunk_times_ = TimeRange();
    chunk_index_.clear();
}

void McapWriter::attachment(const std::string &name, const std::string &media_type,
                            std::uint64_t t_ns, const std::string &bytes)
{
    end_chunk();
    McapBytes content;
    content.u64(t_ns).u64(0).text(name).text(media_type).u64(bytes.size()).raw(bytes);
    Crc32Sum crc;
    crc.add(content.bytes().data(), content.bytes().size());
    const std::uint64_t start = file_.size();
    put(content.u32(crc.value()).record(McapOpcode::attachment));
    attachment_indexes_ += McapBytes()
                               .u64(start)
                               .u64(file_.size() - start)
                               .u64(t_ns)
                               .u64(0)
                               .u64(bytes.size())
                               .text(name)
                               .text(media_type)
                               .record(McapOpcode::attachment_index);
    attachments_++;
}

void McapWriter::metadata(const std::string &name,
                          const std::map<std::string, std::string> &values)
{
    end_chunk();
    const std::uint64_t start = file_.size();
    put(McapBytes().text(name).map(values).record(McapOpcode::metadata));
    metadata_indexes_ += McapBytes().u64(start).u64(file_.size() - start).text(name).record(
        McapOpcode::metadata_index);
    metadatas_++;
}

std::string McapWriter::statistics() const
{
    return McapBytes()
        .u64(messages_)
        .u16(static_cast<std::uint16_t>(schemas_.size()))
        .u32(channels_)
        .u32(attachments_)
        .u32(metadatas_)
        .u32(chunks_)
        .u64(times_.first)
        .u64(times_.last)
        .map(channel_messages_)
        .record(McapOpcode::statistics);
}

void McapWriter::finish()
{
    end_chunk();
    const std::uint32_t data_crc = data_crc_.value();
    file_.write(McapBytes().u32(data_crc).record(McapOpcode::data_end));
    const std::uint64_t summary_start = file_.size();
    std::string summary, offsets;
    const std::pair<McapOpcode, std::string> groups[] = {
        {McapOpcode::schema, schema_records_},
        {McapOpcode::channel, channel_records_},
        {McapOpcode::statistics, statistics()},
        {McapOpcode::chunk_index, chunk_indexes_},
        {McapOpcode::attachment_index, attachment_indexes_},
        {McapOpcode::metadata_index, metadata_indexes_}};
    for (const auto &[opcode, records] : groups) {
        if (!records.empty()) {
            offsets += McapBytes()
                           .u8(static_cast<std::uint8_t>(opcode))
                           .u64(summary_start + summary.size())
                           .u64(records.size())
                           .record(McapOpcode::summary_offset);
            summary += records;
        }
    }
    finish_summary(summary_start, summary, offsets);
}

void McapWriter::finish_summary(std::uint64_t summary_start, const std::string &summary,
                                const std::string &offsets)
{
    McapBytes footer;
    footer.u64(summary_start).u64(summary_start + summary.size());
    /* The CRC stands in the footer itself, behind the bytes that it covers. */
    std::string covered = McapBytes(footer).u32(0).record(McapOpcode::footer);
    covered.resize(FOOTER_BYTES_IN_CRC);
    Crc32Sum crc;
    crc.add(summary.data(), summary.size());
    crc.add(offsets.data(), offsets.size());
    crc.add(covered.data(), covered.size());
    file_.write(summary);
    file_.write(offsets);
    file_.write(footer.u32(crc.value()).record(McapOpcode::footer));
    file_.write(MAGIC);
}

}  // namespace opms_host
