#pragma once

#include <cstddef>
#include <vector>

#include "analysis/distance_matrix.h"
#include "analysis/linkage.h"

namespace morphodesic::analysis {

struct KMedoids {
    std::vector<std::size_t> medoids;  ///< item that stands for each cluster, increasing; cluster c has medoids[c]
    Clustering clusters;               ///< cluster of each item: the nearest medoid, of equally near ones the first
    double cost = 0.0;                 ///< sum of distances to the medoids
    std::size_t swaps = 0;             ///< improvements made after the greedy start
};

/// Partition around medoids: greedy start (BUILD), then the best swap of a medoid and another item as long as one
/// lowers the cost, all k swaps of a candidate evaluated at once in O(n). A local optimum of the swap neighbourhood.
/// Source: Kaufman, Rousseeuw 1990; Schubert, Rousseeuw 2019 (FastPAM1).
/// @param k 1 <= k <= n
/// @throws std::invalid_argument if a distance is missing or k is out of range
[[nodiscard]] KMedoids k_medoids(const DistanceMatrix& distances, std::size_t k);

}  // namespace morphodesic::analysis
