#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/linkage.h"
#include "analysis/neighbor_graph.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

TEST(SpanningTree, PointsOnALine) {
    EXPECT_EQ(minimum_spanning_tree(tests::distances_of({4, 0, 1, 9}, 1)),
              (std::vector<Edge>{{1, 2, 1.0}, {0, 2, 3.0}, {0, 3, 5.0}}));
}

TEST(SpanningTree, ItsEdgesAreTheHeightsOfSingleLinkage) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        for (const DistanceMatrix& d : {tests::grouped_matrix(50, 4, 2.0, seed), tests::tied_matrix(50, 5, seed)}) {
            const std::vector<Edge> tree = minimum_spanning_tree(d);
            const Dendrogram single = linkage(d, LinkageMethod::single);
            ASSERT_EQ(tree.size(), single.merges.size());
            for (std::size_t m = 0; m < tree.size(); ++m) EXPECT_EQ(tree[m].length, single.merges[m].height);
            const auto component = connected_components(50, tree);
            EXPECT_EQ(*std::max_element(component.begin(), component.end()), 0u);
        }
    }
}

TEST(SpanningTree, AForestWhereDistancesAreMissing) {
    DistanceMatrix d({"a", "b", "c", "d"});
    d.set(0, 3, 1.0);
    d.set(1, 2, 2.0);
    const std::vector<Edge> forest = minimum_spanning_tree(d);
    EXPECT_EQ(forest, (std::vector<Edge>{{0, 3, 1.0}, {1, 2, 2.0}}));
    EXPECT_EQ(connected_components(4, forest), (std::vector<std::size_t>{0, 1, 1, 0}));
    EXPECT_TRUE(minimum_spanning_tree(DistanceMatrix()).empty());
}

TEST(NeighbourGraph, UnionOfNearestOnes) {
    // 0 1 3 7: nearest are 0-1, 1-0, 3-1, 7-3.
    EXPECT_EQ(nearest_neighbour_graph(tests::distances_of({0, 1, 3, 7}, 1), 1),
              (std::vector<Edge>{{0, 1, 1.0}, {1, 2, 2.0}, {2, 3, 4.0}}));
    EXPECT_EQ(nearest_neighbour_graph(tests::distances_of({0, 1, 2}, 1), 1).size(), 2u);  // both ties of the middle
}

TEST(GraphDistances, AlongACircleTheyAreTheArc) {
    const std::size_t n = 60;
    std::vector<double> points;
    for (std::size_t i = 0; i < n; ++i) {
        points.push_back(std::cos(2.0 * M_PI * static_cast<double>(i) / n));
        points.push_back(std::sin(2.0 * M_PI * static_cast<double>(i) / n));
    }
    const GraphDistances paths = isomap_distances(tests::distances_of(points, 2), 2);
    EXPECT_EQ(paths.joined_components, 1u);
    const double chord = 2.0 * std::sin(M_PI / n);
    EXPECT_NEAR(paths.distances(0, 30), 30 * chord, 1e-9);
    EXPECT_NEAR(paths.distances(5, 50), 15 * chord, 1e-9);
}

TEST(GraphDistances, ComponentsAreJoinedByTheSpanningTree) {
    const GraphDistances paths = isomap_distances(tests::distances_of({0, 1, 10, 11}, 1), 1);
    EXPECT_EQ(paths.joined_components, 2u);
    EXPECT_DOUBLE_EQ(paths.distances(0, 3), 11.0);
    const std::vector<Edge> one{{0, 1, 1.0}};
    EXPECT_FALSE(path_distances({"a", "b", "c"}, one).known(0, 2));
}

TEST(GraphDistances, AQueryReachesTheOthersThroughItsNearest) {
    const DistanceMatrix line = tests::distances_of({0, 1, 2, 3}, 1);
    const DistanceMatrix paths = isomap_distances(line, 1).distances;
    // Beside 3, off the line; the shortcut to 0 is not among its two nearest.
    const std::vector<double> query{2.0, missing, 1.5, 1.0};
    EXPECT_EQ(query_path_distances(paths, query, 2), (std::vector<double>{3.5, 2.5, 1.5, 1.0}));
    EXPECT_EQ(query_path_distances(paths, query, 1), (std::vector<double>{4.0, 3.0, 2.0, 1.0}));
    for (const double d : query_path_distances(paths, std::vector<double>(4, missing), 2)) EXPECT_TRUE(std::isnan(d));
    EXPECT_THROW((void)query_path_distances(paths, std::vector<double>(3, 1.0), 2), std::invalid_argument);
}

TEST(GraphDistances, EqualBitsOnOneAndEightThreads) {
    const DistanceMatrix d = tests::grouped_matrix(150, 4, 1.0, 2);
    const auto [one, eight] = tests::on_one_and_eight_threads([&] { return isomap_distances(d, 4).distances.dense(); });
    EXPECT_EQ(one, eight);
}

}  // namespace
}  // namespace morphodesic::analysis
