#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analysis/distance_matrix.h"

namespace morphodesic::analysis {
namespace {

TEST(DistanceMatrix, BeginsWithoutAnyDistance) {
    const DistanceMatrix matrix({"a", "b", "c"});
    EXPECT_EQ(matrix.missing_count(), 3u);
    EXPECT_FALSE(matrix.known(0, 1));
    EXPECT_TRUE(matrix.known(1, 1));
    EXPECT_EQ(matrix(2, 2), 0.0);
    EXPECT_FALSE(matrix.has_errors());
}

TEST(DistanceMatrix, CondensedOrderIsThatOfSciPy) {
    DistanceMatrix matrix({"a", "b", "c", "d"});
    double value = 1.0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) matrix.set(j, i, value++);  // set through the other triangle
    }
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(matrix.condensed()[k], static_cast<double>(k + 1));
    EXPECT_EQ(matrix(1, 3), matrix(3, 1));
}

TEST(DistanceMatrix, RefusesWhatIsNoDistance) {
    DistanceMatrix matrix({"a", "b"});
    EXPECT_THROW(matrix.set(0, 1, -1.0), std::invalid_argument);
    EXPECT_THROW(matrix.set(0, 1, std::numeric_limits<double>::infinity()), std::invalid_argument);
    EXPECT_THROW(matrix.set(0, 0, 1.0), std::invalid_argument);
    EXPECT_THROW(matrix.set(0, 2, 1.0), std::invalid_argument);
    EXPECT_THROW(matrix.set(0, 1, 1.0, -0.1), std::invalid_argument);
    EXPECT_THROW(DistanceMatrix({"a", "a"}), std::invalid_argument);
    EXPECT_THROW(DistanceMatrix({"a", ""}), std::invalid_argument);
    EXPECT_FALSE(matrix.known(0, 1));
}

TEST(DistanceMatrix, ErrorBarsAreOptionalAndGoWithTheDistance) {
    DistanceMatrix matrix({"a", "b", "c"});
    matrix.set(0, 1, 2.0);
    EXPECT_TRUE(std::isnan(matrix.error(0, 1)));
    matrix.set(0, 2, 3.0, 0.25);
    EXPECT_TRUE(matrix.has_errors());
    EXPECT_EQ(matrix.error(2, 0), 0.25);
    EXPECT_TRUE(std::isnan(matrix.error(0, 1)));
    EXPECT_EQ(matrix.error(1, 1), 0.0);
    matrix.set(0, 2, missing);
    EXPECT_TRUE(std::isnan(matrix.error(0, 2)));
}

TEST(DistanceMatrix, SubsetKeepsDistancesErrorsAndLabels) {
    DistanceMatrix matrix({"a", "b", "c"});
    matrix.set(0, 1, 1.0, 0.1);
    matrix.set(0, 2, 2.0, 0.2);
    const std::size_t items[] = {2, 0};
    const DistanceMatrix part = matrix.subset(items);
    EXPECT_EQ(part.labels(), (std::vector<std::string>{"c", "a"}));
    EXPECT_EQ(part(0, 1), 2.0);
    EXPECT_EQ(part.error(0, 1), 0.2);
}

}  // namespace
}  // namespace morphodesic::analysis
