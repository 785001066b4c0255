/* SPDX-License-Identifier: Apache-2.0 */
#include <array>
#include <charconv>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "print_job.hpp"

namespace {

namespace print = opms::print;

/** The command line as given; pointers tell what was given at all. */
struct Options {
    std::string product;
    std::string out;
    std::string bar = "hope33";
    std::string tile;
    std::string footprint;
    double head_diameter_mm = print::Footprint{}.head_diameter_mm;
    bool json = false;
    const CLI::Option *bar_option = nullptr;
    const CLI::Option *footprint_option = nullptr;
    const CLI::Option *head_option = nullptr;
};

print::Product product_of(const std::string &name)
{
    if (name == "bar") {
        return print::Product::bar;
    }
    return name == "grid" ? print::Product::grid : print::Product::evaluation;
}

print::Paper paper_of(const std::string &tile)
{
    if (tile.empty()) {
        return print::Paper::one_page;
    }
    return tile == "a3" ? print::Paper::a3 : print::Paper::a4;
}

print::Format format_of(const std::string &out)
{
    const std::string extension = std::filesystem::path(out).extension().string();
    if (extension == ".pdf" || extension == ".PDF") {
        return print::Format::pdf;
    }
    if (extension == ".svg" || extension == ".SVG") {
        return print::Format::svg;
    }
    throw print::JobError("--out " + out + ": the file's name must end in .pdf or .svg");
}

/** Three numbers with commas between them, whatever the locale. */
std::array<double, 3> three_numbers(const std::string &text)
{
    std::array<double, 3> numbers{};
    const char *at = text.data();
    const char *const end = at + text.size();
    for (size_t i = 0; i < numbers.size(); ++i) {
        const auto [next, error] = std::from_chars(at, end, numbers[i]);
        const bool last = i + 1 == numbers.size();
        if (error != std::errc() || (last ? next != end : next == end || *next != ',')) {
            throw print::JobError("--footprint " + text +
                                  ": give three numbers X_MM,Y_MM,YAW_DEG, such as 350,0,0");
        }
        at = next + 1;
    }
    return numbers;
}

print::Job job_of(const Options &options)
{
    print::Job job;
    job.product = product_of(options.product);
    const bool is_bar = job.product == print::Product::bar;
    if (!is_bar && options.bar_option->count() > 0) {
        throw print::JobError("--bar goes with `print bar` only; the evaluation sheet always "
                              "carries hope33");
    }
    if (is_bar && (options.footprint_option->count() > 0 || options.head_option->count() > 0)) {
        throw print::JobError("--footprint and --head-diameter-mm go with `print grid` and `print "
                              "evaluation` only");
    }
    job.bar = options.bar == "hope33" ? print::BarKind::hope33 : print::BarKind::apriltag33;
    job.footprint.head_diameter_mm = options.head_diameter_mm;
    if (options.footprint_option->count() > 0) {
        const std::array<double, 3> numbers = three_numbers(options.footprint);
        job.footprint.x_mm = numbers[0];
        job.footprint.y_mm = numbers[1];
        job.footprint.yaw_deg = numbers[2];
    }
    return job;
}

/** One file holds all pages of a PDF; SVG knows no pages, so tiles are NAME-1.svg, NAME-2.svg. */
std::vector<print::OutputFile> named(const std::string &out, std::vector<std::string> contents)
{
    if (contents.size() == 1) {
        return {{out, std::move(contents.front())}};
    }
    const std::filesystem::path path(out);
    std::vector<print::OutputFile> files;
    for (std::string &bytes : contents) {
        const std::string name = path.stem().string() + "-" + std::to_string(files.size() + 1) +
                                 path.extension().string();
        files.push_back({(path.parent_path() / name).string(), std::move(bytes)});
    }
    return files;
}

nlohmann::json span_of(double from, double to)
{
    return nlohmann::json::array({from, to});
}

nlohmann::json page_json(const print::Page &page)
{
    const auto box = [](const print::Box &b) {
        return nlohmann::json{{"x", span_of(b.x0, b.x1)}, {"y", span_of(b.y0, b.y1)}};
    };
    return {{"number", page.number},
            {"row", page.row},
            {"column", page.column},
            {"width_mm", page.paper.width()},
            {"height_mm", page.paper.height()},
            {"paper_mm", box(page.paper)},
            {"window_mm", box(page.window)}};
}

void report_json(const Options &options, const std::string &path,
                 const std::vector<print::Page> &pages)
{
    nlohmann::json row = {{"schema", "opms.print/1"},
                          {"file", path},
                          {"product", options.product},
                          {"pages", nlohmann::json::array()}};
    if (options.product == "bar") {
        row["bar"] = options.bar;
    }
    for (const print::Page &page : pages) {
        row["pages"].push_back(page_json(page));
    }
    std::cout << row.dump() << '\n';
}

void report(const Options &options, const std::string &path, const std::vector<print::Page> &pages)
{
    if (options.json) {
        report_json(options, path, pages);
        return;
    }
    const print::Box &paper = pages.front().paper;
    std::cout << path << ": " << pages.size() << (pages.size() == 1 ? " page" : " pages") << " of "
              << paper.width() << " x " << paper.height() << " mm\n";
}

void print_files(const Options &options)
{
    const print::Format format = format_of(options.out);
    const print::Sheet sheet = print::make_sheet(job_of(options));
    const std::vector<print::Page> pages = print::make_pages(sheet, paper_of(options.tile));
    const std::vector<print::OutputFile> files =
        named(options.out, print::draw(sheet, pages, format));
    print::write_files(files);
    for (size_t i = 0; i < files.size(); ++i) {
        report(options, files[i].path,
               files.size() == 1 ? pages : std::vector<print::Page>{pages[i]});
    }
    std::cerr << "Print at 100 %, then check both rulers: 100.0 mm.\n";
}

int run_print(const Options &options)
{
    try {
        print_files(options);
        return 0;
    } catch (const print::JobError &error) {
        std::cerr << "opms print: " << error.what() << '\n';
        return EXIT_CODE_USAGE;
    } catch (const std::exception &error) {
        std::cerr << "opms print: " << error.what() << '\n';
        return EXIT_CODE_INPUT;
    }
}

} // namespace

