/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Prints true to scale: the marker bar, the calibration grid and the evaluation sheet.
 *
 * Use: make_sheet() lays a product out, make_pages() puts it on one page or on tiles, draw() gives
 * the bytes of the files, write_files() puts them on disk. */
#ifndef OPMS_PRINT_JOB_HPP
#define OPMS_PRINT_JOB_HPP

#include "print_shapes.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace opms::print {

enum class Product { bar, grid, evaluation };
enum class BarKind { hope33, apriltag33 };
enum class Paper { one_page, a4, a3 };
enum class Format { pdf, svg };

/** Where the search head stands on the grid for the first picture. */
struct Footprint {
    double x_mm = 350.0;
    double y_mm = 0.0;
    double yaw_deg = 0.0;
    double head_diameter_mm = 200.0;
};

struct Job {
    Product product = Product::bar;
    BarKind bar = BarKind::hope33;
    Footprint footprint;
};

/** The job asks for something that cannot be printed; what() says what and why. */
class JobError : public std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/** A file could not be written; what() names it. */
class FileError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct OutputFile {
    std::string path;
    std::string bytes;
};

/** Lay a product out. @throw JobError */
Sheet make_sheet(const Job &job);

/** Put a sheet on paper: one page of its own size, or tiles with marks, rulers and numbers. */
std::vector<Page> make_pages(const Sheet &sheet, Paper paper);

/** Draw pages: a PDF of all of them (one string), or one SVG for each.
 * @throw std::runtime_error if Cairo fails */
std::vector<std::string> draw(const Sheet &sheet, const std::vector<Page> &pages, Format format);

/** Write all files aside first and rename them then, so that none is ever seen half written.
 * @throw FileError; then no file aside is left behind */
void write_files(const std::vector<OutputFile> &files);

} // namespace opms::print
#endif
