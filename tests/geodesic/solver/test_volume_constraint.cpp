#include <gtest/gtest.h>

#include <cmath>

#include "geodesic/solver/cascade.h"
#include "geodesic/solver/volume_constraint.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

TEST(VolumeConstraint, VolumesAreReachedHoweverSteepTheLevelSet) {
    const auto first = tests::ball<2>(5, 0.2), last = tests::ball<2>(5, 0.25);
    const PathEnergy<2> energy(first, last, 4, GeodesicOptions{});
    const VolumeConstraint<2> constraint(energy);
    const double from = enclosed_volume(first.grid, first.values.data());
    const double to = enclosed_volume(last.grid, last.values.data());
    for (const double steepness : {0.3, 1.0, 40.0, 1e4}) {
        for (const double offset : {-0.1, 0.0, 0.15}) {
            auto path = blended_path(first, last, 4);
            for (int k = 1; k < 4; ++k) {
                double* u = path.x.data() + path.layout.level_set(k);
                for (std::size_t i = 0; i < path.layout.nodes(); ++i) u[i] = steepness * (u[i] + offset);
            }
            ASSERT_TRUE(constraint.correct(path.x)) << steepness << " " << offset;
            for (int k = 1; k < 4; ++k) {
                const double expected = from + (to - from) * k / 4;
                EXPECT_NEAR(enclosed_volume(first.grid, path.x.data() + path.layout.level_set(k)), expected,
                            1e-9 * expected);
            }
        }
    }
}

/// A small step along what is left of a direction keeps the volumes to first order, one along the direction does not;
/// and what is left of the gradient says how the energy changes along the constraint.
TEST(VolumeConstraint, ProjectionsAreTangentToEqualVolumes) {
    constexpr int steps = 3;
    const auto first = tests::ball<2>(6, 0.2), last = tests::ball<2>(6, 0.25);
    const PathEnergy<2> energy(first, last, steps, GeodesicOptions{});
    const VolumeConstraint<2> constraint(energy);
    auto path = blended_path(first, last, steps);
    ASSERT_TRUE(constraint.correct(path.x));
    const auto volume = [&](int k, const std::vector<double>& x) {
        return enclosed_volume(first.grid, x.data() + path.layout.level_set(k));
    };
    std::vector<float> direction(path.x.size(), 0.0F), gradient(path.x.size());
    for (std::size_t i = path.layout.level_set(1); i < direction.size(); ++i) {
        direction[i] = static_cast<float>(1.0 + 0.5 * std::sin(0.1 * static_cast<double>(i)));
    }
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        gradient[i] = static_cast<float>(std::cos(0.2 * static_cast<double>(i)));
    }
    const auto moved = [&](double t) {
        std::vector<double> x = path.x;
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += t * static_cast<double>(direction[i]);
        return x;
    };
    constexpr double t = 1e-4;
    const auto change = [&](int k) { return std::abs(volume(k, moved(t)) - volume(k, moved(-t))) / (2 * t); };
    std::vector<double> before;
    for (int k = 1; k < steps; ++k) before.push_back(change(k));
    constraint.project_direction(path.x, direction);
    constraint.project_gradient(path.x, gradient);
    for (int k = 1; k < steps; ++k) {
        EXPECT_GT(before[static_cast<std::size_t>(k) - 1], 0.5);  // the length of the contour is more than 1
        EXPECT_LT(change(k), 0.01 * before[static_cast<std::size_t>(k) - 1]) << k;
        double sum = 0.0;
        for (std::size_t i = 0; i < path.layout.nodes(); ++i) {
            sum += static_cast<double>(gradient[path.layout.level_set(k) + i]);
        }
        EXPECT_NEAR(sum, 0.0, 1e-3) << "shifts of u_k are taken back by the corrector";
    }
}

TEST(VolumeConstraint, AShapeThatHasVanishedIsToldApart) {
    const auto u = tests::ball<2>(5, 0.2);
    const PathEnergy<2> energy(u, u, 2, GeodesicOptions{});
    auto path = blended_path(u, u, 2);
    std::fill_n(path.x.begin() + static_cast<std::ptrdiff_t>(path.layout.level_set(1)), path.layout.nodes(), -0.3);
    EXPECT_FALSE(VolumeConstraint<2>(energy).correct(path.x));
}

}  // namespace
}  // namespace morphodesic
