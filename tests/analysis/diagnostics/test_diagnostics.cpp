#include <gtest/gtest.h>

#include <cmath>

#include "analysis/diagnostics.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

TEST(Triangles, OneViolationByHand) {
    DistanceMatrix d({"a", "b", "c"});
    d.set(0, 1, 1.0, 0.1);
    d.set(1, 2, 1.0, 0.1);
    d.set(0, 2, 2.5, 0.1);
    const TriangleReport report = triangle_violations(d);
    EXPECT_EQ(report.triangles, 1u);
    EXPECT_EQ(report.violated, 1u);
    EXPECT_EQ(report.beyond_error, 1u);
    ASSERT_EQ(report.worst.size(), 1u);
    EXPECT_EQ(report.worst[0].via, 1u);
    EXPECT_DOUBLE_EQ(report.worst[0].excess, 0.5);
    EXPECT_NEAR(report.worst[0].error, 0.3, 1e-12);
    d.set(0, 2, 2.25, 0.1);
    EXPECT_EQ(triangle_violations(d).violated, 1u);
    EXPECT_EQ(triangle_violations(d).beyond_error, 0u);
}

TEST(Triangles, EuclideanDistancesHaveNoneAlsoOnALine) {
    EXPECT_EQ(triangle_violations(tests::grouped_matrix(60, 4, 2.0, 1)).violated, 0u);
    std::vector<double> line;
    for (int i = 0; i < 40; ++i) line.push_back(0.1 * i);  // every triangle is flat: only rounding is left
    EXPECT_EQ(triangle_violations(tests::distances_of(line, 1)).violated, 0u);
}

TEST(Triangles, CountsAreThoseOfTheNaiveAlgorithm) {
    const std::size_t n = 71;
    for (const bool gaps : {false, true}) {
        DistanceMatrix d = tests::tied_matrix(n, 9, 5);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                if ((i + j) % 3 == 0) d.set(i, j, d(i, j), 0.6);
                if (gaps && (i * j) % 7 == 3) d.set(i, j, missing);
            }
        }
        std::size_t triangles = 0, violated = 0, beyond = 0;
        double worst = 0.0;
        const auto bar = [&](std::size_t i, std::size_t j) { return std::isnan(d.error(i, j)) ? 0.0 : d.error(i, j); };
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j) {
                for (std::size_t k = 0; k < n; ++k) {
                    if (k == i || k == j || !d.known(i, j) || !d.known(i, k) || !d.known(j, k)) continue;
                    if (k > j) ++triangles;
                    const double excess = d(i, j) - d(i, k) - d(k, j);
                    if (excess > 1e-9) ++violated;
                    if (excess > bar(i, j) + bar(i, k) + bar(k, j) + 1e-9) ++beyond;
                    worst = std::max(worst, excess);
                }
            }
        }
        const auto [one, eight] = tests::on_one_and_eight_threads([&] { return triangle_violations(d); });
        EXPECT_EQ(one.triangles, triangles);
        EXPECT_EQ(one.violated, violated);
        EXPECT_EQ(one.beyond_error, beyond);
        EXPECT_GT(beyond, 0u);
        EXPECT_LT(beyond, violated);
        EXPECT_DOUBLE_EQ(one.worst.front().excess, worst);
        EXPECT_EQ(one.worst.size(), 20u);
        EXPECT_EQ(eight.beyond_error, beyond);
        for (std::size_t w = 0; w < 20; ++w) EXPECT_EQ(one.worst[w].first, eight.worst[w].first);
    }
}

TEST(Asymmetry, SharesOfTheMean) {
    const std::vector<DirectedPair> pairs{{0, 1, 1.0, 1.0}, {0, 2, 3.0, 1.0}, {1, 2, 0.9, 1.1}, {1, 3, missing, 1.0}};
    const AsymmetryReport report = asymmetry(pairs);
    EXPECT_EQ(report.pairs, 3u);
    EXPECT_DOUBLE_EQ(report.largest, 1.0);
    EXPECT_NEAR(report.median, 0.2, 1e-12);
    EXPECT_EQ(report.worst.front().second, 2u);
    EXPECT_TRUE(std::isnan(asymmetry({}).median));
}

