#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/distance_matrix.h"
#include "analysis/mds.h"

namespace morphodesic::analysis {

struct SmacofOptions {
    std::size_t dimensions = 2;  ///< >= 1
    /// false: only the order of the distances counts (monotone regression; equal ones may come apart: primary approach)
    bool metric = true;
    std::size_t starts = 4;            ///< >= 1; the first is classical scaling, the others are random
    std::size_t max_iterations = 300;  ///< for the start that is refined; the others get a tenth for the selection
    double tolerance = 1e-6;           ///< stop when an iteration lowers the stress by less than this share, > 0
    std::uint64_t seed = 1;
    const Embedding* initial = nullptr;  ///< the first start, instead of classical scaling
};

struct SmacofRun {
    double stress = 0.0;            ///< stress-1 after the selection
    double distance_to_best = 0.0;  ///< root mean square distance to the best run after Procrustes alignment
};

/// Result of scaling by majorisation. Disparities are the distances themselves (metric) or the monotone regression of
/// the embedded distances on the order of the given ones, brought to their size (root mean square).
struct Smacof {
    Embedding embedding;                  ///< centred, on principal axes, signs fixed
    double stress = 0.0;                  ///< stress-1 = sqrt(sum (d - disparity)^2 / sum d^2) (Kruskal), 0 .. 1
    std::vector<double> stress_per_item;  ///< shares of the squared misfit, sum 1 (all 0 for a perfect fit)
    std::vector<double> disparities;      ///< condensed
    std::size_t iterations = 0;           ///< of the run that was kept, selection included
    bool converged = false;               ///< false: max_iterations reached, the last digits may still change
    std::vector<SmacofRun> runs;          ///< one per start
};

/// Least squares scaling: minimises sum (|x_i - x_j| - disparity_ij)^2 by Guttman transforms.
/// Source: de Leeuw 1977; Borg, Groenen 2005, chapters 8 and 9.
/// @throws std::invalid_argument if a distance is missing
[[nodiscard]] Smacof smacof(const DistanceMatrix& distances, const SmacofOptions& options);

/// The non-decreasing sequence nearest to y in the sense of (weighted) least squares (pool adjacent violators).
/// @param weights > 0, or empty for equal ones
[[nodiscard]] std::vector<double> isotonic_regression(std::span<const double> y, std::span<const double> weights = {});

/// Disparities of further distances in a non-metric map: linear between those of its own (equal distances share the
/// mean), in proportion beyond the smallest and the largest. NaN stays NaN.
/// @param distances, disparities  of the map, one each per pair, at least one
/// @throws std::invalid_argument if they differ in number or there are none
[[nodiscard]] std::vector<double> disparities_at(std::span<const double> further, std::span<const double> distances,
                                                 std::span<const double> disparities);

}  // namespace morphodesic::analysis
