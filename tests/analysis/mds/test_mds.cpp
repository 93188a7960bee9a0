#include <gtest/gtest.h>

#include <cmath>

#include "analysis/mds.h"
#include "analysis/random.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

TEST(ClassicalMds, RecoversARightTriangle) {
    const DistanceMatrix d = tests::distances_of({0, 0, 3, 0, 0, 4}, 2);
    const ClassicalScaling scaling = classical_mds(d, 2);
    const std::vector<double> back = embedded_distances(scaling.embedding);
    EXPECT_NEAR(back[0], 3.0, 1e-12);
    EXPECT_NEAR(back[1], 4.0, 1e-12);
    EXPECT_NEAR(back[2], 5.0, 1e-12);
    EXPECT_NEAR(scaling.eigenvalues[0] + scaling.eigenvalues[1], (9.0 + 16.0 + 25.0) / 3.0, 1e-12);  // sum of d^2 / n
}

TEST(ClassicalMds, EquilateralTetrahedronHasThreeEqualEigenvalues) {
    DistanceMatrix d(tests::numbered_labels(4));
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) d.set(i, j, 1.0);
    }
    const ClassicalScaling scaling = classical_mds(d, 3);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(scaling.eigenvalues[static_cast<std::size_t>(k)], 0.5, 1e-12);
    EXPECT_NEAR(scaling.eigenvalues[3], 0.0, 1e-12);
}

TEST(ClassicalMds, PartialEigenvaluesAreThoseOfTheTrace) {
    // 450 points in three dimensions take the Lanczos path; their distances are exact in three dimensions.
    Random random(3);
    std::vector<double> points;
    for (int i = 0; i < 450; ++i) {
        for (const double scale : {5.0, 2.0, 1.0}) points.push_back(scale * random.normal());
    }
    const DistanceMatrix d = tests::distances_of(points, 3);
    const ClassicalScaling scaling = classical_mds(d, 3);
    double trace = 0.0;  // sum of squared distances / n
    for (const double distance : d.condensed()) trace += distance * distance / 450.0;
    EXPECT_NEAR(scaling.eigenvalues[0] + scaling.eigenvalues[1] + scaling.eigenvalues[2], trace, 1e-6);
    const std::vector<double> back = embedded_distances(scaling.embedding);
    for (std::size_t k = 0; k < back.size(); k += 97) EXPECT_NEAR(back[k], d.condensed()[k], 1e-7);
}

TEST(ClassicalMds, TheSamePictureFromAnyOrderOfTheItems) {
    const DistanceMatrix d = tests::grouped_matrix(50, 3, 4.0, 8);
    const auto order = tests::random_order(50, 2);
    const ClassicalScaling a = classical_mds(d, 2), b = classical_mds(tests::reordered(d, order), 2);
    for (std::size_t i = 0; i < 50; ++i) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            EXPECT_NEAR(b.embedding(i, axis), a.embedding(order[i], axis), 1e-9);
        }
    }
}

TEST(ClassicalMds, EqualBitsOnOneAndEightThreads) {
    const DistanceMatrix d = tests::grouped_matrix(450, 3, 4.0, 8);
    const auto [one, eight] =
        tests::on_one_and_eight_threads([&] { return classical_mds(d, 3).embedding.coordinates; });
    EXPECT_EQ(one, eight);
}

TEST(ClassicalMds, DegenerateInputs) {
    EXPECT_EQ(classical_mds(DistanceMatrix(), 2).embedding.size(), 0u);
    EXPECT_EQ(classical_mds(DistanceMatrix({"a"}), 2).embedding.coordinates, (std::vector<double>{0.0, 0.0}));
    const ClassicalScaling line = classical_mds(tests::distances_of({0, 2}, 1), 3);
    EXPECT_NEAR(std::abs(line.embedding(0, 0) - line.embedding(1, 0)), 2.0, 1e-12);
    EXPECT_EQ(line.embedding(0, 2), 0.0);
    EXPECT_THROW((void)classical_mds(DistanceMatrix({"a", "b"}), 2), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::analysis
