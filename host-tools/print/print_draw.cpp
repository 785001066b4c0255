/* SPDX-License-Identifier: Apache-2.0 */
/* Shapes to PDF and SVG by Cairo. Both surfaces count in points: Cairo keeps 1/256 of a unit, so
 * that a shape is placed to 0.0014 mm. */
#include "print_job.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <cmath>
#include <memory>

namespace opms::print {
namespace {

constexpr double points_per_mm = 72.0 / 25.4;

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

cairo_status_t append_bytes(void *closure, const unsigned char *data, unsigned int length)
{
    try {
        static_cast<std::string *>(closure)->append(reinterpret_cast<const char *>(data), length);
        return CAIRO_STATUS_SUCCESS;
    } catch (...) { /* no exception may cross Cairo's C frames */
        return CAIRO_STATUS_NO_MEMORY;
    }
}

void check(cairo_status_t status)
{
    if (status != CAIRO_STATUS_SUCCESS) {
        throw std::runtime_error(std::string("drawing failed: ") + cairo_status_to_string(status));
    }
}

/** The pattern's (X down, Y right) as Cairo's (x right, y down). */
void move_to(cairo_t *cairo, Point point)
{
    cairo_move_to(cairo, point.y, point.x);
}

void add_box(cairo_t *cairo, const Box &box)
{
    cairo_rectangle(cairo, box.y0, box.x0, box.width(), box.height());
}

void draw_layer(cairo_t *cairo, const Layer &layer)
{
    cairo_set_source_rgb(cairo, layer.grey, layer.grey, layer.grey);
    for (const Box &box : layer.boxes) {
        add_box(cairo, box);
    }
    for (const Quad &quad : layer.quads) {
        move_to(cairo, quad[0]);
        for (size_t corner = 1; corner < quad.size(); ++corner) {
            cairo_line_to(cairo, quad[corner].y, quad[corner].x);
        }
        cairo_close_path(cairo);
    }
    cairo_fill(cairo);
}

void draw_text(cairo_t *cairo, const Text &text)
{
    cairo_save(cairo);
    move_to(cairo, text.at);
    if (text.upwards) {
        cairo_rotate(cairo, -std::acos(-1.0) / 2);
    }
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, text.size_mm);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, text.words.c_str(), &extents);
    if (extents.x_advance > text.room_mm) {
        cairo_set_font_size(cairo, text.size_mm * text.room_mm / extents.x_advance);
    }
    cairo_set_source_rgb(cairo, 0.0, 0.0, 0.0);
    cairo_show_text(cairo, text.words.c_str());
    cairo_restore(cairo);
}

void draw_ink(cairo_t *cairo, const Ink &ink)
{
    for (const Layer &layer : ink.layers) {
        draw_layer(cairo, layer);
    }
    for (const Text &text : ink.texts) {
        draw_text(cairo, text);
    }
}

void draw_page(cairo_t *cairo, const Sheet &sheet, const Page &page)
{
    cairo_save(cairo);
    cairo_scale(cairo, points_per_mm, points_per_mm);
    cairo_translate(cairo, -page.paper.y0, -page.paper.x0);
    cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
    add_box(cairo, page.paper);
    cairo_fill(cairo);
    cairo_save(cairo);
    add_box(cairo, page.window);
    cairo_clip(cairo);
    draw_ink(cairo, sheet.content);
    cairo_restore(cairo);
    draw_ink(cairo, page.margin);
    cairo_restore(cairo);
    cairo_show_page(cairo);
    check(cairo_status(cairo));
}

/** Flush a surface; only then are all bytes out and all failures known. */
void finish(cairo_surface_t *surface)
{
    cairo_surface_finish(surface);
    check(cairo_surface_status(surface));
}

std::string draw_pdf(const Sheet &sheet, const std::vector<Page> &pages)
{
    std::string bytes;
    const Box &paper = pages.front().paper;
    const Surface surface(cairo_pdf_surface_create_for_stream(append_bytes, &bytes,
                                                              paper.width() * points_per_mm,
                                                              paper.height() * points_per_mm),
                          cairo_surface_destroy);
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, sheet.title.c_str());
    /* No date: the same job gives the same bytes. */
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
    {
        const Context cairo(cairo_create(surface.get()), cairo_destroy);
        for (const Page &page : pages) {
            draw_page(cairo.get(), sheet, page);
        }
    }
    finish(surface.get());
    return bytes;
}

std::string draw_svg(const Sheet &sheet, const Page &page)
{
    std::string bytes;
    const Surface surface(cairo_svg_surface_create_for_stream(append_bytes, &bytes,
                                                              page.paper.width() * points_per_mm,
                                                              page.paper.height() * points_per_mm),
                          cairo_surface_destroy);
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PT);
    {
        const Context cairo(cairo_create(surface.get()), cairo_destroy);
        draw_page(cairo.get(), sheet, page);
    }
    finish(surface.get());
    return bytes;
}

} // namespace

std::vector<std::string> draw(const Sheet &sheet, const std::vector<Page> &pages, Format format)
{
    if (format == Format::pdf) {
        return {draw_pdf(sheet, pages)};
    }
    std::vector<std::string> files;
    for (const Page &page : pages) {
        files.push_back(draw_svg(sheet, page));
    }
    return files;
}

} // namespace opms::print
