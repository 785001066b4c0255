/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Marks that tell where the search head stands for the first calibration picture. */
#ifndef OPMS_PRINT_FOOTPRINT_HPP
#define OPMS_PRINT_FOOTPRINT_HPP

#include "print_job.hpp"

#include <string>
#include <vector>

namespace opms::print {

struct FootprintMarks {
    std::vector<Quad> quads;
    std::string words;
};

/** Ticks from the head's outline outwards along its own axes. An axis of which one end lies beyond
 * the lines gets one longer centre line at its other end instead of two ticks. A mark is moved as
 * little as needed to stand inside one white square.
 *
 * @param keep_out  Boxes that no mark may touch.
 * @throw JobError if not one mark falls on the lines */
FootprintMarks footprint_marks(const Footprint &footprint, const std::vector<Box> &keep_out);

} // namespace opms::print
#endif
