/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Seeded chance that is the same on every machine. Each use has a stream of its own, so that more
 * draws for one thing do not change another one's. */
#ifndef OPMS_SIMULATED_WORLD_RANDOM_HPP
#define OPMS_SIMULATED_WORLD_RANDOM_HPP

#include <cmath>
#include <cstdint>

namespace opms_host {

enum class Chance : std::uint64_t {
    identity = 1, usb, ping, host_stall, link, box_fault, report_fault, history_fault,
    camera, camera_fault, frame_fault, picture, light, hide, sensor
};

/** splitmix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014). */
class WorldRandom {
public:
    WorldRandom(std::uint64_t seed, Chance use)
        : state_(seed * 0xd1342543de82ef95U + static_cast<std::uint64_t>(use) * 0x9e3779b97f4a7c15U)
    {
        bits();
    }

    std::uint64_t bits()
    {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
    /** 0 (included) to 1 (excluded). */
    double unit() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * unit(); }
    double log_uniform(double low, double high) { return low * std::pow(high / low, unit()); }
    double exponential(double mean) { return -mean * std::log(1 - unit()); }
    bool chance(double probability) { return unit() < probability; }
    /** low to high, both included. */
    std::int64_t whole(std::int64_t low, std::int64_t high)
    {
        return low + static_cast<std::int64_t>(bits() % static_cast<std::uint64_t>(high - low + 1));
    }
    /** A time within a range of milliseconds. */
    std::int64_t ns_of_ms(double low, double high)
    {
        return static_cast<std::int64_t>(uniform(low, high) * 1e6);
    }
    /** Mean 0, standard deviation 1 (Box and Muller). */
    double normal()
    {
        const double radius = std::sqrt(-2 * std::log(1 - unit()));
        return radius * std::cos(6.283185307179586 * unit());
    }

private:
    std::uint64_t state_;
};

}  // namespace opms_host
#endif
