#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

struct MovedNeighbours {
    std::size_t item;  ///< number in the labels of the comparison
    /// Share of the k nearest that both matrices agree on, 0 .. 1; items as near as the k-th count with both.
    double overlap;
    std::string nearest_here, nearest_there;  ///< labels of the nearest items; "" if no distance is known
};

/// Two matrices over the labels that both have.
struct MatrixComparison {
    std::vector<std::string> labels;                      ///< in both, in the order of the first
    std::size_t pairs = 0;                                ///< known in both
    double pearson = 0.0, spearman = 0.0, kendall = 0.0;  ///< over those pairs (tau-b); NaN if a side is constant
    std::size_t neighbours = 0;                           ///< k of the overlaps
    double mean_overlap = 0.0;
    std::vector<MovedNeighbours> moved;  ///< items whose k nearest differ, least overlap first
};
/// @param neighbours k >= 1
[[nodiscard]] MatrixComparison compare(const DistanceMatrix& here, const DistanceMatrix& there, std::size_t neighbours);

/// Kendall's tau-b over the positions where both are numbers, O(n log n); NaN if one side is constant.
[[nodiscard]] double kendall_correlation(std::span<const double> x, std::span<const double> y);

}  // namespace morphodesic::analysis
