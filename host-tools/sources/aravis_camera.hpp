/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What is set and read at a GenICam camera. */
#ifndef OPMS_SOURCES_ARAVIS_CAMERA_HPP
#define OPMS_SOURCES_ARAVIS_CAMERA_HPP

#include <memory>
#include <string>

#include <arv.h>

#include "aravis_source.hpp"
#include "exposure_log.hpp"
#include "glib_pointers.hpp"

namespace opms_host {

/** A grey format. */
struct AravisFormat {
    ArvPixelFormat code;
    const char *name;
    opms_pixel_format_t grey;
    std::uint16_t white_level;
};

/** One opening of a camera. One thread at a time. */
class AravisCamera {
public:
    /** Open, choose a format, see what it can do. @return NULL on failure. */
    static std::unique_ptr<AravisCamera> open(const AravisPlace &place, std::string &error);

    ArvCamera *get() const { return camera_.get(); }
    const SourceTraits &traits() const { return traits_; }
    const AravisFormat &format() const { return *format_; }
    const std::string &id() const { return id_; }

    /** Trigger or own clock, no automatic exposure, exposure and gain where they are not NaN.
     * @param[out] setting  What is in force then. */
    bool prepare(const SourceStart &start, ExposureSetting &setting, std::string &error);
    /** Set what is not NaN, within the limits, and read back. */
    bool set_exposure(ExposureSetting &setting, std::string &error);
    /** A reader of exposure and gain out of each picture, where the camera puts them in.
     * @return NULL where it does not. */
    GObjectPtr<ArvChunkParser> chunk_parser();

private:
    explicit AravisCamera(GObjectPtr<ArvCamera> camera) : camera_(std::move(camera)) {}
    bool has(const char *feature) const;
    bool choose_format(const std::string &wanted, std::string &error);
    void choose_trigger(const std::string &wanted);
    bool describe(const AravisPlace &place, std::string &error);
    void describe_profile();
    bool set_trigger(const SourceStart &start, std::string &error);
    ExposureSetting read_exposure() const;

    GObjectPtr<ArvCamera> camera_;
    SourceTraits traits_;
    const AravisFormat *format_ = nullptr;
    std::string id_, trigger_;
};

}  // namespace opms_host
#endif
