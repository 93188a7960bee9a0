#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "geodesic/solver/lbfgs_history.h"

namespace morphodesic {
namespace {

/// The direction against the two loops written out [Nocedal & Wright, algorithm 7.4] in double precision on the rounded
/// pairs, while the history fills, learns from steps that are not taken, drops old pairs and is cleared once.
TEST(LbfgsHistory, DirectionIsThatOfTheTwoLoops) {
    constexpr int n = 9000, capacity = 4;  // more than two chunks
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    const auto draw = [&] { return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); }).eval(); };
    const Eigen::VectorXd curvature = draw().cwiseAbs2() + Eigen::VectorXd::Constant(n, 0.5);
    const Eigen::VectorXd scaling = draw().cwiseAbs() + Eigen::VectorXd::Constant(n, 0.1);  // the preconditioner
    const auto as_float = [](const Eigen::VectorXd& v) { return std::vector<float>(v.begin(), v.end()); };
    const auto as_double = [](const Eigen::VectorXd& v) { return std::vector<double>(v.begin(), v.end()); };

    const auto rounded = [](const Eigen::VectorXd& v) {
        return v.unaryExpr([](double e) { return double{kernels::HalfFloat(static_cast<float>(e)).value()}; }).eval();
    };

    LbfgsHistory history(n, capacity);
    std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> pairs;
    Eigen::VectorXd x = draw(), g = curvature.cwiseProduct(x);
    const auto expect_two_loops = [&](int iteration) {
        std::vector<float> direction(n);
        history.before(as_float(g), direction);
        for (int i = 0; i < n; ++i) direction[static_cast<std::size_t>(i)] *= static_cast<float>(scaling(i));
        history.after(direction);

        Eigen::VectorXd q = g;
        std::vector<double> alpha(pairs.size());
        for (std::size_t i = pairs.size(); i-- > 0;) {
            alpha[i] = pairs[i].first.dot(q) / pairs[i].first.dot(pairs[i].second);
            q -= alpha[i] * pairs[i].second;
        }
        q = scaling.cwiseProduct(q);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const double beta = pairs[i].second.dot(q) / pairs[i].first.dot(pairs[i].second);
            q += (alpha[i] - beta) * pairs[i].first;
        }
        double error = 0.0;
        for (int i = 0; i < n; ++i)
            error += std::pow(static_cast<double>(direction[static_cast<std::size_t>(i)]) + q(i), 2);
        EXPECT_LT(std::sqrt(error), 1e-4 * q.norm()) << "iteration " << iteration;
    };
    for (int iteration = 0; iteration < 12; ++iteration) {
        if (iteration == 6) {
            history.clear();
            pairs.clear();
        }
        expect_two_loops(iteration);
        const auto remember = [&](const Eigen::VectorXd& next) {
            pairs.emplace_back(rounded(next - x), rounded(curvature.cwiseProduct(next) - g));
            if (pairs.size() > capacity) pairs.erase(pairs.begin());
        };
        for (int tried = 0; tried < iteration % 3; ++tried) {
            const Eigen::VectorXd there = x + draw(), there_g = curvature.cwiseProduct(there);
            history.add_tried(as_double(there), as_double(x), as_float(there_g), as_float(g), 0.0);
            remember(there);
            expect_two_loops(iteration);
        }
        const Eigen::VectorXd next = x + draw(), next_g = curvature.cwiseProduct(next);
        history.add(as_double(next), as_double(x), as_float(next_g), as_float(g), 0.0);
        remember(next);
        x = next;
        g = next_g;
    }
}

TEST(HalfFloat, IsTheNearestWithEightBitsOfMantissa) {
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    for (int i = 0; i < 1000; ++i) {
        const float v = std::ldexp(normal(random), i % 80 - 40);
        const float kept = kernels::HalfFloat(v).value();
        EXPECT_LE(std::abs(kept - v), std::abs(v) / 256) << v;
        EXPECT_EQ(kernels::HalfFloat(kept).value(), kept);
    }
    EXPECT_EQ(kernels::HalfFloat(0.0F).value(), 0.0F);
    EXPECT_EQ(kernels::HalfFloat(-1.5F).value(), -1.5F);
}

TEST(LbfgsHistory, StepsWithoutCurvatureAreLeftOut) {
    constexpr std::size_t n = 10;
    LbfgsHistory history(n, 2);
    std::vector<double> x(n, 1.0), x0(n, 0.0);
    std::vector<float> g(n, -1.0F), g0(n, 1.0F), direction(n);
    history.before(g0, direction);
    history.add(x, x0, g, g0, 0.0);  // s . y = -20
    EXPECT_TRUE(history.empty());
    history.before(g, direction);
    history.after(direction);
    for (const float d : direction) EXPECT_EQ(d, 1.0F);
}

}  // namespace
}  // namespace morphodesic
