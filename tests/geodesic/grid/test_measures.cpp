#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geodesic/grid/contour.h"
#include "geodesic/grid/measures.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

using std::numbers::pi;

template <int Dim, class F>
LevelSet<Dim> level_set_of(int level, const F& f) {
    LevelSet<Dim> u{DyadicGrid<Dim>(level)};
    for (std::size_t i = 0; i < u.values.size(); ++i) u.values[i] = f(u.grid.position(u.grid.node(i)));
    return u;
}

double ring(const Point<2>& x) {
    return 0.1 - std::abs(std::hypot(x[0] - 0.5, x[1] - 0.5) - 0.25);
}

TEST(Measures, DiskAndBallConvergeWithSecondOrder) {
    double area_error[2], ball_error[2], sphere_error[2];
    for (int i = 0; i < 2; ++i) {
        const auto disk = measure(tests::ball<2>(5 + i, 0.3));
        area_error[i] = std::abs(disk.volume - pi * 0.09);
        EXPECT_NEAR(disk.surface, 2 * pi * 0.3, 0.004 / (1 + 3 * i));
        const auto ball = measure(tests::ball<3>(4 + i, 0.3));
        ball_error[i] = std::abs(ball.volume - 4.0 / 3.0 * pi * 0.027);
        sphere_error[i] = std::abs(ball.surface - 4.0 * pi * 0.09);
    }
    EXPECT_LT(area_error[1], 0.35 * area_error[0]);
    EXPECT_LT(ball_error[1], 0.35 * ball_error[0]);
    EXPECT_LT(sphere_error[1], 0.35 * sphere_error[0]);
    EXPECT_LT(ball_error[1], 0.01 * 4.0 / 3.0 * pi * 0.027);
}

TEST(Measures, FullnessOfBallsIsOneAndGapsLowerIt) {
    double disk_error[2], ball_error[2], ring_error[2];
    // A ring of radii r and R: g^2 = (R^2 + r^2) / 2.
    const double r = 0.15, R = 0.35, volume = R * R - r * r;
    const double exact = volume / (R * R + r * r) * std::sqrt(volume) / (R + r);
    for (int i = 0; i < 2; ++i) {
        disk_error[i] = std::abs(fullness(tests::ball<2>(5 + i, 0.3, {0.43, 0.55})) - 1.0);
        ball_error[i] = std::abs(fullness(tests::ball<3>(4 + i, 0.3)) - 1.0);
        ring_error[i] = std::abs(fullness(level_set_of<2>(5 + i, ring)) / exact - 1.0);
    }
    for (const auto& error : {disk_error, ball_error, ring_error}) {
        EXPECT_LT(error[1], std::max(0.4 * error[0], 1e-3));
        EXPECT_LT(error[1], 0.015);
    }
    EXPECT_EQ(fullness(tests::ball<2>(5, -0.1)), 0.0);
}

TEST(Measures, FullnessDoesNotSeeMotionsOrSize) {
    const auto box = [](double half, double angle, Point<2> centre) {
        return fullness(tests::turned_box<2>(7, {half, 0.3 * half}, centre, angle));
    };
    const double as_it_is = box(0.3, 0.0, {0.5, 0.5});
    EXPECT_LT(as_it_is, 0.7);
    EXPECT_NEAR(box(0.3, 0.7, {0.47, 0.52}) / as_it_is, 1.0, 2e-3);
    EXPECT_NEAR(box(0.36, 0.0, {0.5, 0.5}) / as_it_is, 1.0, 5e-3);
}

