#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/k_medoids.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

double cost(const DistanceMatrix& d, const std::vector<std::size_t>& medoids) {
    double sum = 0.0;
    for (std::size_t i = 0; i < d.size(); ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const std::size_t m : medoids) nearest = std::min(nearest, d(i, m));
        sum += nearest;
    }
    return sum;
}

TEST(KMedoids, TwoGroupsByHand) {
    const KMedoids result = k_medoids(tests::distances_of({0, 1, 2, 10, 11, 12}, 1), 2);
    EXPECT_EQ(result.medoids, (std::vector<std::size_t>{1, 4}));
    EXPECT_EQ(result.clusters, (Clustering{0, 0, 0, 1, 1, 1}));
    EXPECT_DOUBLE_EQ(result.cost, 4.0);
}

TEST(KMedoids, NoSwapImprovesTheResult) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        for (const DistanceMatrix& d : {tests::grouped_matrix(40, 5, 2.0, seed), tests::tied_matrix(40, 6, seed)}) {
            for (const std::size_t k : {1u, 2u, 5u}) {
                const KMedoids result = k_medoids(d, k);
                EXPECT_NEAR(result.cost, cost(d, result.medoids), 1e-9);
                for (std::size_t m = 0; m < k; ++m) {
                    for (std::size_t c = 0; c < d.size(); ++c) {
                        std::vector<std::size_t> swapped = result.medoids;
                        swapped[m] = c;
                        EXPECT_GE(cost(d, swapped), result.cost - 1e-9);
                    }
                }
            }
        }
    }
}

TEST(KMedoids, ExtremeNumbersAndEqualItems) {
    const DistanceMatrix d = tests::distances_of({0, 0, 5}, 1);
    EXPECT_EQ(k_medoids(d, 3).clusters, (Clustering{0, 1, 2}));  // each item is its own medoid, also at distance 0
    EXPECT_EQ(k_medoids(d, 1).medoids.size(), 1u);
    EXPECT_THROW((void)k_medoids(d, 0), std::invalid_argument);
    EXPECT_THROW((void)k_medoids(d, 4), std::invalid_argument);
    EXPECT_THROW((void)k_medoids(DistanceMatrix({"a", "b"}), 1), std::invalid_argument);
}

TEST(KMedoids, EqualBitsOnOneAndEightThreads) {
    const DistanceMatrix d = tests::grouped_matrix(200, 6, 1.0, 9);
    const auto [one, eight] = tests::on_one_and_eight_threads([&] { return k_medoids(d, 6); });
    EXPECT_EQ(one.medoids, eight.medoids);
    EXPECT_EQ(one.cost, eight.cost);
}

}  // namespace
}  // namespace morphodesic::analysis
