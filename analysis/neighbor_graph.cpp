#include "analysis/neighbor_graph.h"

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/connected_components.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/graph/kruskal_min_spanning_tree.hpp>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "analysis/evaluation.h"
#include "analysis/parallel.h"

namespace morphodesic::analysis {
namespace {

struct Length {
    double length;
};
using SparseGraph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, Length>;

bool by_items(const Edge& a, const Edge& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
}

/// Every edge in the given directions only.
SparseGraph sparse_graph(std::size_t n, const std::vector<std::pair<std::size_t, std::size_t>>& arcs,
                         const std::vector<Length>& lengths) {
    return {boost::edges_are_unsorted_multi_pass, arcs.begin(), arcs.end(), lengths.begin(), n};
}

/// Spanning forest of smallest length (Kruskal), in no particular order.
std::vector<Edge> spanning_forest(std::size_t n, const std::vector<Edge>& edges) {
    std::vector<std::pair<std::size_t, std::size_t>> arcs;
    std::vector<Length> lengths;
    arcs.reserve(edges.size());
    lengths.reserve(edges.size());
    for (const Edge& e : edges) {
        arcs.emplace_back(e.first, e.second);
        lengths.push_back({e.length});
    }
    const SparseGraph graph = sparse_graph(n, arcs, lengths);
    std::vector<boost::graph_traits<SparseGraph>::edge_descriptor> tree;
    boost::kruskal_minimum_spanning_tree(graph, std::back_inserter(tree),
                                         boost::weight_map(boost::get(&Length::length, graph)));
    std::vector<Edge> forest;
    for (const auto& e : tree) forest.push_back({boost::source(e, graph), boost::target(e, graph), graph[e].length});
    return forest;
}

}  // namespace

std::vector<Edge> minimum_spanning_tree(const DistanceMatrix& distances) {
    // An edge that is not in the forest of some of the edges is not in that of all of them. So blocks of rows, whose
    // heaps fit into the cache, leave few edges for the last round.
    const std::size_t n = distances.size(), rows = 16, blocks = (n + rows - 1) / rows;
    std::vector<std::vector<Edge>> parts(blocks);
    parallel_for_each_index(blocks, 1, [&](std::size_t b) {
        std::vector<Edge> edges;
        for (std::size_t i = b * rows; i < std::min(n, (b + 1) * rows); ++i) {
            for (std::size_t j = i + 1; j < n; ++j) {
                if (distances.known(i, j)) edges.push_back({i, j, distances(i, j)});
            }
        }
        parts[b] = spanning_forest(n, edges);
    });
    std::vector<Edge> edges;
    for (const std::vector<Edge>& part : parts) edges.insert(edges.end(), part.begin(), part.end());
    edges = spanning_forest(n, edges);
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.length != b.length ? a.length < b.length : by_items(a, b); });
    return edges;
}

std::vector<Edge> nearest_neighbour_graph(const DistanceMatrix& distances, std::size_t k) {
    std::vector<std::vector<Neighbour>> near(distances.size());
    parallel_for_each_index(distances.size(), 16,
                            [&](std::size_t i) { near[i] = nearest_neighbours(distances, i, k); });
    std::vector<Edge> edges;
    for (std::size_t i = 0; i < distances.size(); ++i) {
        for (const Neighbour& other : near[i]) {
            edges.push_back({std::min(i, other.item), std::max(i, other.item), other.distance});
        }
    }
    std::sort(edges.begin(), edges.end(), by_items);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

std::vector<std::size_t> connected_components(std::size_t n, std::span<const Edge> edges) {
    boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS> graph(n);
    for (const Edge& e : edges) boost::add_edge(e.first, e.second, graph);
    std::vector<std::size_t> component(n);
    if (n > 0) boost::connected_components(graph, component.data());
    return component;  // Boost numbers components by their first vertex
}

DistanceMatrix path_distances(std::vector<std::string> labels, std::span<const Edge> edges) {
    const std::size_t n = labels.size();
    std::vector<std::pair<std::size_t, std::size_t>> arcs;
    std::vector<Length> lengths;
    for (const Edge& e : edges) {
        if (e.first >= n || e.second >= n) throw std::invalid_argument("an edge joins items that are not there");
        if (!(e.length >= 0.0)) throw std::invalid_argument("edges have lengths >= 0");
        arcs.emplace_back(e.first, e.second);
        arcs.emplace_back(e.second, e.first);
        lengths.insert(lengths.end(), 2, {e.length});
    }
    const SparseGraph graph = sparse_graph(n, arcs, lengths);
    std::vector<double> condensed(n < 2 ? 0 : n * (n - 1) / 2, missing);
    parallel_for_each_index(n, 8, [&](std::size_t i) {
        std::vector<double> reached(n);
        boost::dijkstra_shortest_paths(graph, i,
                                       boost::distance_map(boost::make_iterator_property_map(
                                                               reached.begin(), boost::get(boost::vertex_index, graph)))
                                           .weight_map(boost::get(&Length::length, graph)));
        for (std::size_t j = i + 1; j < n; ++j) {  // the search from the smaller number decides the last bit
            if (reached[j] <= largest_distance) condensed[DistanceMatrix::condensed_index(n, i, j)] = reached[j];
        }
    });
    return {std::move(labels), std::move(condensed)};
}

GraphDistances isomap_distances(const DistanceMatrix& distances, std::size_t k) {
    std::vector<Edge> edges = nearest_neighbour_graph(distances, k);
    const std::vector<std::size_t> component = connected_components(distances.size(), edges);
    GraphDistances result;
    for (const std::size_t c : component) result.joined_components = std::max(result.joined_components, c + 1);
    if (result.joined_components > 1) {
        for (const Edge& e : minimum_spanning_tree(distances)) {
            if (component[e.first] != component[e.second]) edges.push_back(e);
        }
    }
    result.distances = path_distances(distances.labels(), edges);
    return result;
}

std::vector<double> query_path_distances(const DistanceMatrix& graph, std::span<const double> query, std::size_t k) {
    const std::size_t n = graph.size();
    if (query.size() != n) throw std::invalid_argument("one distance per item is needed, NaN if unknown");
    std::vector<std::size_t> nearest;
    for (std::size_t i = 0; i < n; ++i) {
        if (!std::isnan(query[i])) nearest.push_back(i);
    }
    std::stable_sort(nearest.begin(), nearest.end(), [&](std::size_t i, std::size_t j) { return query[i] < query[j]; });
    nearest.resize(std::min(nearest.size(), k));
    std::vector<double> result(n, missing);
    for (const std::size_t via : nearest) {
        for (std::size_t i = 0; i < n; ++i) result[i] = std::fmin(result[i], query[via] + graph(via, i));
    }
    return result;
}

}  // namespace morphodesic::analysis
