/* SPDX-License-Identifier: Apache-2.0 */
/* Names of features are of the GenICam standard features naming convention (EMVA, SFNC 2.7). */
#include "aravis_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace opms_host {
namespace {

constexpr std::uint64_t ARAVIS_TICK_HZ = 1'000'000'000; /* it turns all stamps into nanoseconds */
constexpr std::uint32_t GIGE_ID_BITS = 16;

const AravisFormat FORMATS[] = {
    {ARV_PIXEL_FORMAT_MONO_8, "Mono8", OPMS_PIXEL_GREY8, 255},
    {ARV_PIXEL_FORMAT_MONO_12, "Mono12", OPMS_PIXEL_GREY16, 4095},
    {ARV_PIXEL_FORMAT_MONO_10, "Mono10", OPMS_PIXEL_GREY16, 1023},
    {ARV_PIXEL_FORMAT_MONO_16, "Mono16", OPMS_PIXEL_GREY16, 65535},
};

std::string text_or_empty(const char *text)
{
    return text ? text : "";
}

/* The name by which a camera is found again: the list's own. */
std::string listed_id(ArvCamera *camera, const std::string &otherwise)
{
    GFailure failure;
    const std::string serial =
        text_or_empty(arv_camera_get_device_serial_number(camera, failure.fresh()));
    const std::string model = text_or_empty(arv_camera_get_model_name(camera, failure.fresh()));
    for (unsigned int i = 0; i < arv_get_n_devices(); ++i) {
        if (text_or_empty(arv_get_device_serial_nbr(i)) == serial &&
            text_or_empty(arv_get_device_model(i)) == model) {
            return text_or_empty(arv_get_device_id(i));
        }
    }
    return otherwise;
}

}  // namespace

std::unique_ptr<AravisCamera> AravisCamera::open(const AravisPlace &place, std::string &error)
{
    GFailure failure;
    GObjectPtr<ArvCamera> raw(
        arv_camera_new(place.name.empty() ? nullptr : place.name.c_str(), failure.fresh()));
    if (!raw) {
        error = place.name.empty() ? "no GenICam camera is found"
                                   : "no GenICam camera " + place.name + " is found";
        error += failure ? " (" + failure.text() + ")" : "";
        return nullptr;
    }
    std::unique_ptr<AravisCamera> camera(new AravisCamera(std::move(raw)));
    return camera->describe(place, error) ? std::move(camera) : nullptr;
}

bool AravisCamera::has(const char *feature) const
{
    GFailure failure;
    return arv_camera_is_feature_available(camera_.get(), feature, failure.fresh()) && !failure;
}

bool AravisCamera::choose_format(const std::string &wanted, std::string &error)
{
    GFailure failure;
    guint count = 0;
    const GMemory<gint64> offered(
        arv_camera_dup_available_pixel_formats(camera_.get(), &count, failure.fresh()));
    const auto offers = [&](const AravisFormat &format) {
        return offered && std::find(offered.get(), offered.get() + count,
                                    static_cast<gint64>(format.code)) != offered.get() + count;
    };
    const ArvPixelFormat current = arv_camera_get_pixel_format(camera_.get(), failure.fresh());
    for (const AravisFormat &format : FORMATS) {
        const bool fits = wanted.empty() ? format.code == current : format.name == wanted;
        if (fits && (format.code == current || offers(format))) {
            format_ = &format;
        }
    }
    if (!format_ && wanted.empty()) {
        const auto *const found = std::find_if(std::begin(FORMATS), std::end(FORMATS), offers);
        format_ = found == std::end(FORMATS) ? nullptr : found;
    }
    if (!format_) {
        error = id_ + " has no pixel format " + (wanted.empty() ? "Mono8, 10, 12 or 16" : wanted);
        return false;
    }
    if (format_->code != current) {
        arv_camera_set_pixel_format(camera_.get(), format_->code, failure.fresh());
    }
    error = failure ? id_ + " refuses " + format_->name + ": " + failure.text() : "";
    return error.empty();
}

