#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analysis/gaps.h"
#include "analysis/random.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

TEST(Gaps, NothingMissingNothingDone) {
    const GapTreatment gaps = fill_gaps(tests::distances_of({0, 1, 3}, 1));
    EXPECT_EQ(gaps.kept.size(), 3u);
    EXPECT_TRUE(gaps.left_out.empty());
    EXPECT_TRUE(gaps.filled.empty());
    EXPECT_TRUE(gaps.description.empty());
}

TEST(Gaps, ShortestDetourAndItsBounds) {
    // a - b 1, b - c 2, a - c missing; a second way over d: 1.5 + 1.
    DistanceMatrix d({"a", "b", "c", "d"});
    d.set(0, 1, 1.0, 0.1);
    d.set(1, 2, 2.0);
    d.set(0, 3, 1.5);
    d.set(3, 2, 1.0);
    d.set(1, 3, 2.0);
    const GapTreatment gaps = fill_gaps(d);
    EXPECT_DOUBLE_EQ(gaps.complete(0, 2), 2.5);
    EXPECT_DOUBLE_EQ(gaps.complete.error(0, 2), 1.5);  // lower bound: max(|1 - 2|, |1.5 - 1|) = 1
    ASSERT_EQ(gaps.filled.size(), 1u);
    EXPECT_EQ(gaps.filled[0], (std::pair<std::size_t, std::size_t>(0, 2)));
    EXPECT_NE(gaps.description.find("1 of 6"), std::string::npos);
}

TEST(Gaps, ShapesWithoutDistancesAreLeftOutAndListed) {
    DistanceMatrix d({"a", "lonely", "b", "c"});
    d.set(0, 2, 1.0);
    d.set(2, 3, 1.0);
    const GapTreatment gaps = fill_gaps(d);
    EXPECT_EQ(gaps.kept, (std::vector<std::size_t>{0, 2, 3}));
    EXPECT_EQ(gaps.left_out, (std::vector<std::size_t>{1}));
    EXPECT_DOUBLE_EQ(gaps.complete(0, 2), 2.0);
    EXPECT_FALSE(gaps.complete.has_errors());
    EXPECT_EQ(fill_gaps(DistanceMatrix({"x", "a"})).kept, (std::vector<std::size_t>{1}));  // the first label stays
}

TEST(Gaps, ShortestPathsAreThoseOfTheNaiveAlgorithm) {
    const std::size_t n = 150;  // more than two blocks
    Random random(4);
    const double infinity = std::numeric_limits<double>::infinity();
    std::vector<double> edges(n * n, infinity);
    for (std::size_t i = 0; i < n; ++i) {
        edges[i * n + i] = 0.0;
        for (std::size_t j = 0; j < i; ++j) {
            if (random.below(12) == 0)
                edges[i * n + j] = edges[j * n + i] = 1.0 + static_cast<double>(random.below(20));
        }
    }
    std::vector<double> naive = edges;
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j) {
                naive[i * n + j] = std::min(naive[i * n + j], naive[i * n + k] + naive[k * n + j]);
            }
        }
    }
    const auto [one, eight] = tests::on_one_and_eight_threads([&] {
        std::vector<double> fast = edges;
        shortest_paths(fast, n);
        return fast;
    });
    EXPECT_EQ(one, naive);  // integers: exact in any order of summation
    EXPECT_EQ(one, eight);
}

}  // namespace
}  // namespace morphodesic::analysis
