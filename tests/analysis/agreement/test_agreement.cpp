#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "analysis/agreement.h"

namespace morphodesic::analysis {
namespace {

using Parts = std::vector<std::size_t>;

TEST(Agreement, KnownValues) {
    // Documented examples of scikit-learn (adjusted_rand_score): 0.57142... and 0.24242...
    EXPECT_NEAR(adjusted_rand(Parts{0, 0, 1, 2}, Parts{0, 0, 1, 1}), 0.5714285714285714, 1e-12);
    EXPECT_NEAR(adjusted_rand(Parts{0, 0, 0, 1, 1, 1}, Parts{0, 0, 1, 1, 2, 2}), 0.24242424242424243, 1e-12);
    EXPECT_NEAR(adjusted_rand(Parts{0, 0, 1, 1}, Parts{0, 1, 0, 1}), -0.5, 1e-12);
    const Agreement halves = agreement(Parts{0, 0, 1, 1}, Parts{0, 0, 0, 1});
    // I = 1/2 log(4/3) + 1/4 log(2/3) + 1/4 log 2
    EXPECT_NEAR(halves.mutual_information,
                0.5 * std::log(4.0 / 3.0) + 0.25 * std::log(2.0 / 3.0) + 0.25 * std::log(2.0), 1e-12);
}

TEST(Agreement, EqualPartitionsUnderOtherNames) {
    const Agreement a = agreement(Parts{0, 0, 1, 1, 2}, Parts{2, 2, 0, 0, 1});
    EXPECT_NEAR(a.adjusted_rand, 1.0, 1e-12);
    EXPECT_NEAR(a.adjusted_mutual_information, 1.0, 1e-12);
    EXPECT_NEAR(a.normalized_mutual_information, 1.0, 1e-12);
}

TEST(Agreement, IndependentPartitionsAreNearZero) {
    Parts a, b;
    for (std::size_t i = 0; i < 900; ++i) {
        a.push_back(i % 30 / 10);
        b.push_back(i / 300);
    }
    EXPECT_NEAR(agreement(a, b).adjusted_rand, 0.0, 0.01);
    EXPECT_NEAR(agreement(a, b).adjusted_mutual_information, 0.0, 0.01);
}

TEST(Agreement, TrivialPartitionsAndUnlabelledItems) {
    EXPECT_EQ(agreement(Parts{0, 0, 0}, Parts{0, 0, 0}).adjusted_mutual_information, 1.0);
    EXPECT_EQ(agreement(Parts{0, 1, 2}, Parts{2, 1, 0}).adjusted_mutual_information, 1.0);
    EXPECT_TRUE(std::isnan(agreement(Parts{}, Parts{}).adjusted_rand));
    const std::vector<std::string> classes{"a", "a", "", "b"};
    EXPECT_EQ(agreement(Parts{0, 0, 0, 1}, classes).adjusted_rand, 1.0);
    EXPECT_THROW((void)agreement(Parts{0}, Parts{0, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::analysis
