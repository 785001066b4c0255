/* SPDX-License-Identifier: Apache-2.0 */
#include "world_frame.hpp"

#include <cmath>

#include "world_agenda.hpp"

namespace opms_host {

namespace {

constexpr std::uint64_t IDS_OF_16_BIT = 65535; /* 0 is skipped */

}  // namespace

std::uint64_t world_raw_id(const WorldOptions &options, std::uint64_t id)
{
    return options.frame_id_bits == 16 ? 1 + (id - 1) % IDS_OF_16_BIT : id;
}

opms_camera_profile_t world_camera_profile(const WorldOptions &options)
{
    opms_camera_profile_t profile = {};
    profile.has_frame_id = 1;
    profile.frame_id_bits = options.frame_id_bits;
    profile.frame_id_skips_0 = options.frame_id_bits == 16 ? 1 : 0;
    profile.has_camera_time = options.camera_time ? 1 : 0;
    profile.camera_time_bits = options.camera_time ? 64 : 0;
    profile.camera_tick_hz = options.camera_time ? options.camera_tick_hz : 0;
    profile.has_strobe = options.strobe ? 1 : 0;
    profile.has_start_delay = 1;
    profile.start_delay_ns = static_cast<std::int64_t>(options.start_delay_us * NS_PER_US);
    return profile;
}

FramePtr world_frame(WorldPictures &pictures, const WorldOptions &options, const TrueFrame &truth,
                     std::shared_ptr<std::uint8_t> pixels)
{
    PictureExposure exposure;
    exposure.index = truth.picture;
    exposure.is_hidden = truth.is_hidden;
    exposure.is_damaged = truth.is_damaged;
    const double amplified = std::pow(10, truth.gain_db / 20);
    exposure.factor = truth.light * amplified * truth.exposure_us / options.exposure_us *
                      std::pow(10, -options.gain_db / 20);
    exposure.noise = options.noise * amplified;
    exposure.seed = options.seed + truth.exposure_number;
    pictures.expose(exposure, pixels.get());

    auto frame = std::make_shared<Frame>();
    frame->image = {pixels.get(), pictures.width_px(), pictures.height_px(),
                    pictures.width_px(), OPMS_PIXEL_GREY8, 0};
    frame->frame_id = truth.frame_id;
    frame->camera_time_ticks = truth.camera_time_ticks;
    frame->arrival_host_ns = truth.arrival_host_ns;
    frame->flags = 0;
    if (truth.is_damaged) {
        frame->flags |= OPMS_FRAME_DAMAGED;
    }
    if (!options.camera_time) {
        frame->flags |= OPMS_FRAME_NO_TIME;
    }
    frame->exposure_us = truth.exposure_us;
    frame->gain_db = truth.gain_db;
    frame->memory = std::move(pixels);
    return frame;
}

}  // namespace opms_host
