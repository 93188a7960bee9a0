#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/distance_matrix.h"
#include "analysis/linkage.h"

namespace morphodesic::analysis {

struct LeafOrder {
    std::vector<std::size_t> order;  ///< leaves from left to right; clusters of the tree are ranges of it
    double length = 0.0;             ///< sum of distances of adjacent leaves
    bool optimal = true;             ///< false: too many leaves, each merge was only turned the better way round
};

/// Largest number of leaves that are ordered optimally (2 n^2 doubles of memory, up to about n^3 / 6 steps).
inline constexpr std::size_t optimal_order_limit = 5000;

/// Of all orders that the tree allows the one with the smallest sum of distances between adjacent leaves. Dynamic
/// programming over the pairs of outermost leaves of every cluster, as products of matrices in the (min, +) sense.
/// The end with the smaller label comes first. Source: Bar-Joseph, Gifford, Jaakkola 2001; checked
/// against all orders of small trees, where those of SciPy 1.10 turned out to be longer at times.
/// @throws std::invalid_argument if a distance is missing
[[nodiscard]] LeafOrder optimal_leaf_order(const Dendrogram& tree, const DistanceMatrix& distances,
                                           std::size_t limit = optimal_order_limit);

/// Sum of distances of adjacent items.
[[nodiscard]] double order_length(std::span<const std::size_t> order, const DistanceMatrix& distances);

}  // namespace morphodesic::analysis
