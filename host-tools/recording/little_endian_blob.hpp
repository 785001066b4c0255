/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What one picture gave as bytes, and back, bit by bit: SQLite itself would turn -0.0 into 0.0 and
 * NaN into NULL. Little-endian; layouts: docs/recording.md. The readers return false where the
 * bytes are not of the right length. */
#ifndef OPMS_RECORDING_LITTLE_ENDIAN_BLOB_HPP
#define OPMS_RECORDING_LITTLE_ENDIAN_BLOB_HPP

#include <cstdint>
#include <string_view>
#include <vector>

#include <opms/locate.h>

#include "scan_records.hpp"

namespace opms_host {

using Blob = std::vector<std::uint8_t>;
using BlobView = std::basic_string_view<std::uint8_t>;

void blob_write(const opms_location_t &location, Blob &blob);
bool blob_read(BlobView blob, opms_location_t &location);
void blob_write(const std::vector<opms_square_t> &squares, Blob &blob);
bool blob_read(BlobView blob, std::vector<opms_square_t> &squares);
void blob_write(const std::vector<opms_edge_t> &edges, Blob &blob);
bool blob_read(BlobView blob, std::vector<opms_edge_t> &edges);
void blob_write(const opms_transform_t &transform, Blob &blob);
bool blob_read(BlobView blob, opms_transform_t &transform);
void blob_write(const std::vector<double> &numbers, Blob &blob);
bool blob_read(BlobView blob, std::vector<double> &numbers);

}  // namespace opms_host
#endif
