#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/cascade.h"
#include "geodesic/solver/path_minimizer.h"
#include "geodesic/solver/slope_limit.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class Dimension>
class SlopeLimitIn : public ::testing::Test {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(SlopeLimitIn, Dimensions);

/// The largest slope along the edges and diagonals of cells that the contour of u crosses.
template <int Dim>
double steepest_crossing(const DyadicGrid<Dim>& grid, const double* u) {
    const auto corners = q1::corner_offsets(grid);
    double most = 0.0;
    q1::for_each_cell(grid, [&](std::size_t node) {
        for (std::size_t c = 0; c < corners.size(); ++c) {
            for (std::size_t d = 0; d < c; ++d) {
                const double change = std::abs(u[node + corners[c]] - u[node + corners[d]]);
                if ((u[node + corners[c]] > 0) == (u[node + corners[d]] > 0)) continue;
                double square = 0.0;
                for (int a = 0; a < Dim; ++a) square += ((c >> a) & 1) != ((d >> a) & 1) ? 1.0 : 0.0;
                most = std::max(most, change / (std::sqrt(square) * grid.spacing()));
            }
        }
    });
    return most;
}

TYPED_TEST(SlopeLimitIn, DistancesStayAsTheyAre) {
    constexpr int Dim = TypeParam::value;
    const auto first = tests::ball<Dim>(4, 0.2), last = tests::ball<Dim>(4, 0.25);
    auto path = blended_path(first, last, 4);
    const auto before = path.x;
    SlopeLimit<Dim> limit(path.layout);
    limit.apply(path.x);
    EXPECT_EQ(path.x, before);
    std::vector<float> gradient(path.x.size(), 1.0F);
    limit.hold(path.x, gradient);
    EXPECT_EQ(gradient, std::vector<float>(path.x.size(), 1.0F));
}

TYPED_TEST(SlopeLimitIn, ContoursAreNotSteepAfterwardsAndStayWhereTheyAre) {
    constexpr int Dim = TypeParam::value;
    const auto first = tests::ball<Dim>(5, 0.2), last = tests::ball<Dim>(5, 0.25);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> factor(0.1, 30.0);
    auto path = blended_path(first, last, 3);
    const auto& layout = path.layout;
    for (int k = 1; k < 3; ++k) {
        for (std::size_t i = 0; i < layout.nodes(); ++i) path.x[layout.level_set(k) + i] *= factor(random);
    }
    const auto before = path.x;
    ASSERT_GT(steepest_crossing(layout.grid, before.data() + layout.level_set(1)), 10.0);
    SlopeLimit<Dim> limit(path.layout);
    limit.apply(path.x);
    std::size_t scaled = 0;
    for (int k = 1; k < 3; ++k) {
        const double* u = path.x.data() + layout.level_set(k);
        EXPECT_LE(steepest_crossing(layout.grid, u), SlopeLimit<Dim>::steepest * (1 + 1e-12));
        for (std::size_t i = 0; i < layout.nodes(); ++i) {
            const double was = before[layout.level_set(k) + i];
            EXPECT_EQ(u[i] > 0, was > 0);
            EXPECT_LE(std::abs(u[i]), std::abs(was));
            scaled += u[i] != was;
        }
    }
    EXPECT_GT(scaled, 100U);
    // Displacements have no slope to be limited.
    EXPECT_TRUE(
        std::equal(path.x.begin(), path.x.begin() + static_cast<std::ptrdiff_t>(layout.level_set(1)), before.begin()));
    const auto once = path.x;
    limit.apply(path.x);
    for (std::size_t i = 0; i < once.size(); ++i) EXPECT_NEAR(path.x[i], once[i], 1e-12 * std::abs(once[i]));
}

/// Both ends of a steep edge are scaled alike: the contour crosses it where it did.
TEST(SlopeLimit, KeepsTheContourOnAnEdgeAndHoldsWhatWouldMakeItSteep) {
    const auto first = tests::ball<2>(5, 0.2), last = tests::ball<2>(5, 0.25);
    auto path = blended_path(first, last, 2);
    const auto& layout = path.layout;
    const double h = layout.grid.spacing();
    double* u = path.x.data() + layout.level_set(1);
    std::fill(u, u + layout.nodes(), -h);
    const std::size_t inside = layout.grid.index({9, 12}), outside = layout.grid.index({9, 13});
    u[inside] = 9.0 * h;  // a dot in four cells
    SlopeLimit<2> limit(path.layout);
    limit.apply(path.x);
    EXPECT_NEAR((u[inside] - u[outside]) / h, SlopeLimit<2>::steepest, 1e-12);
    EXPECT_NEAR(u[inside] / (u[inside] - u[outside]), 0.9, 1e-12);
    EXPECT_EQ(u[layout.grid.index({9, 14})], -h);

    std::vector<float> gradient(path.x.size(), 0.0F);
    float* g = gradient.data() + layout.level_set(1);
    g[inside] = -1.0F;   // a descent makes u larger there: steeper
    g[outside] = -1.0F;  // and here less steep
    const std::size_t elsewhere = layout.grid.index({20, 12});
    g[elsewhere] = 1.0F;
    limit.hold(path.x, gradient);
    EXPECT_EQ(g[inside], 0.0F);
    EXPECT_EQ(g[outside], -1.0F);
    EXPECT_EQ(g[elsewhere], 1.0F);
}

/// Two legs that are closed by a bar below: where the last crack vanishes, a mismatch would be hidden in steep
/// contours.
TEST(SlopeLimit, APathThatClosesACrackHasNoSteepContour) {
    const auto legs = tests::united<2>(tests::turned_box<2>(6, {0.06, 0.25}, {0.37, 0.5}, 0.2),
                                       tests::turned_box<2>(6, {0.06, 0.25}, {0.63, 0.5}, -0.2));
    const auto first = tests::united<2>(legs, tests::turned_box<2>(6, {0.19, 0.05}, {0.5, 0.7}, 0.0));
    const auto last = tests::united<2>(first, tests::turned_box<2>(6, {0.19, 0.05}, {0.5, 0.3}, 0.0));
    PathEnergy<2> energy(first, last, 2, GeodesicOptions{});
    auto path = blended_path(first, last, 2);
    MinimizerOptions options;
    options.tolerance = 1e-4;
    ASSERT_EQ(minimize_path<2>(energy, path.x, options).termination, Termination::converged);
    EXPECT_LE(steepest_crossing(first.grid, path.x.data() + path.layout.level_set(1)),
              SlopeLimit<2>::steepest * (1 + 1e-12));
}

}  // namespace
}  // namespace morphodesic