DistanceMatrix with_bars(const DistanceMatrix& d, double bar) {
    DistanceMatrix result(d.labels());
    for (std::size_t i = 0; i < d.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) result.set(i, j, d(i, j), bar);
    }
    return result;
}

TEST(CloseClusters, SaidOnlyWhereTheErrorReachesTheSeparation) {
    // {0, 1} and {10, 11}: mean distance 10, inner mean 1: separation 9.
    const DistanceMatrix d = tests::distances_of({0, 1, 10, 11}, 1);
    const Clustering clusters{0, 0, 1, 1};
    EXPECT_TRUE(close_clusters(with_bars(d, 8.9), clusters).empty());
    const auto close = close_clusters(with_bars(d, 9.1), clusters);
    ASSERT_EQ(close.size(), 1u);
    EXPECT_NEAR(close[0].separation, 9.0, 1e-12);
    EXPECT_NEAR(close[0].error, 9.1, 1e-12);
    EXPECT_TRUE(close_clusters(d, clusters).empty());
}

TEST(Stability, FarGroupsStayAndNoiseDoesNot) {
    const DistanceMatrix d = tests::grouped_matrix(40, 4, 12.0, 3);
    const Clustering clusters = cut_by_count(linkage(d, LinkageMethod::average), 4);
    const StabilityReport firm = cluster_stability(with_bars(d, 0.5), clusters, LinkageMethod::average, 20, 1);
    EXPECT_EQ(firm.runs, 20u);
    EXPECT_DOUBLE_EQ(firm.mean_rand, 1.0);
    for (const ClusterStability& c : firm.clusters) {
        EXPECT_DOUBLE_EQ(c.jaccard, 1.0);
        EXPECT_EQ(c.members, 10u);
    }
    const StabilityReport loose = cluster_stability(with_bars(d, 50.0), clusters, LinkageMethod::average, 20, 1);
    EXPECT_LT(loose.mean_rand, 0.5);
    EXPECT_EQ(cluster_stability(d, clusters, LinkageMethod::average, 20, 1).runs, 0u);
    const StabilityReport still = cluster_stability(with_bars(d, 0.0), clusters, LinkageMethod::average, 5, 1);
    EXPECT_DOUBLE_EQ(still.mean_rand, 1.0);
}

TEST(Stability, ASingleMemberIsAsStableAsItIsAlone) {
    // Nothing can be told apart: the runs put the single member together with others most of the time.
    const DistanceMatrix d = with_bars(tests::distances_of({0, 1, 2, 3, 4.5}, 1), 100.0);
    const StabilityReport loose = cluster_stability(d, {0, 0, 0, 0, 1}, LinkageMethod::average, 40, 1);
    EXPECT_LT(loose.item_stability[4], 0.7);
    const StabilityReport firm = cluster_stability(with_bars(tests::distances_of({0, 1, 2, 3, 4.5}, 1), 0.0),
                                                   {0, 0, 0, 0, 1}, LinkageMethod::single, 5, 1);
    EXPECT_EQ(firm.item_stability[4], 1.0);
}

TEST(Stability, OneSeedOneResultOnAnyNumberOfThreads) {
    const DistanceMatrix d = with_bars(tests::grouped_matrix(60, 4, 1.0, 3), 1.0);
    const Clustering clusters = cut_by_count(linkage(d, LinkageMethod::average), 4);
    const auto run = [&](std::uint64_t seed) {
        return cluster_stability(d, clusters, LinkageMethod::average, 12, seed).item_stability;
    };
    const auto [one, eight] = tests::on_one_and_eight_threads([&] { return run(7); });
    EXPECT_EQ(one, eight);
    EXPECT_NE(one, run(8));
}

}  // namespace
}  // namespace morphodesic::analysis
