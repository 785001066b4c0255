/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Records by formula: all of the n-th record follows from n, so that a checker that knows the
 * formulas (made_truth.py has them, too) can tell whether a row is right. */
#ifndef OPMS_TESTS_MADE_RECORDS_HPP
#define OPMS_TESTS_MADE_RECORDS_HPP

#include <cstdint>

#include "scan_records.hpp"

namespace made {

/** Exact in binary, of either sign. */
double real(std::uint64_t n, std::uint64_t k);

opms_host::ScanHeader header(const std::string &name);
opms_host::FrameRecord frame(std::uint64_t n);
opms_host::TriggerRecord trigger(std::uint64_t n);
opms_host::PairRecord pair(std::uint64_t n);
std::shared_ptr<const opms_host::PoseRecord> pose(std::uint64_t n, std::size_t edges);
opms_host::EventRecord event(std::uint64_t n);
opms_host::ClockRecord clock(std::uint64_t n);
opms_host::BoxReportRecord box_report(std::uint64_t n);
opms_host::SensorRecord sensor(std::uint64_t n);
opms_host::ScanEnd end(const std::string &reason);
/** Grey level (3 x + 5 y + 11 n) modulo 256, or that times 257 with 16 bit. */
opms_host::FramePtr picture(std::uint64_t n, std::int32_t width_px, std::int32_t height_px,
                            bool is_16_bit);

}  // namespace made
#endif
