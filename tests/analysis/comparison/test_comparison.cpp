#include <gtest/gtest.h>

#include <cmath>

#include "analysis/comparison.h"
#include "analysis/random.h"
#include "tests/analysis/support.h"

namespace morphodesic::analysis {
namespace {

TEST(Comparison, SameDistancesInOtherUnitsAndOrder) {
    const DistanceMatrix a = tests::grouped_matrix(30, 3, 2.0, 1);
    DistanceMatrix b = tests::reordered(a, tests::random_order(30, 2));
    for (std::size_t i = 0; i < 30; ++i) {
        for (std::size_t j = 0; j < i; ++j) b.set(i, j, 4.0 * b(i, j));
    }
    const MatrixComparison result = compare(a, b, 5);
    EXPECT_EQ(result.pairs, 435u);
    EXPECT_NEAR(result.pearson, 1.0, 1e-12);
    EXPECT_NEAR(result.spearman, 1.0, 1e-12);
    EXPECT_NEAR(result.kendall, 1.0, 1e-12);
    EXPECT_TRUE(result.moved.empty());
    EXPECT_EQ(result.mean_overlap, 1.0);
}

TEST(Comparison, OnlyCommonLabelsAndKnownPairs) {
    DistanceMatrix a({"x", "y", "z", "here"}), b({"there", "z", "y", "x"});
    a.set(0, 1, 1.0);
    a.set(0, 2, 2.0);
    a.set(1, 2, 3.0);
    b.set(3, 2, 3.0);
    b.set(3, 1, 2.0);
    const MatrixComparison result = compare(a, b, 1);
    EXPECT_EQ(result.labels, (std::vector<std::string>{"x", "y", "z"}));
    EXPECT_EQ(result.pairs, 2u);
    EXPECT_NEAR(result.spearman, -1.0, 1e-12);
    ASSERT_EQ(result.moved.size(), 1u);  // x: y here, z there
    EXPECT_EQ(result.moved[0].nearest_here, "y");
    EXPECT_EQ(result.moved[0].nearest_there, "z");
}

TEST(Comparison, UnrelatedMatricesAreNotCorrelated) {
    const MatrixComparison result = compare(tests::tied_matrix(40, 100, 1), tests::tied_matrix(40, 100, 2), 5);
    EXPECT_LT(std::abs(result.spearman), 0.15);
    EXPECT_LT(result.mean_overlap, 0.4);
}

TEST(Comparison, KendallIsThatOfTheDefinition) {
    Random random(4);
    std::vector<double> x, y;
    for (int i = 0; i < 80; ++i) {
        x.push_back(static_cast<double>(random.below(12)));
        y.push_back(x.back() + static_cast<double>(random.below(9)));
    }
    double score = 0.0, not_x = 0.0, not_y = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const double a = x[i] - x[j], b = y[i] - y[j];
            score += a * b > 0 ? 1.0 : a * b < 0 ? -1.0 : 0.0;
            not_x += a != 0 ? 1.0 : 0.0;
            not_y += b != 0 ? 1.0 : 0.0;
        }
    }
    EXPECT_NEAR(kendall_correlation(x, y), score / std::sqrt(not_x * not_y), 1e-12);
    EXPECT_TRUE(std::isnan(kendall_correlation(std::vector<double>{1, 1}, std::vector<double>{1, 2})));
}

}  // namespace
}  // namespace morphodesic::analysis
