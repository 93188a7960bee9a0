#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "analysis/leaf_order.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

/// Every order that the tree allows: all ways to turn its merges round.
double best_by_trying_all(const Dendrogram& tree, const DistanceMatrix& d) {
    const std::size_t n = tree.leaf_count;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t turns = 0; turns < (std::size_t{1} << tree.merges.size()); ++turns) {
        std::vector<std::vector<std::size_t>> part(n + tree.merges.size());
        for (std::size_t i = 0; i < n; ++i) part[i] = {i};
        for (std::size_t m = 0; m < tree.merges.size(); ++m) {
            auto first = part[tree.merges[m].first], second = part[tree.merges[m].second];
            if ((turns >> m) % 2 == 1) std::swap(first, second);
            first.insert(first.end(), second.begin(), second.end());
            part[n + m] = first;
        }
        best = std::min(best, order_length(part.back(), d));
    }
    return best;
}

void expect_allowed(const Dendrogram& tree, const std::vector<std::size_t>& order) {
    std::vector<std::size_t> place(tree.leaf_count);
    ASSERT_EQ(order.size(), tree.leaf_count);
    for (std::size_t p = 0; p < order.size(); ++p) place[order[p]] = p;
    std::vector<std::pair<std::size_t, std::size_t>> range;
    for (std::size_t i = 0; i < tree.leaf_count; ++i) range.emplace_back(place[i], place[i]);
    for (const Merge& m : tree.merges) {
        const auto a = range[m.first], b = range[m.second];
        range.emplace_back(std::min(a.first, b.first), std::max(a.second, b.second));
        EXPECT_EQ(range.back().second - range.back().first + 1, m.size) << "a cluster is torn apart";
    }
}

TEST(LeafOrder, PointsOnALineComeOutSorted) {
    const DistanceMatrix d = tests::distances_of({5, 0, 9, 1, 7, 2}, 1);
    const LeafOrder result = optimal_leaf_order(linkage(d, LinkageMethod::average), d);
    EXPECT_DOUBLE_EQ(result.length, 9.0);
    EXPECT_EQ(result.order, (std::vector<std::size_t>{1, 3, 5, 0, 4, 2}));  // s1 before s2
}

TEST(LeafOrder, IsTheBestOfAllAllowedOrders) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
        for (const DistanceMatrix& d : {tests::grouped_matrix(11, 3, 2.0, seed), tests::tied_matrix(11, 3, seed)}) {
            for (const LinkageMethod method : {LinkageMethod::single, LinkageMethod::average, LinkageMethod::ward}) {
                const Dendrogram tree = linkage(d, method);
                const LeafOrder result = optimal_leaf_order(tree, d);
                expect_allowed(tree, result.order);
                EXPECT_NEAR(result.length, best_by_trying_all(tree, d), 1e-12);
                EXPECT_TRUE(result.optimal);
            }
        }
    }
}

TEST(LeafOrder, BeyondTheLimitItSaysSoAndStaysAllowed) {
    const DistanceMatrix d = tests::grouped_matrix(60, 5, 3.0, 2);
    const Dendrogram tree = linkage(d, LinkageMethod::average);
    const LeafOrder best = optimal_leaf_order(tree, d), quick = optimal_leaf_order(tree, d, 10);
    EXPECT_FALSE(quick.optimal);
    expect_allowed(tree, quick.order);
    EXPECT_LE(best.length, quick.length);
    EXPECT_LT(quick.length, order_length(tree_order(tree), d));
}

TEST(LeafOrder, EqualBitsOnOneAndEightThreads) {
    const DistanceMatrix d = tests::grouped_matrix(300, 6, 2.0, 2);
    const Dendrogram tree = linkage(d, LinkageMethod::average);
    const auto [one, eight] = tests::on_one_and_eight_threads([&] { return optimal_leaf_order(tree, d).order; });
    EXPECT_EQ(one, eight);
}

TEST(LeafOrder, TinyTrees) {
    const DistanceMatrix one({"a"});
    EXPECT_EQ(optimal_leaf_order(linkage(one, LinkageMethod::average), one).order, (std::vector<std::size_t>{0}));
    const DistanceMatrix none;
    EXPECT_TRUE(optimal_leaf_order(linkage(none, LinkageMethod::average), none).order.empty());
}

}  // namespace
}  // namespace morphodesic::analysis
