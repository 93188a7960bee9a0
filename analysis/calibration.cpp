#include "analysis/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "analysis/smacof.h"
#include "analysis/special_numbers.h"

namespace morphodesic::analysis {
namespace {

double logistic(double t) {
    return t >= 0.0 ? 1.0 / (1.0 + std::exp(-t)) : std::exp(t) / (1.0 + std::exp(t));
}

/// Newton's method on the cross entropy, which is convex; halved steps keep it from overshooting. Where nearly all
/// answers are right the margins alone would not tell how little a small one means: at margin 0 two classes are equally
/// near, so one of two such answers is wrong. That counts like the root of the number of answers, little among many.
void fit_logistic(std::span<const double> margins, std::span<const unsigned char> right, ConfidenceCurve& curve) {
    const auto count = static_cast<double>(margins.size());
    const double good = std::accumulate(right.begin(), right.end(), 0.0), bad = count - good;
    const double target_good = (good + 1.0) / (good + 2.0), target_bad = 1.0 / (bad + 2.0);
    const double rate = (good * target_good + bad * target_bad) / count;
    const double flat = std::log(rate / (1.0 - rate));
    const double toss = std::sqrt(count);
    const auto softplus = [](double t) { return t > 0.0 ? std::log1p(std::exp(-t)) + t : std::log1p(std::exp(t)); };
    const auto loss = [&](double a, double b) {
        double sum = 0.0;
        for (std::size_t i = 0; i < margins.size(); ++i) {
            const double t = a + b * margins[i], target = right[i] != 0 ? target_good : target_bad;
            sum += softplus(t) - target * t;
        }
        return sum + toss * (softplus(a) - 0.5 * a);
    };
    double a = flat, b = 0.0, now = loss(a, b);
    for (int iteration = 0; iteration < 100; ++iteration) {
        double ga = 0.0, gb = 0.0, haa = 1e-12, hab = 0.0, hbb = 1e-12;
        for (std::size_t i = 0; i < margins.size(); ++i) {
            const double p = logistic(a + b * margins[i]), m = margins[i];
            const double g = p - (right[i] != 0 ? target_good : target_bad), w = p * (1.0 - p);
            ga += g;
            gb += g * m;
            haa += w;
            hab += w * m;
            hbb += w * m * m;
        }
        ga += toss * (logistic(a) - 0.5);
        haa += toss * logistic(a) * (1.0 - logistic(a));
        const double det = haa * hbb - hab * hab;
        if (!(det > 1e-14 * haa * hbb)) break;  // all margins alike: the rate is all there is to say
        const double da = (hbb * ga - hab * gb) / det, db = (haa * gb - hab * ga) / det;
        double step = 1.0;
        while (step > 1e-6 && !(loss(a - step * da, b - step * db) <= now)) step *= 0.5;
        if (step <= 1e-6) break;
        a -= step * da;
        b -= step * db;
        const double next = loss(a, b);
        const bool done = now - next <= 1e-12 * std::abs(now);
        now = next;
        if (done) break;
    }
    // A larger margin must not lower the confidence: then the margin says nothing, and the rate is used.
    curve.offset = b > 0.0 ? a : flat;
    curve.slope = b > 0.0 ? b : 0.0;
}

void fit_isotonic(std::span<const double> margins, std::span<const unsigned char> right, ConfidenceCurve& curve) {
    std::vector<std::size_t> order(margins.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return margins[i] < margins[j]; });
    std::vector<double> at, mean, weight;  // equal margins are one point
    for (const std::size_t i : order) {
        if (at.empty() || margins[i] != at.back()) {
            at.push_back(margins[i]);
            mean.push_back(0.0);
            weight.push_back(0.0);
        }
        mean.back() += right[i] != 0 ? 1.0 : 0.0;
        weight.back() += 1.0;
    }
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] /= weight[k];
    const std::vector<double> fitted = isotonic_regression(mean, weight);
    for (std::size_t k = 0; k < at.size(); ++k) {
        const bool inner = k > 0 && k + 1 < at.size() && fitted[k] == fitted[k - 1] && fitted[k] == fitted[k + 1];
        if (!inner) curve.steps.emplace_back(at[k], fitted[k]);
    }
}

}  // namespace

double ConfidenceCurve::operator()(double margin) const {
    if (kind == CalibrationKind::logistic) return logistic(offset + slope * margin);
    if (steps.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto after = std::lower_bound(steps.begin(), steps.end(), margin,
                                        [](const std::pair<double, double>& s, double m) { return s.first < m; });
    if (after == steps.begin()) return steps.front().second;
    if (after == steps.end()) return steps.back().second;
    const auto before = after - 1;
    const double t = (margin - before->first) / (after->first - before->first);
    return before->second + t * (after->second - before->second);
}

ConfidenceCurve fit_confidence(std::span<const double> margins, std::span<const unsigned char> right,
                               CalibrationKind kind) {
    if (margins.size() != right.size()) throw std::invalid_argument("one margin per answer is needed");
    ConfidenceCurve curve;
    curve.kind = kind;
    if (margins.empty()) return curve;
    if (kind == CalibrationKind::logistic) {
        fit_logistic(margins, right, curve);
    } else {
        fit_isotonic(margins, right, curve);
    }
    return curve;
}

Reliability reliability(std::span<const double> confidences, std::span<const unsigned char> right, std::size_t bins) {
    if (confidences.size() != right.size()) throw std::invalid_argument("one confidence per answer is needed");
    if (bins == 0) throw std::invalid_argument("a reliability diagram needs bins");
    Reliability result;
    const auto count = static_cast<double>(confidences.size());
    std::vector<double> said(bins, 0.0), truth(bins, 0.0);
    std::vector<std::size_t> members(bins, 0);
    double brier = 0.0;
    for (std::size_t i = 0; i < confidences.size(); ++i) {
        const double c = std::clamp(confidences[i], 0.0, 1.0), r = right[i] != 0 ? 1.0 : 0.0;
        const std::size_t bin = std::min(bins - 1, static_cast<std::size_t>(c * static_cast<double>(bins)));
        said[bin] += c;
        truth[bin] += r;
        ++members[bin];
        brier += (c - r) * (c - r);
    }
    double error = 0.0;
    for (std::size_t b = 0; b < bins; ++b) {
        const auto m = static_cast<double>(members[b]);
        const double low = static_cast<double>(b) / static_cast<double>(bins);
        const double high = static_cast<double>(b + 1) / static_cast<double>(bins);
        result.bins.push_back({low, high, members[b], m > 0.0 ? said[b] / m : nan, m > 0.0 ? truth[b] / m : nan});
        error += std::abs(said[b] - truth[b]);
    }
    result.expected_calibration_error = count > 0.0 ? error / count : nan;
    result.brier_score = count > 0.0 ? brier / count : nan;
    return result;
}

}  // namespace morphodesic::analysis
