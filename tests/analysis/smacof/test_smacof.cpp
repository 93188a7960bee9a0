#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "analysis/procrustes.h"
#include "analysis/random.h"
#include "analysis/smacof.h"
#include "tests/analysis/support.h"
#include "tests/support/thread_counts.h"

namespace morphodesic::analysis {
namespace {

double stress_1(const Embedding& e, const std::vector<double>& disparities) {
    const std::vector<double> d = embedded_distances(e);
    double misfit = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < d.size(); ++k) {
        misfit += std::pow(d[k] - disparities[k], 2);
        squares += d[k] * d[k];
    }
    return std::sqrt(misfit / squares);
}

TEST(Isotonic, ByHand) {
    EXPECT_EQ(isotonic_regression(std::vector<double>{1, 3, 2, 4}), (std::vector<double>{1, 2.5, 2.5, 4}));
    EXPECT_EQ(isotonic_regression(std::vector<double>{3, 2, 1}), (std::vector<double>{2, 2, 2}));
    EXPECT_EQ(isotonic_regression(std::vector<double>{3, 0}, std::vector<double>{1, 2}), (std::vector<double>{1, 1}));
    EXPECT_TRUE(isotonic_regression(std::vector<double>{}).empty());
}

TEST(Isotonic, IsTheProjectionOnNonDecreasingSequences) {
    Random random(2);
    std::vector<double> y(200);
    for (double& v : y) v = random.normal();
    const std::vector<double> fit = isotonic_regression(y);
    double inner = 0.0, total = 0.0;
    for (std::size_t k = 0; k < y.size(); ++k) {
        if (k > 0) {
            EXPECT_GE(fit[k], fit[k - 1]);
        }
        inner += (y[k] - fit[k]) * fit[k];
        total += y[k] - fit[k];
    }
    EXPECT_NEAR(inner, 0.0, 1e-10);  // the conditions of optimality
    EXPECT_NEAR(total, 0.0, 1e-10);
}

TEST(Smacof, PointsInThePlaneAreRecovered) {
    Random random(5);
    std::vector<double> points(60);
    for (double& p : points) p = random.normal();
    const DistanceMatrix d = tests::distances_of(points, 2);
    for (const bool metric : {true, false}) {
        SmacofOptions options;
        options.metric = metric;
        options.max_iterations = 2000;
        options.tolerance = 1e-9;
        const Smacof result = smacof(d, options);
        EXPECT_LT(result.stress, metric ? 1e-6 : 1e-2);
        EXPECT_LT(procrustes({2, points}, result.embedding).rms_distance, metric ? 1e-5 : 0.05);
    }
}

TEST(Smacof, EquilateralTetrahedronInThePlane) {
    // The best planar picture of four equidistant points is a square (de Leeuw, Stoop 1984): with side s and diagonal
    // s sqrt(2) the misfit 4 (1 - s)^2 + 2 (1 - s sqrt(2))^2 is least at s = (2 + sqrt(2)) / 4.
    DistanceMatrix d(tests::numbered_labels(4));
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) d.set(i, j, 1.0);
    }
    SmacofOptions options;
    options.starts = 8;
    options.max_iterations = 3000;
    options.tolerance = 1e-12;
    const Smacof result = smacof(d, options);
    const double s = (2.0 + std::sqrt(2.0)) / 4.0;
    const double misfit = 4.0 * std::pow(1.0 - s, 2) + 2.0 * std::pow(1.0 - s * std::sqrt(2.0), 2);
    EXPECT_NEAR(result.stress, std::sqrt(misfit / (8.0 * s * s)), 1e-6);
}

TEST(Smacof, ReportedNumbersAreThoseOfTheReportedPicture) {
    for (const DistanceMatrix& d : {tests::grouped_matrix(40, 4, 2.0, 3), tests::tied_matrix(40, 7, 3)}) {
        for (const bool metric : {true, false}) {
            SmacofOptions options;
            options.metric = metric;
            const Smacof result = smacof(d, options);
            EXPECT_NEAR(result.stress, stress_1(result.embedding, result.disparities), 1e-9);
            EXPECT_NEAR(std::accumulate(result.stress_per_item.begin(), result.stress_per_item.end(), 0.0), 1.0, 1e-9);
            EXPECT_EQ(result.runs.size(), 4u);
            if (metric) continue;
            std::map<double, std::pair<double, double>> range;  // of the disparities of equal distances
            for (std::size_t k = 0; k < d.pair_count(); ++k) {
                const double disparity = result.disparities[k];
                auto& [low, high] = range.try_emplace(d.condensed()[k], disparity, disparity).first->second;
                low = std::min(low, disparity);
                high = std::max(high, disparity);
            }
            double highest = 0.0;  // of the disparities of smaller distances
            for (const auto& [distance, disparities] : range) {
                EXPECT_GE(disparities.first, highest - 1e-12);
                highest = disparities.second;
            }
        }
    }
}

