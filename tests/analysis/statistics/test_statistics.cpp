#include <gtest/gtest.h>

#include <cmath>

#include "analysis/statistics.h"
#include "tests/analysis/support.h"

namespace morphodesic::analysis {
namespace {

TEST(Statistics, RanksShareTies) {
    EXPECT_EQ(ranks(std::vector<double>{3, 1, 3, 2}), (std::vector<double>{3.5, 1, 3.5, 2}));
    EXPECT_TRUE(std::isnan(ranks(std::vector<double>{1, missing})[1]));
}

TEST(Statistics, Correlations) {
    const std::vector<double> x{1, 2, 3, 4}, bent{1, 8, 27, 64}, flat{0.1, 0.1, 0.1, 0.1};
    EXPECT_NEAR(spearman_correlation(x, bent), 1.0, 1e-12);
    EXPECT_NEAR(pearson_correlation(x, bent), 0.9513699, 1e-6);
    EXPECT_TRUE(std::isnan(pearson_correlation(x, flat)));
    EXPECT_NEAR(pearson_correlation(std::vector<double>{1, missing, 3, 4}, std::vector<double>{1, 5, 3, missing}), 1.0,
                1e-12);
}

TEST(Statistics, Quantiles) {
    EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
    EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 1.0), 4.0);
    EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Silhouette, ByHand) {
    // {0, 1} and {4, 6}: item 0: a = 1, b = 5 -> 0.8; item 2: a = 2, b = 3.5 -> 1.5 / 3.5.
    const auto widths = silhouette_widths(tests::distances_of({0, 1, 4, 6}, 1), {0, 0, 1, 1});
    EXPECT_DOUBLE_EQ(widths[0], 0.8);
    EXPECT_DOUBLE_EQ(widths[2], 1.5 / 3.5);
    const auto single = silhouette_widths(tests::distances_of({0, 1, 4}, 1), {0, 0, 1});
    EXPECT_EQ(single[2], 0.0);
    EXPECT_EQ(silhouette_widths(tests::distances_of({0, 1}, 1), {0, 0}), (std::vector<double>{0, 0}));
}

}  // namespace
}  // namespace morphodesic::analysis
