#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

#include "geodesic/solver/path_window.h"
#include "pipeline/memory_model.h"
#include "pipeline/solid_reach.h"

namespace morphodesic::pipeline {
namespace {

TEST(MemoryModel, GrowsWithTheGridTheStepsAndTheDimension) {
    EXPECT_NEAR(static_cast<double>(bytes_of_pair(2, 8, 8)) / static_cast<double>(bytes_of_pair(2, 7, 8)), 4, 0.1);
    EXPECT_NEAR(static_cast<double>(bytes_of_pair(3, 7, 8)) / static_cast<double>(bytes_of_pair(3, 6, 8)), 8, 0.3);
    EXPECT_GT(bytes_of_pair(2, 6, 8), 19 * bytes_of_pair(2, 6, 4) / 10);
}

TEST(MemoryModel, PairsAndShapesShareWhatThereIs) {
    const std::size_t pair = bytes_of_pair(3, 6, 4) + 2 * bytes_of_shape(3, 6);
    const auto limit = [&](double pairs) {
        return std::to_string(bytes_of_program + static_cast<std::size_t>(pairs * static_cast<double>(pair)));
    };
    EXPECT_EQ(plan_memory(limit(3.1), 3, 6, 6, 4, 10, 8).pairs_in_flight, 3);
    EXPECT_EQ(plan_memory(limit(30), 3, 6, 6, 4, 10, 8).pairs_in_flight, 8);
    EXPECT_THROW((void)plan_memory(limit(0.9), 3, 6, 6, 4, 10, 8), std::invalid_argument);
    const MemoryPlan many = plan_memory(limit(2.5), 3, 6, 6, 4, 100000, 2);
    EXPECT_LT(many.shapes, many.all_shapes);
    EXPECT_LE(many.predicted, many.limit);
}

/// Ellipsoid with half axes (a, b, c), its longest axis turned in the plane of the first two.
LevelSet<3> ellipsoid(const std::array<double, 3>& axes, double angle, int level = 6) {
    LevelSet<3> u{DyadicGrid<3>(level)};
    const double least = std::min({axes[0], axes[1], axes[2]});
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const auto p = u.grid.position(u.grid.node(i));
        const double x = p[0] - 0.5, y = p[1] - 0.5, z = p[2] - 0.5;
        const double along = std::cos(angle) * x + std::sin(angle) * y,
                     across = std::cos(angle) * y - std::sin(angle) * x;
        u.values[i] = least * (1 - std::hypot(along / axes[0], across / axes[1], z / axes[2]));
    }
    return u;
}

/// Share of the cube in the window that the solver takes for a pair.
double taken(const LevelSet<3>& first, const LevelSet<3>& last) {
    const auto window = PathWindow<3>::around(blended_path(first, last, 1), first, last);
    if (!window) return 1.0;
    const auto& cells = window->grid().cells();
    return static_cast<double>(cells[0]) * cells[1] * cells[2] / std::pow(first.grid.cells_per_axis(), 3);
}

TEST(SolidReach, NoWindowIsLargerThanPredicted) {
    const std::array<double, 3> sizes[] = {{0.36, 0.12, 0.1}, {0.3, 0.2, 0.08},   {0.25, 0.24, 0.07},
                                           {0.2, 0.2, 0.2},   {0.36, 0.34, 0.33}, {0.1, 0.06, 0.05}};
    for (const auto& a : sizes) {
        for (const auto& b : sizes) {
            for (const double angle : {0.0, 0.6}) {
                const auto fixed = ellipsoid(b, angle);
                // Rigidly aligned: the longest axis on the longest one.
                EXPECT_GE(window_share(reach_of(ellipsoid(a, 1.2)), reach_of(fixed), 6, true),
                          taken(ellipsoid(a, angle), fixed))
                    << a[0] << ' ' << b[0] << ' ' << angle;
                EXPECT_GE(window_share(reach_of(ellipsoid(a, 1.2)), reach_of(fixed), 6, false),
                          taken(ellipsoid(a, 1.2), fixed));
            }
        }
    }
}

TEST(SolidReach, ThinSolidsNeedAPartOfTheCubeAndFullOnesAllOfIt) {
    const SolidReach foot = reach_of(ellipsoid({0.36, 0.12, 0.1}, 0)),
                     ball = reach_of(ellipsoid({0.36, 0.36, 0.36}, 0));
    EXPECT_LT(window_share(foot, foot, 6, true), 0.6);
    EXPECT_EQ(window_share(ball, ball, 6, true), 1.0);
    EXPECT_EQ(window_share(ball, foot, 6, true), 1.0);
    const SolidReach all[] = {foot, foot, ball};
    EXPECT_EQ(largest_window_share(all, 6, true), 1.0);
    EXPECT_LT(largest_window_share(std::span(all).first(2), 6, true), 0.6);
    const SolidReach half = foot.scaled(0.5);
    EXPECT_NEAR(half.radius, 0.5 * foot.radius, 1e-12);
    EXPECT_LT(window_share(half, half, 6, true), window_share(foot, foot, 6, true));
    EXPECT_LT(window_share(foot, foot, 7, true), window_share(foot, foot, 6, true));
    EXPECT_EQ(largest_window_share({}, 6, true), 1.0);
}

/// Peaks in MB of the whole program at L = 6, K = 4: two feet, cat and lion (windows), balls (no window).
TEST(MemoryModel, IsNeverBelowWhatWasMeasuredAndNotFarAboveIt) {
    const auto predicted = [](double share) {
        const std::size_t bytes = bytes_of_program + bytes_of_pair(3, 6, 4, share) + 2 * bytes_of_shape(3, 6);
        return static_cast<double>(bytes >> 20);
    };
    const SolidReach foot = reach_of(ellipsoid({0.36, 0.12, 0.1}, 0));
    EXPECT_GT(predicted(window_share(foot, foot, 6, true)), 324);
    EXPECT_LT(predicted(window_share(foot, foot, 6, true)), 520);
    EXPECT_GT(predicted(1.0), 560);
}

}  // namespace
}  // namespace morphodesic::pipeline