void AravisCamera::choose_trigger(const std::string &wanted)
{
    GFailure failure;
    guint count = 0;
    const GMemory<const char *> sources(
        arv_camera_dup_available_trigger_sources(camera_.get(), &count, failure.fresh()));
    const std::string preferred = wanted.empty() ? "Line0" : wanted;
    for (guint i = 0; sources && i < count; ++i) {
        const std::string name = sources.get()[i];
        if (name == preferred || (wanted.empty() && trigger_.empty() &&
                                  name.compare(0, 4, "Line") == 0)) {
            trigger_ = name;
        }
    }
    traits_.can_trigger = !trigger_.empty();
}

bool AravisCamera::describe(const AravisPlace &place, std::string &error)
{
    ArvCamera *const camera = camera_.get();
    GFailure failure;
    id_ = listed_id(camera, place.name);
    if (!choose_format(place.format, error)) {
        return false;
    }
    choose_trigger(place.trigger);
    if (!place.trigger.empty() && !traits_.can_trigger) {
        error = id_ + " has no trigger input " + place.trigger;
        return false;
    }
    gint x = 0, y = 0;
    arv_camera_get_region(camera, &x, &y, &traits_.width_px, &traits_.height_px,
                          failure.fresh());
    if (failure || traits_.width_px < 1 || traits_.height_px < 1 || traits_.width_px > 16384 ||
        traits_.height_px > 16384) {
        error = id_ + ": its picture size cannot be used " + failure.text();
        return false;
    }
    traits_.name = "aravis:" + id_;
    traits_.model = text_or_empty(arv_camera_get_vendor_name(camera, failure.fresh())) + " " +
                    text_or_empty(arv_camera_get_model_name(camera, failure.fresh())) + " " +
                    text_or_empty(arv_camera_get_device_serial_number(camera, failure.fresh()));
    if (arv_camera_is_exposure_time_available(camera, failure.fresh())) {
        arv_camera_get_exposure_time_bounds(camera, &traits_.exposure_min_us,
                                            &traits_.exposure_max_us, failure.fresh());
    }
    if (has("Gain")) { /* the standard's, in dB; other features of gain have no unit */
        arv_camera_get_gain_bounds(camera, &traits_.gain_min_db, &traits_.gain_max_db,
                                   failure.fresh());
    }
    describe_profile();
    return true;
}

void AravisCamera::describe_profile()
{
    opms_camera_profile_t &profile = traits_.profile;
    GFailure failure;
    profile.has_frame_id = 1;
    profile.frame_id_bits = 64;
    profile.has_camera_time = 1;
    profile.camera_time_bits = 64;
    profile.camera_tick_hz = ARAVIS_TICK_HZ;
    if (!arv_camera_is_gv_device(camera_.get())) {
        return;
    }
    const std::string extended =
        has("GevGVSPExtendedIDMode")
            ? text_or_empty(arv_camera_get_string(camera_.get(), "GevGVSPExtendedIDMode",
                                                  failure.fresh()))
            : "";
    if (extended != "On") {
        profile.frame_id_bits = GIGE_ID_BITS;
        profile.frame_id_skips_0 = 1;
    }
    const guint64 tick_hz = arv_gv_device_get_timestamp_tick_frequency(
        ARV_GV_DEVICE(arv_camera_get_device(camera_.get())), failure.fresh());
    if (failure || tick_hz == 0) { /* it has no clock */
        profile.has_camera_time = 0;
        profile.camera_time_bits = 0;
        profile.camera_tick_hz = 0;
    }
}

