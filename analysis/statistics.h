#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

/// NaN for no numbers.
[[nodiscard]] double mean(std::span<const double> values);
/// Linear between order statistics (NumPy's default), q in [0, 1]; NaN for no numbers.
[[nodiscard]] double quantile(std::vector<double> values, double q);
/// Over the positions where both are numbers; NaN if fewer than two or one side is constant.
[[nodiscard]] double pearson_correlation(std::span<const double> x, std::span<const double> y);
/// 1, 2, ...; equal values share the mean of their ranks; NaN stays NaN.
[[nodiscard]] std::vector<double> ranks(std::span<const double> values);
/// Pearson correlation of the ranks.
[[nodiscard]] double spearman_correlation(std::span<const double> x, std::span<const double> y);

/// Silhouette width of every item: (b - a) / max(a, b), a = mean distance to its own cluster, b = mean distance to the
/// nearest other one. 0 for the only member of a cluster and where a = b = 0; with one cluster all are 0.
/// Missing distances do not enter the means. Source: Rousseeuw 1987.
/// @param clusters cluster of each item, numbered from 0
[[nodiscard]] std::vector<double> silhouette_widths(const DistanceMatrix& distances,
                                                    const std::vector<std::size_t>& clusters);

}  // namespace morphodesic::analysis
