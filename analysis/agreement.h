#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace morphodesic::analysis {

/// Agreement of two partitions of the same items.
struct Agreement {
    double adjusted_rand = 0.0;                  ///< 1: equal, 0: as expected by chance (Hubert, Arabie 1985)
    double mutual_information = 0.0;             ///< in nats
    double normalized_mutual_information = 0.0;  ///< divided by the mean of the two entropies
    double adjusted_mutual_information = 0.0;    ///< the same, corrected for chance (Vinh, Epps, Bailey 2010)
};
/// @param a, b part of each item, numbered from 0
/// @throws std::invalid_argument if the lengths differ. No items: all values NaN.
[[nodiscard]] Agreement agreement(std::span<const std::size_t> a, std::span<const std::size_t> b);
/// Over labelled items only (class "" means unlabelled).
[[nodiscard]] Agreement agreement(std::span<const std::size_t> clusters, std::span<const std::string> classes);
/// Only the adjusted Rand index, in O(n + parts^2).
[[nodiscard]] double adjusted_rand(std::span<const std::size_t> a, std::span<const std::size_t> b);

}  // namespace morphodesic::analysis