bool AravisCamera::set_trigger(const SourceStart &start, std::string &error)
{
    ArvCamera *const camera = camera_.get();
    GFailure failure;
    if (start.hardware_trigger) {
        if (!traits_.can_trigger) {
            error = id_ + " has no input line for a trigger";
            return false;
        }
        arv_camera_set_trigger(camera, trigger_.c_str(), failure.fresh());
        error = failure ? id_ + " refuses the trigger on " + trigger_ + ": " + failure.text() : "";
        return error.empty();
    }
    arv_camera_clear_triggers(camera, failure.fresh());
    if (arv_camera_is_frame_rate_available(camera, failure.fresh())) {
        double least = 0, most = 0;
        arv_camera_get_frame_rate_bounds(camera, &least, &most, failure.fresh());
        const double wanted = start.frame_rate_hz;
        arv_camera_set_frame_rate(camera,
                                  most > least ? std::clamp(wanted, least, most) : wanted,
                                  failure.fresh());
    }
    error = failure ? id_ + " refuses the frame rate: " + failure.text() : "";
    return error.empty();
}

bool AravisCamera::prepare(const SourceStart &start, ExposureSetting &setting, std::string &error)
{
    ArvCamera *const camera = camera_.get();
    GFailure failure;
    arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, failure.fresh());
    if (failure) {
        error = id_ + ": " + failure.text();
        return false;
    }
    if (has("ExposureMode")) {
        arv_camera_set_exposure_mode(camera, ARV_EXPOSURE_MODE_TIMED, failure.fresh());
    }
    if (arv_camera_is_exposure_auto_available(camera, failure.fresh())) {
        arv_camera_set_exposure_time_auto(camera, ARV_AUTO_OFF, failure.fresh());
    }
    if (arv_camera_is_gain_auto_available(camera, failure.fresh())) {
        arv_camera_set_gain_auto(camera, ARV_AUTO_OFF, failure.fresh());
    }
    setting = {start.exposure_us, start.gain_db};
    return set_trigger(start, error) && set_exposure(setting, error);
}

bool AravisCamera::set_exposure(ExposureSetting &setting, std::string &error)
{
    GFailure failure;
    if (!std::isnan(setting.exposure_us) && traits_.exposure_max_us > 0) {
        arv_camera_set_exposure_time(camera_.get(),
                                     std::clamp(setting.exposure_us, traits_.exposure_min_us,
                                                traits_.exposure_max_us),
                                     failure.fresh());
        error = failure ? id_ + " refuses the exposure: " + failure.text() : "";
        if (failure) {
            return false;
        }
    }
    if (!std::isnan(setting.gain_db) && traits_.gain_max_db > traits_.gain_min_db) {
        arv_camera_set_gain(camera_.get(), std::clamp(setting.gain_db, traits_.gain_min_db,
                                                      traits_.gain_max_db),
                            failure.fresh());
        error = failure ? id_ + " refuses the gain: " + failure.text() : "";
        if (failure) {
            return false;
        }
    }
    setting = read_exposure();
    return true;
}

ExposureSetting AravisCamera::read_exposure() const
{
    ExposureSetting setting;
    GFailure failure;
    if (traits_.exposure_max_us > 0) {
        const double exposure_us = arv_camera_get_exposure_time(camera_.get(), failure.fresh());
        setting.exposure_us = failure ? NOT_KNOWN : exposure_us;
    }
    setting.gain_db = 0.0; /* where it cannot be set, all gains count from what it is */
    if (traits_.gain_max_db > traits_.gain_min_db) {
        const double gain_db = arv_camera_get_gain(camera_.get(), failure.fresh());
        setting.gain_db = failure ? NOT_KNOWN : gain_db;
    }
    return setting;
}

GObjectPtr<ArvChunkParser> AravisCamera::chunk_parser()
{
    GFailure failure;
    if (!arv_camera_are_chunks_available(camera_.get(), failure.fresh()) || failure) {
        return nullptr;
    }
    arv_camera_set_chunks(camera_.get(), "ExposureTime,Gain", failure.fresh());
    if (failure) {
        arv_camera_set_chunks(camera_.get(), "ExposureTime", failure.fresh());
    }
    if (failure) {
        return nullptr;
    }
    return GObjectPtr<ArvChunkParser>(arv_camera_create_chunk_parser(camera_.get()));
}

}  // namespace opms_host
