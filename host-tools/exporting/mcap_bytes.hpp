/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * MCAP's serialization: little-endian integers, strings with a length before them, records. */
#ifndef OPMS_EXPORTING_MCAP_BYTES_HPP
#define OPMS_EXPORTING_MCAP_BYTES_HPP

#include <cstdint>
#include <map>
#include <string>

namespace opms_host {

enum class McapOpcode : std::uint8_t {
    header = 0x01,
    footer = 0x02,
    schema = 0x03,
    channel = 0x04,
    message = 0x05,
    chunk = 0x06,
    message_index = 0x07,
    chunk_index = 0x08,
    attachment = 0x09,
    attachment_index = 0x0A,
    statistics = 0x0B,
    metadata = 0x0C,
    metadata_index = 0x0D,
    summary_offset = 0x0E,
    data_end = 0x0F
};

/** Content of a record. */
class McapBytes {
public:
    McapBytes &u8(std::uint8_t value) { return little_endian(value, 1); }
    McapBytes &u16(std::uint16_t value) { return little_endian(value, 2); }
    McapBytes &u32(std::uint32_t value) { return little_endian(value, 4); }
    McapBytes &u64(std::uint64_t value) { return little_endian(value, 8); }
    McapBytes &raw(const std::string &bytes)
    {
        bytes_ += bytes;
        return *this;
    }
    /** With its length in 32 bits: strings, maps, arrays. */
    McapBytes &text(const std::string &value)
    {
        return u32(static_cast<std::uint32_t>(value.size())).raw(value);
    }
    McapBytes &map(const std::map<std::string, std::string> &values)
    {
        McapBytes pairs;
        for (const auto &[name, value] : values) {
            pairs.text(name).text(value);
        }
        return text(pairs.bytes_);
    }
    McapBytes &map(const std::map<std::uint16_t, std::uint64_t> &values)
    {
        McapBytes pairs;
        for (const auto &[id, value] : values) {
            pairs.u16(id).u64(value);
        }
        return text(pairs.bytes_);
    }
    const std::string &bytes() const { return bytes_; }
    /** The whole record. */
    std::string record(McapOpcode opcode) const
    {
        McapBytes whole;
        whole.u8(static_cast<std::uint8_t>(opcode)).u64(bytes_.size()).raw(bytes_);
        return whole.bytes_;
    }

private:
    McapBytes &little_endian(std::uint64_t value, int count)
    {
        for (int i = 0; i < count; i++) {
            bytes_ += static_cast<char>(value >> (8 * i) & 255U);
        }
        return *this;
    }

    std::string bytes_;
};

}  // namespace opms_host
#endif