TEST(Smacof, DisparitiesOfFurtherDistances) {
    const std::vector<double> distances{4, 1, 2, 2}, disparities{8, 1, 2, 4}, further{0, 0.5, 1, 2, 3, 4, 6, missing};
    const std::vector<double> found = disparities_at(further, distances, disparities);
    const std::vector<double> expected{0, 0.5, 1, 3, 5.5, 8, 12};
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-15) << further[k];
    EXPECT_TRUE(std::isnan(found.back()));
    EXPECT_EQ(disparities_at(further, std::vector<double>{0}, std::vector<double>{3})[4], 3.0);
    EXPECT_THROW((void)disparities_at(further, distances, std::vector<double>{1}), std::invalid_argument);
    EXPECT_THROW((void)disparities_at(further, {}, {}), std::invalid_argument);
}

TEST(Smacof, NonMetricDependsOnTheOrderOfDistancesOnly) {
    const DistanceMatrix d = tests::grouped_matrix(25, 3, 2.0, 6);
    DistanceMatrix bent(d.labels());
    for (std::size_t i = 0; i < 25; ++i) {
        for (std::size_t j = 0; j < i; ++j) bent.set(i, j, std::pow(d(i, j), 1.5));
    }
    SmacofOptions options;
    options.metric = false;
    options.max_iterations = 3000;
    options.tolerance = 1e-10;
    EXPECT_NEAR(smacof(d, options).stress, smacof(bent, options).stress, 2e-3);
    options.metric = true;
    EXPECT_GT(std::abs(smacof(d, options).stress - smacof(bent, options).stress), 5e-3);
}

TEST(Smacof, MoreDimensionsLessStressAndTheMetricFitIsBetterThanClassical) {
    const DistanceMatrix d = tests::grouped_matrix(60, 4, 2.0, 8);
    SmacofOptions options;
    const Smacof two = smacof(d, options);
    options.dimensions = 3;
    const Smacof three = smacof(d, options);
    EXPECT_LT(three.stress, two.stress);
    const std::vector<double> given(d.condensed().begin(), d.condensed().end());
    EXPECT_LT(two.stress, stress_1(classical_mds(d, 2).embedding, given));
}

TEST(Smacof, EqualBitsOnOneAndEightThreads) {
    const DistanceMatrix d = tests::grouped_matrix(120, 4, 1.0, 8);
    for (const bool metric : {true, false}) {
        SmacofOptions options;
        options.metric = metric;
        options.max_iterations = 60;
        const auto [one, eight] = tests::on_one_and_eight_threads([&] { return smacof(d, options); });
        EXPECT_EQ(one.embedding.coordinates, eight.embedding.coordinates);
        EXPECT_EQ(one.stress, eight.stress);
    }
}

TEST(Smacof, DegenerateInputs) {
    EXPECT_EQ(smacof(DistanceMatrix(), {}).embedding.size(), 0u);
    EXPECT_EQ(smacof(DistanceMatrix({"a"}), {}).embedding.size(), 1u);
    DistanceMatrix same(tests::numbered_labels(5));
    for (std::size_t i = 0; i < 5; ++i) {
        for (std::size_t j = 0; j < i; ++j) same.set(i, j, 0.0);
    }
    for (const bool metric : {true, false}) {
        SmacofOptions options;
        options.metric = metric;
        const Smacof result = smacof(same, options);
        for (const double c : result.embedding.coordinates) EXPECT_TRUE(std::isfinite(c));
        EXPECT_TRUE(std::isfinite(result.stress));
    }
    EXPECT_THROW((void)smacof(DistanceMatrix({"a", "b"}), {}), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic::analysis
