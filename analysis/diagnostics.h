#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/distance_matrix.h"
#include "analysis/linkage.h"

namespace morphodesic::analysis {

/// d(first, last) > d(first, via) + d(via, last).
struct TriangleViolation {
    std::size_t first, via, last;  ///< first < last
    double excess;                 ///< by how much, > 0
    double error;                  ///< sum of the three error bars; NaN if one of them is not known
};

struct TriangleReport {
    std::size_t triangles = 0;             ///< with three known distances; all of them are checked
    std::size_t violated = 0;              ///< beyond rounding (1e-12 of the long side)
    std::size_t beyond_error = 0;          ///< also beyond the sum of the three error bars (unknown bars count as 0)
    std::vector<TriangleViolation> worst;  ///< by excess, at most one for each long side
};
/// Checks every triangle: O(n^3), in cache-sized blocks on all threads (2000 items: 1.3e9 triangles).
[[nodiscard]] TriangleReport triangle_violations(const DistanceMatrix& distances, std::size_t worst_shown = 20);

/// Path lengths of one pair in both directions.
struct DirectedPair {
    std::size_t first, second;
    double forward, backward;                          ///< first to second, second to first
    [[nodiscard]] double relative_difference() const;  ///< |forward - backward| / mean of both; 0 if both are 0
};
struct AsymmetryReport {
    std::size_t pairs = 0;
    double median = 0.0, largest = 0.0;  ///< relative differences; NaN without pairs
    std::vector<DirectedPair> worst;
};
/// Pairs with a missing direction are passed over.
[[nodiscard]] AsymmetryReport asymmetry(std::span<const DirectedPair> pairs, std::size_t worst_shown = 20);

/// Two clusters that the error bars do not hold apart.
struct CloseClusters {
    std::size_t first, second;  ///< clusters
    double separation;  ///< mean distance between the two - mean of their inner mean distances (single members: 0)
    double error;       ///< mean error bar of the distances that enter; bars do not average out, they may be systematic
};
/// Pairs of clusters with separation <= error, nearest to each other first. Empty if the matrix has no error bars.
[[nodiscard]] std::vector<CloseClusters> close_clusters(const DistanceMatrix& distances, const Clustering& clusters);

/// Do the clusters survive when the distances move within their error bars?
struct ClusterStability {
    std::size_t cluster;
    std::size_t members;
    double jaccard;  ///< mean over runs of the largest Jaccard index with a cluster of the run (Hennig 2007)
};
struct StabilityReport {
    std::size_t runs = 0;    ///< 0: there are no error bars, nothing was done
    double mean_rand = 0.0;  ///< adjusted Rand index between run and study
    std::vector<ClusterStability> clusters;
    /// [n] share of the other members of its cluster that an item stays with, mean over runs; for a single member how
    /// often it is alone
    std::vector<double> item_stability;
};
/// Each run draws every distance uniformly from its error bar (not below 0; without bar it stays), clusters anew and
/// cuts into as many clusters as `clusters` has. Deterministic for a seed, on any number of threads.
[[nodiscard]] StabilityReport cluster_stability(const DistanceMatrix& distances, const Clustering& clusters,
                                                LinkageMethod method, std::size_t runs, std::uint64_t seed);

}  // namespace morphodesic::analysis
