#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

/// What was done about missing distances, for the methods that need all of them (linkage, embedding, medoids, ...).
struct GapTreatment {
    DistanceMatrix complete;            ///< of the kept items, without gaps
    std::vector<std::size_t> kept;      ///< numbers in the given matrix, increasing
    std::vector<std::size_t> left_out;  ///< the others: no chain of known distances joins them to the kept ones
    std::vector<std::pair<std::size_t, std::size_t>>
        filled;               ///< pairs (numbers in the given matrix) that were filled in
    std::string description;  ///< one sentence for the reader; empty without gaps
};

/// Treatment: the items that hang together through known distances are kept (the largest such group; of equally large
/// ones that with the first label), all others are left out. A missing distance between kept items becomes the length
/// of the shortest path through known distances, which is an upper bound of any metric that has these distances. If the
/// matrix has error bars, the filled ones get upper minus lower bound, the lower bound being max_k |d(i, k) - d(k, j)|.
/// O(n^3) if anything is missing (Floyd-Warshall by blocks), else O(n^2).
[[nodiscard]] GapTreatment fill_gaps(const DistanceMatrix& distances);

/// Shortest paths between all nodes. @param lengths row-major [n x n], symmetric, +infinity where there is no edge;
/// overwritten by the path lengths.
void shortest_paths(std::vector<double>& lengths, std::size_t n);

}  // namespace morphodesic::analysis
