#pragma once

#include <cstddef>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

struct DiffusionOptions {
    std::size_t neighbours = 10;  ///< k of the affinity graph, >= 1 (limited to n - 1)
    std::size_t iterations = 20;  ///< steps of the process, >= 0
};

/// Distances re-ranked by locally constrained diffusion on the graph of the k nearest neighbours, in [0, 1]:
///   A_ij = exp(-d_ij^2 / (s_i s_j)), s_i = distance to the k-th neighbour;  P = A restricted to the k nearest (and the
///   item itself), rows summing up to 1;  W <- P W P^T from W = symmetrised P;  result 1 - W_ij / sqrt(W_ii W_jj).
/// Missing distances have affinity 0; items without any distance stay missing. The numbers only rank: they are not path
/// lengths. Source: Yang, Koknar-Tezel, Latecki 2009; Donoser, Bischof 2013.
[[nodiscard]] DistanceMatrix diffused_distances(const DistanceMatrix& distances, const DiffusionOptions& options = {});

}  // namespace morphodesic::analysis
