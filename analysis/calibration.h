#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace morphodesic::analysis {

enum class CalibrationKind {
    /// confidence = 1 / (1 + exp(-(offset + slope margin))), slope >= 0 (Platt 1999, with his soft targets, and drawn
    /// towards 1/2 at margin 0 as if by root n more answers)
    logistic,
    isotonic,  ///< steps of the monotone regression of right / wrong on the margin; wants some hundred answers
};

/// From the margin of an answer to the probability that it is right.
struct ConfidenceCurve {
    CalibrationKind kind = CalibrationKind::logistic;
    double offset = std::numeric_limits<double>::quiet_NaN(), slope = offset;
    std::vector<std::pair<double, double>> steps;  ///< isotonic: margin, confidence; linear in between
    [[nodiscard]] double operator()(double margin) const;
};
/// @param right 1 if the answer was right, else 0. Without answers nothing is known: NaN everywhere.
[[nodiscard]] ConfidenceCurve fit_confidence(std::span<const double> margins, std::span<const unsigned char> right,
                                             CalibrationKind kind);

struct ReliabilityBin {
    double low, high;  ///< bin of stated confidences, [low, high)
    std::size_t count;
    double mean_confidence;  ///< what was said; NaN for an empty bin
    double accuracy;         ///< what was true; NaN for an empty bin
};
/// Data of a reliability diagram.
struct Reliability {
    std::vector<ReliabilityBin> bins;
    double expected_calibration_error =
        0.0;                   ///< mean |confidence - accuracy| over answers, by bins; NaN without answers
    double brier_score = 0.0;  ///< mean (confidence - right)^2; NaN without answers
};
[[nodiscard]] Reliability reliability(std::span<const double> confidences, std::span<const unsigned char> right,
                                      std::size_t bins = 10);

}  // namespace morphodesic::analysis
