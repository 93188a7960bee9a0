#include <gtest/gtest.h>

#include "geodesic/discrete_geodesic.h"
#include "geodesic/energy/path_energy.h"
#include "geodesic/solver/path_minimizer.h"
#include "geodesic/solver/path_window.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class T>
class PathWindowIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PathWindowIn, Dimensions);

constexpr int window_level(int dim) {
    return dim == 2 ? 7 : 5;
}

template <int Dim>
Point<Dim> point(double x, double others) {
    Point<Dim> p;
    p.fill(others);
    p[0] = x;
    return p;
}

/// Two balls apart, so that a window leaves out most of the cube, and a path of three shapes with smooth deformations.
template <int Dim>
struct Problem {
    LevelSet<Dim> first = tests::ball<Dim>(window_level(Dim), 0.1, point<Dim>(0.3, 0.3));
    LevelSet<Dim> last = tests::ball<Dim>(window_level(Dim), 0.12, point<Dim>(0.32, 0.28));
    PathState<Dim> path = blended_path(first, last, 2);
    PathWindow<Dim> window = PathWindow<Dim>::around(path, first, last).value();
    PathEnergy<Dim> whole{first, last, 2, GeodesicOptions{}};
    PathEnergy<Dim> part{window.cut_out(first), window.cut_out(last), 2, GeodesicOptions{}};

    Problem() {
        const auto& layout = path.layout;
        for (std::size_t i = 0; i < layout.nodes(); ++i) {
            const auto at = layout.grid.position(layout.grid.node(i));
            for (int k = 1; k <= 2; ++k) {
                for (int a = 0; a < Dim; ++a) {
                    path.x[layout.displacement(k, a) + i] = 0.02 * tests::smooth_wave<Dim>(at, a, k);
                }
            }
        }
    }
};

TYPED_TEST(PathWindowIn, HoldsTheShapesWithRoom) {
    constexpr int dim = TypeParam::value;
    const Problem<dim> problem;
    const auto& grid = problem.window.grid();
    EXPECT_LT(grid.node_count(), problem.path.layout.nodes() / 2);
    EXPECT_EQ(grid.cells(0) % 16, 0);
    const auto near = problem.window.cut_out(problem.last);
    ASSERT_EQ(near.grid, grid);
    std::size_t inside = 0, all = 0;
    for (std::size_t i = 0; i < near.values.size(); ++i) {
        inside += near.values[i] > 0 ? 1 : 0;
        if (!grid.on_boundary(grid.node(i))) continue;
        ASSERT_LT(near.values[i], -0.05);
    }
    for (const double v : problem.last.values) all += v > 0 ? 1 : 0;
    EXPECT_EQ(inside, all);
}

TYPED_TEST(PathWindowIn, ShapesThatFillTheCubeHaveNone) {
    constexpr int dim = TypeParam::value;
    const auto large = tests::ball<dim>(window_level(dim), 0.45);
    EXPECT_FALSE(PathWindow<dim>::around(blended_path(large, large, 2), large, large).has_value());
    // A shape at the edge: the box ends there.
    const auto corner = tests::ball<dim>(window_level(dim), 0.1, point<dim>(0.95, 0.95));
    const auto window = PathWindow<dim>::around(blended_path(corner, corner, 2), corner, corner);
    ASSERT_TRUE(window.has_value());
    EXPECT_GT(window->cut_out(corner).values.back(), 0.0);
}

TYPED_TEST(PathWindowIn, TakesAShareThatIsKnownFromTheSidesOfTheBoxAndShrinksOnFinerGrids) {
    constexpr int dim = TypeParam::value;
    double before = 1.0;
    for (const int level : {5, 6, 7}) {
        const auto ball = tests::ball<dim>(level, 0.15);
        const auto window = PathWindow<dim>::around(blended_path(ball, ball, 1), ball, ball);
        double share = 1.0;
        std::array<double, dim> sides;
        sides.fill(0.3);
        if (window) {
            for (const int n : window->grid().cells()) share *= static_cast<double>(n) / (1 << level);
        }
        EXPECT_LE(share, window_share<dim>(level, sides)) << level;
        EXPECT_LE(share, before) << level;
        before = share;
    }
    EXPECT_LT(before, dim == 2 ? 0.26 : 0.2);  // room of a few cells: 6 in the plane, 11 in space
}

