#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

enum class LinkageMethod {
    single,    ///< distance of the nearest members
    complete,  ///< distance of the farthest members
    average,   ///< mean distance of members (UPGMA)
    ward,      ///< growth of the sum of squares; its heights have a geometric meaning only for Euclidean distances
};
[[nodiscard]] const char* to_string(LinkageMethod method);
/// @throws std::invalid_argument if the name is none of single, complete, average, ward
[[nodiscard]] LinkageMethod parse_linkage_method(std::string_view name);

/// Merge number m makes cluster leaf_count + m; smaller numbers are leaves (SciPy's convention).
struct Merge {
    std::size_t first, second;  ///< clusters that are joined, first < second
    double height;              ///< their distance; never decreases from merge to merge
    std::size_t size;           ///< leaves of the new cluster
    friend bool operator==(const Merge&, const Merge&) = default;
};

struct Dendrogram {
    std::size_t leaf_count = 0;
    std::vector<Merge> merges;  ///< leaf_count - 1 of them (none for 0 or 1 leaves)
};

/// Hierarchical clustering by the nearest-neighbour chain: O(n^2) time and memory.
/// @throws std::invalid_argument if a distance is missing (see gaps.h)
/// Source: Muellner 2011, Modern hierarchical, agglomerative clustering algorithms; checked against scipy 1.10.
[[nodiscard]] Dendrogram linkage(const DistanceMatrix& distances, LinkageMethod method);
/// @param condensed n (n - 1) / 2 distances without NaN
[[nodiscard]] Dendrogram linkage(std::span<const double> condensed, std::size_t n, LinkageMethod method);

/// Leaves from left to right, the first child of every merge left of the second: clusters are ranges of it.
[[nodiscard]] std::vector<std::size_t> tree_order(const Dendrogram& tree);

/// Condensed [n (n - 1) / 2]: height of the merge that brings the two leaves together.
[[nodiscard]] std::vector<double> cophenetic_distances(const Dendrogram& tree);
/// Pearson correlation of cophenetic and given distances over the known pairs; NaN if one of them is constant.
[[nodiscard]] double cophenetic_correlation(const Dendrogram& tree, const DistanceMatrix& distances);

/// Cluster of each item, numbered 0, 1, ... by first appearance in the order of the items.
using Clustering = std::vector<std::size_t>;
[[nodiscard]] std::size_t cluster_count(const Clustering& clusters);

/// The tree cut into `count` clusters (1 <= count <= leaves): its last count - 1 merges are undone.
[[nodiscard]] Clustering cut_by_count(const Dendrogram& tree, std::size_t count);
/// Merges above `height` are undone.
[[nodiscard]] Clustering cut_by_height(const Dendrogram& tree, double height);

/// Mean silhouette width for each number of clusters, and the best cut.
struct SilhouetteCut {
    std::vector<double> mean_silhouette;  ///< entry c is that of c + 2 clusters
    /// The cut with the largest mean, of equal ones the one with fewer clusters; everything is one cluster where no
    /// mean is above 0. Items at distance 0 stay together.
    Clustering clusters;
};
/// @param max_clusters largest number tried, limited to n - 1; with n < 3 everything is one cluster
[[nodiscard]] SilhouetteCut cut_by_silhouette(const Dendrogram& tree, const DistanceMatrix& distances,
                                              std::size_t max_clusters);

}  // namespace morphodesic::analysis
