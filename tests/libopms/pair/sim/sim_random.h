/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Seeded noise: the same on every machine. */
#ifndef SIM_RANDOM_H
#define SIM_RANDOM_H

#include <cmath>
#include <cstdint>

/** splitmix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014). */
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}

    uint64_t bits()
    {
        uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31);
    }
    /** 0 to less than 1. */
    double unit() { return double(bits() >> 11) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * unit(); }
    double log_uniform(double low, double high) { return low * std::pow(high / low, unit()); }
    double exponential(double mean) { return -mean * std::log(1 - unit()); }
    /** low to high, both included. */
    int64_t whole(int64_t low, int64_t high)
    {
        return low + int64_t(bits() % uint64_t(high - low + 1));
    }
    bool chance(double probability) { return unit() < probability; }

private:
    uint64_t state_;
};

#endif
