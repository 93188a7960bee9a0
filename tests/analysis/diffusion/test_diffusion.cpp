#include <gtest/gtest.h>

#include <cmath>

#include "analysis/diffusion.h"
#include "analysis/evaluation.h"
#include "analysis/random.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

TEST(Diffusion, RetrievalFollowsTheManifold) {
    // Two long parallel strips: ends of one strip are farther apart than the strips are.
    std::vector<double> points;
    std::vector<std::string> classes;
    Random random(3);
    for (int strip = 0; strip < 2; ++strip) {
        for (int i = 0; i < 40; ++i) {
            points.push_back(0.25 * i + 0.02 * random.normal());
            points.push_back(1.5 * strip + 0.02 * random.normal());
            classes.push_back(strip == 0 ? "a" : "b");
        }
    }
    const DistanceMatrix d = tests::distances_of(points, 2);
    const double before = retrieval(d, classes).mean_average_precision;
    DiffusionOptions options;
    options.neighbours = 5;
    options.iterations = 200;
    const double after = retrieval(diffused_distances(d, options), classes).mean_average_precision;
    EXPECT_LT(before, 0.85);
    EXPECT_GT(after, 0.97);
}

TEST(Diffusion, ValuesAreARankingInTheUnitInterval) {
    const DistanceMatrix d = tests::grouped_matrix(60, 4, 2.0, 3);
    const auto [one, eight] = tests::on_one_and_eight_threads([&] { return diffused_distances(d).dense(); });
    EXPECT_EQ(one, eight);
    for (const double x : one) {
        EXPECT_GE(x, 0.0);
        EXPECT_LE(x, 1.0);
    }
    const auto order = tests::random_order(60, 8);
    const DistanceMatrix moved = diffused_distances(tests::reordered(d, order));
    for (std::size_t i = 0; i < 60; ++i) {
        for (std::size_t j = 0; j < i; ++j) EXPECT_NEAR(moved(i, j), one[order[i] * 60 + order[j]], 1e-12);
    }
}

TEST(Diffusion, GapsAndEqualItems) {
    DistanceMatrix d(tests::numbered_labels(4));
    d.set(0, 1, 0.0);
    d.set(1, 2, 1.0);
    const DistanceMatrix result = diffused_distances(d);
    EXPECT_FALSE(result.known(0, 3));
    EXPECT_TRUE(std::isfinite(result(0, 2)));
    EXPECT_LT(result(0, 1), result(0, 2));
    EXPECT_EQ(diffused_distances(DistanceMatrix()).size(), 0u);
}

}  // namespace
}  // namespace morphodesic::analysis
