#include <gtest/gtest.h>

#include <cmath>

#include "analysis/calibration.h"
#include "analysis/random.h"

namespace morphodesic::analysis {
namespace {

struct Answers {
    std::vector<double> margins;
    std::vector<unsigned char> right;
};

/// Right with probability 1 / (1 + exp(1 - 6 margin)).
Answers simulated(int count) {
    Random random(11);
    Answers a;
    for (int i = 0; i < count; ++i) {
        a.margins.push_back(random.uniform());
        a.right.push_back(random.uniform() < 1.0 / (1.0 + std::exp(1.0 - 6.0 * a.margins.back())) ? 1 : 0);
    }
    return a;
}

TEST(Calibration, FindsTheCurveThatMadeTheData) {
    const Answers a = simulated(20'000);
    const ConfidenceCurve logistic = fit_confidence(a.margins, a.right, CalibrationKind::logistic);
    EXPECT_NEAR(logistic.offset, -1.0, 0.15);
    EXPECT_NEAR(logistic.slope, 6.0, 0.4);
    const ConfidenceCurve isotonic = fit_confidence(a.margins, a.right, CalibrationKind::isotonic);
    for (const double m : {0.1, 0.3, 0.5, 0.8}) EXPECT_NEAR(isotonic(m), logistic(m), 0.06);
    std::vector<double> said;
    for (const double m : a.margins) said.push_back(logistic(m));
    EXPECT_LT(reliability(said, a.right).expected_calibration_error, 0.02);
}

TEST(Calibration, ConfidenceNeverFallsWithTheMargin) {
    const Answers a = simulated(300);
    for (const CalibrationKind kind : {CalibrationKind::logistic, CalibrationKind::isotonic}) {
        std::vector<unsigned char> upside_down;
        for (const unsigned char r : a.right) upside_down.push_back(r == 1 ? 0 : 1);
        for (const auto& right : {a.right, upside_down}) {
            const ConfidenceCurve curve = fit_confidence(a.margins, right, kind);
            for (double m = 0.01; m <= 1.0; m += 0.01) EXPECT_GE(curve(m), curve(m - 0.01) - 1e-12);
        }
    }
}

TEST(Calibration, ASmallMarginIsNoProofEvenIfAllAnswersWereRight) {
    std::vector<double> margins;
    for (int i = 0; i < 64; ++i) margins.push_back(0.2 + 0.01 * i);
    std::vector<unsigned char> right(64, 1);
    right[10] = 0;
    const ConfidenceCurve curve = fit_confidence(margins, right, CalibrationKind::logistic);
    EXPECT_GT(curve(0.0), 0.45);
    EXPECT_LT(curve(0.0), 0.75);
    EXPECT_GT(curve(0.5), 0.93);
    EXPECT_GT(curve(0.8), 0.97);
}

TEST(Calibration, FewOrOneSidedAnswersStayModest) {
    const std::vector<double> margins{0.2, 0.4, 0.6};
    const ConfidenceCurve all_right =
        fit_confidence(margins, std::vector<unsigned char>{1, 1, 1}, CalibrationKind::logistic);
    EXPECT_GT(all_right(0.4), 0.7);
    EXPECT_LT(all_right(0.4), 0.95);  // three right answers are no proof
    EXPECT_TRUE(std::isnan(fit_confidence({}, {}, CalibrationKind::logistic)(0.3)));
    EXPECT_TRUE(std::isnan(fit_confidence({}, {}, CalibrationKind::isotonic)(0.3)));
    const ConfidenceCurve same = fit_confidence(std::vector<double>{1, 1, 1, 1}, std::vector<unsigned char>{1, 1, 0, 1},
                                                CalibrationKind::logistic);
    EXPECT_NEAR(same(1.0), 0.7, 0.06);
}

TEST(Reliability, ByHand) {
    const Reliability r =
        reliability(std::vector<double>{0.95, 0.85, 0.05, 1.0}, std::vector<unsigned char>{1, 0, 0, 1}, 10);
    EXPECT_EQ(r.bins[9].count, 2u);
    EXPECT_NEAR(r.bins[9].mean_confidence, 0.975, 1e-12);
    EXPECT_EQ(r.bins[9].accuracy, 1.0);
    EXPECT_EQ(r.bins[8].accuracy, 0.0);
    EXPECT_TRUE(std::isnan(r.bins[3].accuracy));
    EXPECT_NEAR(r.expected_calibration_error, (0.05 + 0.85 + 0.05) / 4.0, 1e-12);
    EXPECT_NEAR(r.brier_score, (0.0025 + 0.7225 + 0.0025) / 4.0, 1e-12);
}

}  // namespace
}  // namespace morphodesic::analysis
