#pragma once

#include <cstdint>
#include <random>

namespace morphodesic::datasets {

/// Random numbers that are the same with every standard library.
class RandomSource {
public:
    explicit RandomSource(std::uint64_t seed) : engine_(seed) {}

    double uniform(double low, double high) {
        return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
    }

private:
    std::mt19937_64 engine_;
};

}  // namespace morphodesic::datasets
