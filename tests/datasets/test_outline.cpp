#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/outline.h"
#include "datasets/outline_geometry.h"
#include "tests/datasets/test_pictures.h"

namespace morphodesic::datasets {
namespace {

using std::numbers::pi;

Coverage coverage_of(const cv::Mat& image) {
    return {image.cols, image.rows, std::vector<float>(image.begin<float>(), image.end<float>())};
}

/// Largest distance of a vertex of the outline from a circle.
double off_circle(const Outline& outline, double x, double y, double radius) {
    double worst = 0.0;
    for (const Loop& loop : outline.loops) {
        for (const Point<2>& p : loop) worst = std::max(worst, std::abs(std::hypot(p[0] - x, p[1] - y) - radius));
    }
    return worst;
}

TEST(Outline, AntialiasedDiskIsSubPixel) {
    for (const double shift : {0.0, 0.13, 0.37, 0.5}) {
        const Outline outline = outline_of(coverage_of(tests::disk_picture(100, 50 + shift, 49 - shift, 30.3)));
        ASSERT_EQ(outline.loops.size(), 1U);
        EXPECT_LT(off_circle(outline, 50 + shift, 49 - shift, 30.3), 0.12);
        EXPECT_NEAR(moments(outline).area, pi * 30.3 * 30.3, 0.003 * pi * 30.3 * 30.3);
        EXPECT_NEAR(moments(outline).centroid[0], 50 + shift, 0.01);
        EXPECT_NEAR(moments(outline).centroid[1], 49 - shift, 0.01);
    }
}

TEST(Outline, BlackAndWhiteDiskHasNoStairCase) {
    const Outline outline = outline_of(coverage_of(tests::disk_picture(100, 50.2, 49.7, 30.3, 1)));
    EXPECT_LT(off_circle(outline, 50.2, 49.7, 30.3), 0.5);
    EXPECT_NEAR(moments(outline).area, pi * 30.3 * 30.3, 0.005 * pi * 30.3 * 30.3);
    double length = 0.0;
    const Loop& loop = outline.loops.at(0);
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Point<2>&a = loop[i], &b = loop[(i + 1) % loop.size()];
        length += std::hypot(b[0] - a[0], b[1] - a[1]);
    }
    EXPECT_NEAR(length, 2 * pi * 30.3, 0.01 * 2 * pi * 30.3);  // a stair-case is 27 % too long, its chamfers 5 %
}

TEST(Outline, SlantedBlackAndWhiteEdgeIsStraight) {
    for (const double slope : {0.1, 0.35, 0.77}) {
        const auto edge = [&](double x, double y) { return y < 20 + slope * x && x > 5 && x < 95 && y > 5; };
        const Outline outline = outline_of(coverage_of(tests::picture(100, 110, 1, edge)));
        double sum = 0.0, worst = 0.0;
        int n = 0;
        for (const Point<2>& p : outline.loops.at(0)) {
            if (p[0] < 15 || p[0] > 85 || p[1] < 10) continue;
            const double off = (p[1] - 20 - slope * p[0]) / std::hypot(1.0, slope);
            sum += off * off;
            worst = std::max(worst, std::abs(off));
            ++n;
        }
        ASSERT_GT(n, 60);
        EXPECT_LT(worst, 0.5) << slope;
        EXPECT_LT(std::sqrt(sum / n), 0.2) << slope;
    }
}

TEST(Outline, CornersOfABoxAreKept) {
    const auto inside = [](double x, double y) { return x > 10 && x < 40 && y > 20 && y < 50; };
    const Outline outline = outline_of(coverage_of(tests::picture(64, 64, 1, inside)));
    EXPECT_NEAR(moments(outline).area, 900.0, 1.0);
    const LevelSet<2> u = signed_distance(outline, DyadicGrid<2>(6), {1.0 / 64, {0, 0}});
    for (int j = 0; j <= 64; ++j) {
        for (int i = 0; i <= 64; ++i) {
            const double dx = std::max(10.0 - i, i - 40.0), dy = std::max(20.0 - j, j - 50.0);
            const double exact =
                dx <= 0 && dy <= 0 ? -std::max(dx, dy) : -std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
            EXPECT_NEAR(64 * u.values[u.grid.index({i, j})], exact, 0.5);
        }
    }
}

TEST(Outline, HolesTurnClockwiseAndDiagonalNeighboursAreJoined) {
    const auto ring = [](double x, double y) { return std::abs(std::hypot(x - 20, y - 20) - 10) < 4; };
    const Outline outline = outline_of(coverage_of(tests::picture(40, 40, 1, ring)));
    ASSERT_EQ(outline.loops.size(), 2U);
    EXPECT_GT(signed_area(outline.loops[0]), 0.0);
    EXPECT_LT(signed_area(outline.loops[1]), 0.0);
    // A line one pixel wide along the diagonal stays one part.
    const auto line = [](double x, double y) { return std::floor(x) == std::floor(y) && x > 5 && x < 35; };
    EXPECT_EQ(outline_of(coverage_of(tests::picture(40, 40, 1, line))).loops.size(), 1U);
}

TEST(Outline, DistanceEqualsTheDistanceToEverySegment) {
    const auto star = [](double x, double y) {
        const double angle = std::atan2(y - 32, x - 32);
        return std::hypot(x - 32, y - 32) < 18 + 8 * std::cos(5 * angle);
    };
    const Outline outline = outline_of(coverage_of(tests::picture(64, 64, 8, star)));
    const LevelSet<2> u = signed_distance(outline, DyadicGrid<2>(5), {1.0 / 64, {0, 0}});
    for (std::size_t n = 0; n < u.values.size(); ++n) {
        const Point<2> p = u.grid.position(u.grid.node(n));
        double nearest = 1e9;
        for (const Loop& loop : outline.loops) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const double ax = loop[i][0] / 64, ay = loop[i][1] / 64;
                const double bx = loop[(i + 1) % loop.size()][0] / 64, by = loop[(i + 1) % loop.size()][1] / 64;
                const double length2 = (bx - ax) * (bx - ax) + (by - ay) * (by - ay);
                const double t = std::clamp(((p[0] - ax) * (bx - ax) + (p[1] - ay) * (by - ay)) / length2, 0.0, 1.0);
                nearest = std::min(nearest, std::hypot(p[0] - ax - t * (bx - ax), p[1] - ay - t * (by - ay)));
            }
        }
        EXPECT_NEAR(std::abs(u.values[n]), nearest, 1e-12);
        if (nearest > 0.02) {
            EXPECT_EQ(u.values[n] > 0, star(64 * p[0], 64 * p[1]));
        }
    }
}

TEST(Outline, SpecksAndPinholesBelowTheShareGo) {
    Outline outline;
    const auto square = [](double x, double y, double side, bool hole) {
        Loop loop = {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
        if (hole) std::reverse(loop.begin(), loop.end());
        return loop;
    };
    outline.loops = {square(0, 0, 100, false), square(10, 10, 2, true), square(30, 30, 20, true),
                     square(200, 0, 3, false)};
    const SpeckRemoval removal = remove_specks(outline, 0.002);
    EXPECT_EQ(removal.specks, 1);
    EXPECT_EQ(removal.pinholes, 1);
    EXPECT_DOUBLE_EQ(removal.removed_area, 13.0);
    EXPECT_DOUBLE_EQ(moments(outline).area, 9600.0);
    EXPECT_EQ(remove_specks(outline, 0.0).specks, 0);
}

}  // namespace
}  // namespace morphodesic::datasets