void add_cmd_print(CLI::App &app, int &exit_code)
{
    const auto options = std::make_shared<Options>();
    CLI::App *command = app.add_subcommand(
        "print", "Print the marker bar, the calibration grid or the evaluation sheet, true to "
                 "scale, as PDF or SVG");
    command->add_option("product", options->product, "bar, grid or evaluation")
        ->required()
        ->check(CLI::IsMember({"bar", "grid", "evaluation"}));
    command
        ->add_option("--out", options->out,
                     "File to write, .pdf or .svg; SVG tiles become NAME-1.svg, NAME-2.svg, ...")
        ->required()
        ->type_name("FILE");
    options->bar_option = command->add_option("--bar", options->bar, "Kind of bar")
                              ->check(CLI::IsMember({"hope33", "apriltag33"}))
                              ->capture_default_str();
    command->add_option("--tile", options->tile, "Split into sheets of this paper, to be joined")
        ->check(CLI::IsMember({"a4", "a3"}));
    options->head_option = command
                               ->add_option("--head-diameter-mm", options->head_diameter_mm,
                                            "Diameter of the search head")
                               ->capture_default_str();
    options->footprint_option =
        command
            ->add_option("--footprint", options->footprint,
                         "Where the head stands for the first picture [350,0,0]")
            ->type_name("X_MM,Y_MM,YAW_DEG");
    command->add_flag("--json", options->json, "Report each file as one JSON object");
    command->callback([options, &exit_code] { exit_code = run_print(*options); });
}
