#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::tests {

/// "s0", "s1", ...
std::vector<std::string> numbered_labels(std::size_t n);
/// Euclidean distances of points, row-major [n x dimensions].
analysis::DistanceMatrix distances_of(const std::vector<double>& points, std::size_t dimensions);
/// n random points around `groups` centres at mutual distance of about `spread`; item i belongs to group i % groups.
analysis::DistanceMatrix grouped_matrix(std::size_t n, std::size_t groups, double spread, std::uint64_t seed);
/// Random integers 1..largest as distances: full of ties and of broken triangle inequalities.
analysis::DistanceMatrix tied_matrix(std::size_t n, int largest, std::uint64_t seed);
/// Item i of the result is item order[i] of the matrix, labels travel along.
analysis::DistanceMatrix reordered(const analysis::DistanceMatrix& matrix, const std::vector<std::size_t>& order);
std::vector<std::size_t> random_order(std::size_t n, std::uint64_t seed);

}  // namespace morphodesic::tests