TYPED_TEST(PathWindowIn, WhatIsCutOutComesBack) {
    constexpr int dim = TypeParam::value;
    const Problem<dim> problem;
    auto part = problem.window.cut_out(problem.path);
    auto path = problem.path;
    problem.window.put_back(part, path);
    EXPECT_EQ(path.x, problem.path.x);
    for (double& v : part.x) v += 1.0;
    problem.window.put_back(part, path);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < path.x.size(); ++i) {
        if (path.x[i] == problem.path.x[i]) continue;
        ASSERT_EQ(path.x[i], problem.path.x[i] + 1.0);
        ++changed;
    }
    EXPECT_EQ(changed, part.x.size());
}

TYPED_TEST(PathWindowIn, GradientIsThatOfTheWholeCubeAwayFromItsFaces) {
    constexpr int dim = TypeParam::value;
    Problem<dim> problem;
    std::vector<double> gradient(problem.path.x.size());
    problem.whole.evaluate(problem.path.x, gradient);
    const auto from_whole = problem.window.cut_out(PathState<dim>{problem.path.layout, gradient});
    const auto path = problem.window.cut_out(problem.path);
    auto of_part = path;
    problem.part.evaluate(path.x, of_part.x);
    std::vector<float> single(path.x.size());
    problem.part.evaluate_single(path.x, single);
    const auto& layout = path.layout;
    double largest = 0.0;
    for (const double g : of_part.x) largest = std::max(largest, std::abs(g));
    std::size_t compared = 0;
    for (std::size_t i = 0; i < path.x.size(); ++i) {
        ASSERT_NEAR(static_cast<double>(single[i]), of_part.x[i], 1e-5 * largest);
        bool away = true;  // three cells: no point moves that far
        const auto node = layout.grid.node(i % layout.nodes());
        for (int a = 0; a < dim; ++a) {
            const int c = node[static_cast<std::size_t>(a)];
            away = away && c > 3 && c < layout.grid.cells(a) - 3;
        }
        if (!away) continue;
        ASSERT_NEAR(of_part.x[i], from_whole.x[i], 1e-12 * largest);
        ++compared;
    }
    EXPECT_GT(compared, path.x.size() / 4);
}

TYPED_TEST(PathWindowIn, MinimiserLowersTheEnergyOfTheWholePathAndKeepsTheFaces) {
    constexpr int dim = TypeParam::value;
    Problem<dim> problem;
    const double before = problem.whole.evaluate(problem.path.x, {}).total;
    auto path = problem.window.cut_out(problem.path);
    const auto start = path;
    MinimizerOptions options;
    const auto summary = minimize_path<dim>(problem.part, path.x, options);
    EXPECT_EQ(summary.termination, Termination::converged);
    for (int k = 1; k <= 2; ++k) {
        for (int a = 0; a < dim; ++a) {
            for (std::size_t i = 0; i < path.layout.nodes(); ++i) {
                if (!path.layout.grid.on_boundary(path.layout.grid.node(i))) continue;
                ASSERT_EQ(path.x[path.layout.displacement(k, a) + i], start.x[path.layout.displacement(k, a) + i]);
            }
        }
    }
    problem.window.put_back(path, problem.path);
    const auto after = problem.whole.evaluate(problem.path.x, {});
    EXPECT_LT(after.total, 0.5 * before);
    EXPECT_GT(after.min_det, 0.0);
}

}  // namespace
}  // namespace morphodesic
