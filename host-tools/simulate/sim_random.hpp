/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Random numbers that are the same on every machine (the standard library's distributions are
 * not): xoshiro256** by Blackman and Vigna, seeded by splitmix64; normals by Marsaglia's polar
 * method.
 *
 * Each use has its own stream, so that one setting's numbers do not shift another's. */
#ifndef OPMS_SIMULATE_SIM_RANDOM_HPP
#define OPMS_SIMULATE_SIM_RANDOM_HPP

#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>

namespace opms::simulate
{

enum class Stream : std::uint64_t { POSE = 1, GROUND, LIGHT, GRASS, NOISE };

class Random
{
  public:
    Random(std::uint64_t seed, Stream stream, std::uint64_t part = 0)
    {
        std::uint64_t x = seed * 0x9e3779b97f4a7c15U ^ static_cast<std::uint64_t>(stream) << 56U ^
                          part * 0xd1342543de82ef95U;
        for (std::uint64_t &word : state_) {
            x += 0x9e3779b97f4a7c15U;
            std::uint64_t z = x;
            z = (z ^ z >> 30U) * 0xbf58476d1ce4e5b9U;
            z = (z ^ z >> 27U) * 0x94d049bb133111ebU;
            word = z ^ z >> 31U;
        }
    }

    /** Even in 0 (included) .. 1 (excluded). */
    double uniform()
    {
        return static_cast<double>(next() >> 11U) * 0x1p-53;
    }
    double uniform(double low, double high)
    {
        return low + (high - low) * uniform();
    }
    double uniform(const cv::Vec2d &range)
    {
        return uniform(range[0], range[1]);
    }

    /** Mean 0, standard deviation 1. */
    double normal()
    {
        if (has_spare_) {
            has_spare_ = false;
            return spare_;
        }
        double a = 0, b = 0, q = 0;
        do {
            a = uniform(-1, 1);
            b = uniform(-1, 1);
            q = a * a + b * b;
        } while (q >= 1 || q == 0);
        const double scale = std::sqrt(-2 * std::log(q) / q);
        spare_ = b * scale;
        has_spare_ = true;
        return a * scale;
    }

  private:
    static std::uint64_t rotate(std::uint64_t x, unsigned by)
    {
        return x << by | x >> (64U - by);
    }
    std::uint64_t next()
    {
        const std::uint64_t result = rotate(state_[1] * 5, 7) * 9;
        const std::uint64_t t = state_[1] << 17U;
        state_[2] ^= state_[0];
        state_[3] ^= state_[1];
        state_[1] ^= state_[2];
        state_[0] ^= state_[3];
        state_[2] ^= t;
        state_[3] = rotate(state_[3], 45);
        return result;
    }

    std::uint64_t state_[4];
    double spare_ = 0;
    bool has_spare_ = false;
};

} // namespace opms::simulate
#endif
