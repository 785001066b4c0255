/* SPDX-License-Identifier: Apache-2.0 */
#include "report_file.hpp"

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

#include "report_page.hpp"

namespace {

namespace fs = std::filesystem;

/** A file that is written beside its place; gone again unless it was moved there. */
class Draft {
public:
    explicit Draft(const fs::path &place) : place_(place), path_(place)
    {
        path_ += ".part-" + std::to_string(std::random_device{}());
    }
    Draft(const Draft &) = delete;
    Draft &operator=(const Draft &) = delete;
    ~Draft()
    {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    bool write(const std::string &text, std::string &error) const
    {
        errno = 0;
        std::ofstream out(path_, std::ios::binary | std::ios::trunc);
        out.write(text.data(), static_cast<std::streamsize>(text.size()));
        out.close();
        if (!out) {
            error = place_.string() + ": cannot be written: " +
                    (errno != 0 ? std::strerror(errno) : "write error");
            return false;
        }
        return true;
    }
    bool put_in_place(std::string &error) const
    {
        std::error_code code;
        fs::rename(path_, place_, code);
        if (code) {
            error = place_.string() + ": cannot be written: " + code.message();
        }
        return !code;
    }

private:
    fs::path place_, path_;
};

bool write_both(const fs::path &folder, const ReportJson &report, std::string &error)
{
    const Draft page(folder / "report.html"), data(folder / "report.json");
    /* A file's name may be any bytes. */
    const std::string json = report.dump(-1, ' ', false, ReportJson::error_handler_t::replace);
    return page.write(report_page(report), error) && data.write(json + "\n", error) &&
           data.put_in_place(error) && page.put_in_place(error);
}

}  // namespace

bool report_open_folder(const std::string &folder, std::string &error)
{
    std::error_code code;
    fs::create_directories(folder, code);
    if (!fs::is_directory(folder, code)) {
        error = folder + ": cannot make the report's folder: " +
                (code ? code.message() : std::string("a file of that name is in the way"));
        return false;
    }
    for (const char *name : {"report.html", "report.json"}) {
        if (fs::is_directory(fs::path(folder) / name, code)) {
            error = (fs::path(folder) / name).string() + ": is a folder, so no report can be there";
            return false;
        }
    }
    const Draft trial(fs::path(folder) / "report.html");
    return trial.write(std::string(), error);
}

bool report_write(const std::string &folder, const ReportJson &report, std::string &error)
{
    try {
        return write_both(folder, report, error);
    } catch (const std::exception &e) {
        error = folder + ": the report cannot be written: " + e.what();
    }
    return false;
}