TEST(Measures, HalfSpacesAreExact) {
    const auto plane = level_set_of<3>(3, [](const Point<3>& x) { return x[0] + 0.5 * x[1] - 0.25 * x[2] - 0.55; });
    const auto rest = level_set_of<3>(3, [](const Point<3>& x) { return -(x[0] + 0.5 * x[1] - 0.25 * x[2] - 0.55); });
    const auto a = measure(plane), b = measure(rest);
    EXPECT_NEAR(a.volume + b.volume, 1.0, 1e-12);
    EXPECT_NEAR(a.volume, 1.0 - (0.55 - 0.25 + 0.125), 1e-12);  // 1 - the mean of 0.55 - x1/2 + x2/4 over the face
    EXPECT_NEAR(a.surface, b.surface, 1e-12);
    EXPECT_NEAR(a.surface, std::sqrt(1 + 0.25 + 0.0625), 1e-12);  // over the unit face, graph over (x1, x2)
}

TEST(Measures, EulerNumbersOfKnownShapes) {
    EXPECT_EQ(measure(tests::ball<2>(5, 0.3)).euler, 1);
    const auto annulus = measure(level_set_of<2>(5, ring));
    EXPECT_EQ(annulus.euler, 0);
    EXPECT_EQ(annulus.components, 1);
    const auto two = measure(level_set_of<2>(5, [](const Point<2>& x) {
        return 0.12 - std::min(std::hypot(x[0] - 0.25, x[1] - 0.5), std::hypot(x[0] - 0.75, x[1] - 0.5));
    }));
    EXPECT_EQ(two.euler, 2);
    EXPECT_EQ(two.components, 2);
    EXPECT_EQ(measure(tests::ball<3>(4, 0.3)).euler, 1);
    const auto torus = measure(level_set_of<3>(
        5, [](const Point<3>& x) { return 0.1 - std::hypot(std::hypot(x[0] - 0.5, x[1] - 0.5) - 0.25, x[2] - 0.5); }));
    EXPECT_EQ(torus.euler, 0);
    const auto shell = measure(level_set_of<3>(
        5, [](const Point<3>& x) { return 0.06 - std::abs(std::hypot(x[0] - 0.5, x[1] - 0.5, x[2] - 0.5) - 0.25); }));
    EXPECT_EQ(shell.euler, 2);
    EXPECT_EQ(shell.components, 1);
}

TEST(Measures, PartsAddUpToTheWhole) {
    const auto u = level_set_of<2>(5, ring);
    const auto left = [](const Point<2>& x) { return x[0] < 0.4; };
    EXPECT_NEAR(volume_where(u, left) + volume_where(u, [&](const Point<2>& x) { return !left(x); }), measure(u).volume,
                1e-12);
}

TEST(Contour, LoopsEncloseTheObjectOnTheirLeft) {
    const auto loops = contour(level_set_of<2>(6, ring));
    ASSERT_EQ(loops.size(), 2U);
    double area = 0.0;
    int turning_left = 0;
    for (const auto& loop : loops) {
        double signed_area = 0.0;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const auto &p = loop[i], &q = loop[(i + 1) % loop.size()];
            signed_area += 0.5 * (p[0] * q[1] - q[0] * p[1]);
        }
        area += signed_area;
        turning_left += signed_area > 0;
    }
    EXPECT_EQ(turning_left, 1);
    EXPECT_NEAR(area, pi * (0.35 * 0.35 - 0.15 * 0.15), 2e-3);
}

TEST(Contour, AnObjectAtTheBorderIsClosed) {
    const auto loops = contour(level_set_of<2>(4, [](const Point<2>& x) { return x[0] - 0.5; }));
    ASSERT_EQ(loops.size(), 1U);
    EXPECT_GT(loops[0].size(), 32U);
}

TEST(Contour, PartsThatTouchInACellAreJoinedByItsMiddle) {
    LevelSet<2> u(DyadicGrid<2>(2), -1.0);
    u.values[u.grid.index({1, 1})] = u.values[u.grid.index({2, 2})] = 0.8;
    EXPECT_EQ(contour(u).size(), 2U);
    u.values[u.grid.index({1, 1})] = u.values[u.grid.index({2, 2})] = 1.2;
    EXPECT_EQ(contour(u).size(), 1U);
}

}  // namespace
}  // namespace morphodesic
