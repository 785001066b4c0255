/* SPDX-License-Identifier: Apache-2.0 */
/* Our own keys are written from the values; of an old file only the others are taken. The new text
 * is read once before it replaces anything. */
#include "camera_file_write.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <system_error>

#include "camera_old.hpp"
#include "camera_parts.hpp"

namespace opms_host {
namespace {

namespace fs = std::filesystem;

/** Throws where something stands at @p path that must not be replaced. Nothing there: no value. */
std::optional<CameraFile> read_old(const std::string &path)
{
    if (!fs::exists(path)) {
        return std::nullopt;
    }
    if (!fs::is_regular_file(path)) {
        throw FieldError("is there and is no file");
    }
    if (fs::file_size(path) == 0) {
        return std::nullopt; /* as mktemp leaves it */
    }
    return camera_read_old(path);
}

/** Those of the old file that the new one does not have itself. */
void add_missing(const std::vector<CameraExtra> &old, std::vector<CameraExtra> &extras)
{
    for (const CameraExtra &extra : old) {
        const bool there =
            std::any_of(extras.begin(), extras.end(),
                        [&](const CameraExtra &other) { return other.name == extra.name; });
        if (!there) {
            extras.push_back(extra);
        }
    }
}

/** The file with what an old one has beyond it: name, unknown keys, comments. */
CameraFile with_old(const CameraFile &file, const std::optional<CameraFile> &old)
{
    CameraFile all = file;
    if (!old) {
        return all;
    }
    all.name = file.name.empty() ? old->name : file.name;
    add_missing(old->extras, all.extras);
    add_missing(old->opms_extras, all.opms_extras);
    for (const CameraComment &comment : old->comments) {
        const bool there = std::any_of(
            file.comments.begin(), file.comments.end(), [&](const CameraComment &other) {
                return other.name == comment.name && other.text == comment.text;
            });
        if (!there) {
            all.comments.push_back(comment);
        }
    }
    return all;
}

std::string text_in(CameraFormat format, const CameraFile &file, std::vector<std::string> &notes)
{
    switch (format) {
    case CameraFormat::opencv_yaml:
        return camera_opencv_yaml_text(file, notes);
    case CameraFormat::opencv_xml:
        return camera_opencv_xml_text(file, notes);
    case CameraFormat::kalibr:
        return camera_kalibr_text(file);
    case CameraFormat::ros:
        break;
    }
    return camera_ros_text(file);
}

/** Nothing may take the place of a good file that cannot be read again. */
void check_text(const std::string &text, const CameraFile &file)
{
    CameraFile again;
    std::string error;
    if (!camera_file_parse(text.data(), text.size(), again, error)) {
        throw FieldError("would not be a camera file: " + error);
    }
    const opms_lens_t &a = again.camera.lens, &b = file.camera.lens;
    const bool same = a.width_px == b.width_px && a.height_px == b.height_px &&
                      a.fx_px == b.fx_px && a.fy_px == b.fy_px && a.cx_px == b.cx_px &&
                      a.cy_px == b.cy_px && a.k1 == b.k1 && a.k2 == b.k2 && a.p1 == b.p1 &&
                      a.p2 == b.p2;
    if (!same) {
        throw FieldError("would not hold the same numbers");
    }
}

/** Removes the file aside unless it was renamed. */
class AsideFile {
public:
    explicit AsideFile(const fs::path &target) : path_(target)
    {
        path_ += ".part-" + std::to_string(std::random_device{}());
    }
    AsideFile(const AsideFile &) = delete;
    AsideFile &operator=(const AsideFile &) = delete;
    ~AsideFile()
    {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    const fs::path &path() const { return path_; }
    void write(const std::string &text) const
    {
        errno = 0;
        std::ofstream out(path_, std::ios::binary | std::ios::trunc);
        out.write(text.data(), static_cast<std::streamsize>(text.size()));
        out.close();
        if (!out) {
            throw FieldError(std::string("cannot be written: ") +
                             (errno != 0 ? std::strerror(errno) : "write error"));
        }
    }
    void rename_to(const fs::path &target) const
    {
        std::error_code error;
        fs::rename(path_, target, error);
        if (error) {
            throw FieldError("cannot be written: " + error.message());
        }
    }

private:
    fs::path path_;
};

/** A link stays a link: the file it leads to is replaced. */
fs::path target_of(const std::string &path)
{
    return fs::exists(path) ? fs::canonical(path) : fs::path(path);
}

void replace_file(const std::string &path, const std::string &text)
{
    const fs::path target = target_of(path);
    const AsideFile aside(target);
    aside.write(text);
    if (fs::exists(target)) {
        std::error_code ignored;
        fs::permissions(aside.path(), fs::status(target).permissions(), ignored);
    }
    aside.rename_to(target);
}

template <typename Work>
bool guarded(const std::string &path, std::string &error, const Work &work) noexcept
{
    try {
        try {
            work();
            return true;
        } catch (const YAML::Exception &e) {
            error = path + ": is there and is not valid YAML: line " +
                    std::to_string(e.mark.line + 1) + ": " + e.msg;
        } catch (const fs::filesystem_error &e) {
            error = path + ": " + e.code().message();
        } catch (const std::exception &e) {
            error = path + ": " + e.what();
        }
    } catch (...) {
        error.clear(); /* no memory even for a message */
    }
    return false;
}

}  // namespace

bool camera_file_may_write(const std::string &path, std::string &error) noexcept
{
    return guarded(path, error, [&] {
        try {
            read_old(path);
        } catch (const FieldError &e) {
            throw FieldError(std::string(e.what()) + "; it is not overwritten");
        }
        const fs::path folder = fs::absolute(path).parent_path();
        if (!fs::is_directory(folder)) {
            throw FieldError("the folder " + folder.string() + " does not exist");
        }
        AsideFile(target_of(path)).write("\n");
    });
}

bool camera_file_write(const std::string &path, const CameraFile &file, std::string &error,
                       CameraFormat format, std::vector<std::string> *notes) noexcept
{
    return guarded(path, error, [&] {
        std::vector<std::string> told;
        const std::string text = text_in(format, with_old(file, read_old(path)), told);
        if (notes != nullptr) {
            notes->insert(notes->end(), told.begin(), told.end());
        }
        check_text(text, file);
        replace_file(path, text);
    });
}

}  // namespace opms_host
