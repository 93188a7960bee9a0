#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace morphodesic::analysis {

/// One step of SplitMix64 (Steele, Lea, Flood 2014): a well mixed 64-bit word from any 64-bit word.
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

/// Uniform in [0, 1) from a word.
[[nodiscard]] constexpr double unit_interval(std::uint64_t word) {
    return static_cast<double>(word >> 11) * 0x1.0p-53;
}

/// Random numbers that are the same with every standard library. Streams of one seed are independent, so that parallel
/// tasks take stream = task number.
class Random {
public:
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(mix(mix(seed) ^ mix(~stream))) {}
    std::uint64_t word() { return mix(state_ += 0x9e3779b97f4a7c15ULL); }
    double uniform() { return unit_interval(word()); }
    /// Uniform in {0, ..., n - 1}, n >= 1, without bias.
    std::uint64_t below(std::uint64_t n) {
        const std::uint64_t limit = n * (~std::uint64_t{0} / n);
        for (;;) {
            if (const std::uint64_t w = word(); w < limit) return w % n;
        }
    }
    /// Standard normal (Box-Muller).
    double normal() {
        const double u = 1.0 - uniform(), v = uniform();
        return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
    }
    template <class T>
    void shuffle(std::vector<T>& items) {
        for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(i)]);
    }

private:
    std::uint64_t state_;
};

}  // namespace morphodesic::analysis
