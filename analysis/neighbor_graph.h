#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {

struct Edge {
    std::size_t first, second;  ///< first < second
    double length;
    friend bool operator==(const Edge&, const Edge&) = default;
};

/// Minimum spanning tree over the known distances (Kruskal); a forest if they do not join all items. Edges by length,
/// then by items. Missing distances are no edges.
[[nodiscard]] std::vector<Edge> minimum_spanning_tree(const DistanceMatrix& distances);

/// Edge between i and j if one is among the k nearest of the other; items as near as the k-th come along.
/// Sorted by items.
[[nodiscard]] std::vector<Edge> nearest_neighbour_graph(const DistanceMatrix& distances, std::size_t k);

/// Component of each of n items, numbered 0, 1, ... by first appearance.
[[nodiscard]] std::vector<std::size_t> connected_components(std::size_t n, std::span<const Edge> edges);

/// Shortest path lengths along the edges (Dijkstra from every item), missing between components.
/// @param labels of the result, one per item
[[nodiscard]] DistanceMatrix path_distances(std::vector<std::string> labels, std::span<const Edge> edges);

/// Isomap: path lengths in the graph of the k nearest neighbours. Where this graph falls apart, edges of the minimum
/// spanning tree join its components. Source: Tenenbaum, de Silva, Langford 2000.
struct GraphDistances {
    DistanceMatrix distances;
    std::size_t joined_components = 0;  ///< components of the neighbour graph before joining
};
[[nodiscard]] GraphDistances isomap_distances(const DistanceMatrix& distances, std::size_t k);

/// Path lengths of a further item to all others, its edges leading to its k nearest.
/// @param graph  path lengths of the others
/// @param query  its distances to them, NaN where missing
/// @return       [n] NaN if no distance is known
[[nodiscard]] std::vector<double> query_path_distances(const DistanceMatrix& graph, std::span<const double> query,
                                                       std::size_t k);

}  // namespace morphodesic::analysis
