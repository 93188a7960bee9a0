#include <gtest/gtest.h>

#include <cmath>

#include "geodesic/grid/measures.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/path_interpolation.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

/// w(x) = amount * bump(x) * (x - centre), with a bump that is 1 in the middle and 0 on the boundary.
template <int Dim>
Deformation<Dim> swelling(int level, double amount) {
    Deformation<Dim> phi{DyadicGrid<Dim>(level)};
    for (std::size_t i = 0; i < phi.grid().node_count(); ++i) {
        const auto x = phi.grid().position(phi.grid().node(i));
        double bump = 1.0;
        for (std::size_t a = 0; a < Dim; ++a) bump *= 4.0 * x[a] * (1.0 - x[a]);
        for (std::size_t a = 0; a < Dim; ++a) phi.displacement.components[a][i] = amount * bump * (x[a] - 0.5);
    }
    return phi;
}

template <int Dim>
GeodesicResult<Dim> two_steps(int level) {
    GeodesicResult<Dim> path;
    path.deformations = {swelling<Dim>(level, 0.2), swelling<Dim>(level, 0.1)};
    path.shapes = {tests::ball<Dim>(level, 0.2), tests::ball<Dim>(level, 0.235), tests::ball<Dim>(level, 0.26)};
    return path;
}

template <class Type>
class PathInterpolation : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PathInterpolation, Dimensions);

TYPED_TEST(PathInterpolation, InverseUndoesTheDeformation) {
    constexpr int Dim = TypeParam::value;
    const auto phi = swelling<Dim>(5, 0.4);
    Point<Dim> y{};
    for (std::size_t a = 0; a < Dim; ++a) y[a] = 0.31 + 0.17 * static_cast<double>(a);
    for (const double share : {0.3, 1.0}) {
        const Point<Dim> x = inverse_at<Dim>(phi, y, share);
        for (std::size_t a = 0; a < Dim; ++a) {
            EXPECT_NEAR(x[a] + share * q1::value(phi.grid(), phi.displacement.components[a].data(), x), y[a], 1e-8);
        }
    }
}

TYPED_TEST(PathInterpolation, APathWalkedBackEndsWhereItBegan) {
    constexpr int Dim = TypeParam::value;
    auto path = two_steps<Dim>(5);
    path.deformation_energy = {1.0, 2.0};
    path.mismatch_energy = {3.0, 4.0};
    const auto back = reversed(path);
    EXPECT_EQ(back.deformation_energy, (std::vector{2.0, 1.0}));
    EXPECT_EQ(back.mismatch_energy, (std::vector{4.0, 3.0}));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(back.shapes[k].values, path.shapes[2 - k].values);
    const auto there = deformation_at(path, 1.0), home = deformation_at(back, 1.0);
    const double h = there.grid().spacing();
    double moved = 0.0;
    for (std::size_t i = 0; i < there.grid().node_count(); ++i) {
        const auto x = there.grid().position(there.grid().node(i));
        Point<Dim> y = x;
        for (std::size_t a = 0; a < Dim; ++a) y[a] += there.displacement.components[a][i];
        for (std::size_t a = 0; a < Dim; ++a) {
            moved = std::max(moved, std::abs(y[a] - x[a]));
            EXPECT_NEAR(y[a] + q1::value(home.grid(), home.displacement.components[a].data(), y), x[a], 0.1 * h);
        }
    }
    EXPECT_GT(moved, h);
}

TYPED_TEST(PathInterpolation, EndsAndStepsAreThoseOfThePath) {
    constexpr int Dim = TypeParam::value;
    const auto path = two_steps<Dim>(4);
    EXPECT_EQ(shape_at(path, 0.0).values, path.shapes[0].values);
    EXPECT_EQ(shape_at(path, 0.5).values, path.shapes[1].values);
    EXPECT_EQ(shape_at(path, 1.0).values, path.shapes[2].values);
    const auto first_step = deformation_at(path, 0.5);
    for (std::size_t a = 0; a < Dim; ++a) {
        for (std::size_t i = 0; i < first_step.grid().node_count(); ++i) {
            ASSERT_NEAR(first_step.displacement.components[a][i], path.deformations[0].displacement.components[a][i],
                        1e-15);
        }
    }
    for (const auto& component : deformation_at(path, 0.0).displacement.components) {
        for (const double w : component) EXPECT_EQ(w, 0.0);
    }
}

TYPED_TEST(PathInterpolation, DeformationsAreComposedAndLinearWithinAStep) {
    constexpr int Dim = TypeParam::value;
    const auto path = two_steps<Dim>(4);
    const auto quarter = deformation_at(path, 0.25), end = deformation_at(path, 1.0);
    const auto& grid = path.deformations[0].grid();
    typename DyadicGrid<Dim>::Index node{};
    for (std::size_t a = 0; a < Dim; ++a) node[a] = 5 + 2 * static_cast<int>(a);
    const std::size_t i = grid.index(node);
    Point<Dim> x = grid.position(node);
    for (std::size_t a = 0; a < Dim; ++a) {
        const double first = path.deformations[0].displacement.components[a][i];
        EXPECT_NEAR(quarter.displacement.components[a][i], 0.5 * first, 1e-15);
        x[a] += first;
    }
    for (std::size_t a = 0; a < Dim; ++a) {
        const double second = q1::value(grid, path.deformations[1].displacement.components[a].data(), x);
        EXPECT_NEAR(grid.position(node)[a] + end.displacement.components[a][i], x[a] + second, 1e-14);
    }
}

TYPED_TEST(PathInterpolation, ShapesBetweenGrowSteadily) {
    constexpr int Dim = TypeParam::value;
    const auto path = two_steps<Dim>(5);
    double before = measure(shape_at(path, 0.0)).volume;
    for (const double t : {0.2, 0.4, 0.6, 0.8, 1.0}) {
        const double now = measure(shape_at(path, t)).volume;
        EXPECT_GT(now, before) << t;
        before = now;
    }
}

TEST(PathInterpolationInput, TimesOutsideThePathAreRefused) {
    const auto path = two_steps<2>(3);
    EXPECT_THROW(shape_at(path, -0.1), std::invalid_argument);
    EXPECT_THROW(deformation_at(path, 1.5), std::invalid_argument);
    EXPECT_THROW(shape_at(GeodesicResult<2>{}, 0.5), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic
