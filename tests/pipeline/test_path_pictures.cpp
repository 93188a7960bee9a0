#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/synthetic.h"
#include "pipeline/colour_map.h"
#include "pipeline/path_pictures.h"

namespace morphodesic::pipeline {
namespace {

double covered(const RgbaImage& image) {
    double sum = 0.0;
    for (std::size_t i = 3; i < image.pixels.size(); i += 4) sum += image.pixels[i] / 255.0;
    return sum;
}

TEST(ShapePicture, CoversTheAreaOfTheShape) {
    const auto disk = datasets::ball<2>(DyadicGrid<2>(6), {0.5, 0.5}, 0.25);
    const int pixels = 128;
    const double pixel = 2 * picture_radius / pixels;
    EXPECT_NEAR(covered(shape_picture(disk, pixels)) * pixel * pixel, std::numbers::pi * 0.0625, 5e-4);
}

TEST(ShapePicture, IsTheRightWayUp) {
    const auto disk = datasets::ball<2>(DyadicGrid<2>(6), {0.65, 0.7}, 0.1);  // right of and above the centre
    const RgbaImage image = shape_picture(disk, 64);
    const auto alpha = [&](int column, int row) {
        return image.pixels[4 * (static_cast<std::size_t>(row) * 64 + static_cast<std::size_t>(column)) + 3];
    };
    EXPECT_EQ(alpha(44, 16), 255);
    EXPECT_EQ(alpha(44, 48), 0);
    EXPECT_EQ(alpha(20, 16), 0);
}

TEST(ShapePicture, ASolidIsSeenAsItsShadow) {
    const auto ball = datasets::ball<3>(DyadicGrid<3>(5), {0.5, 0.5, 0.5}, 0.3);
    const int pixels = 64;
    const double pixel = 2 * datasets::view_radius({}) / pixels;
    EXPECT_NEAR(covered(shape_picture(ball, pixels)) * pixel * pixel, std::numbers::pi * 0.09, 0.01);
}

/// How far the covered pixels reach from the middle of a square picture, as a share of its half width.
double reach_in(const RgbaImage& image) {
    double reach = 0.0;
    for (int row = 0; row < image.width; ++row) {
        for (int column = 0; column < image.width; ++column) {
            const auto at = 4 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                 static_cast<std::size_t>(column));
            if (image.pixels[at + 3] < 128) continue;
            for (const int k : {row, column}) reach = std::max(reach, std::abs(2 * (k + 0.5) / image.width - 1));
        }
    }
    return reach;
}

TEST(NearView, SmallShapesFillTheirPictures) {
    for (const double radius : {0.08, 0.2}) {
        const auto disk = datasets::ball<2>(DyadicGrid<2>(7), {0.5, 0.5}, radius);
        EXPECT_NEAR(picture_reach<2>(disk), radius, 0.01);
        EXPECT_NEAR(reach_in(shape_picture(disk, 96, near_view<2>({}, picture_reach<2>(disk)))), 0.87, 0.06) << radius;
        const auto ball = datasets::ball<3>(DyadicGrid<3>(5), {0.5, 0.5, 0.5}, radius);
        EXPECT_NEAR(reach_in(shape_picture(ball, 96, near_view<3>({}, picture_reach<3>(ball)))), 0.87,
                    0.3 * 0.08 / radius)
            << radius;
    }
    EXPECT_EQ(near_view<2>({}, 0.5).camera.zoom, 1.0);  // never from farther away
    EXPECT_LT(near_view<2>({}, 0.0).camera.zoom, 20.0);
}

/// phi - id = m (x - c) in the middle of the cube (the boundary does not matter here).
template <int Dim>
Deformation<Dim> linear(const double (&m)[Dim][Dim]) {
    Deformation<Dim> phi{DyadicGrid<Dim>(4)};
    for (std::size_t i = 0; i < phi.grid().node_count(); ++i) {
        const auto x = phi.grid().position(phi.grid().node(i));
        for (int a = 0; a < Dim; ++a) {
            for (int b = 0; b < Dim; ++b)
                phi.displacement.components[static_cast<std::size_t>(a)][i] +=
                    m[a][b] * (x[static_cast<std::size_t>(b)] - 0.5);
        }
    }
    return phi;
}

TEST(DissipationRate, IsExactForLinearMotions) {
    const double tau = 0.25, lambda = 3, mu = 1;
    const auto stretch = dissipation_rate<2>(linear<2>({{0.02, 0}, {0, 0.01}}), tau, lambda, mu);
    const double a = 0.02 / tau, b = 0.01 / tau;
    for (const double rate : stretch.values)
        ASSERT_NEAR(rate, 0.5 * lambda * (a + b) * (a + b) + mu * (a * a + b * b), 1e-12);
    const auto turn = dissipation_rate<2>(linear<2>({{0, -0.02}, {0.02, 0}}), tau, lambda, mu);
    for (const double rate : turn.values) ASSERT_NEAR(rate, 0.0, 1e-14);
    const auto shear = dissipation_rate<3>(linear<3>({{0, 0, 0.04}, {0, 0, 0}, {0, 0, 0}}), tau, lambda, mu);
    for (const double rate : shear.values) ASSERT_NEAR(rate, mu * 2 * 0.08 * 0.08, 1e-12);
}

TEST(DissipationColours, GrowLighterFromBlueToOrange) {
    const auto linear = [](unsigned char c) {
        return c <= 10 ? c / 255.0 / 12.92 : std::pow((c / 255.0 + 0.055) / 1.055, 2.4);
    };
    const auto luminance = [&](const Colour& c) {
        return 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
    };
    for (int i = 1; i <= 20; ++i) {
        EXPECT_GE(luminance(dissipation_colour(i / 20.0)), luminance(dissipation_colour((i - 1) / 20.0))) << i;
    }
    EXPECT_GT(dissipation_colour(0)[2], dissipation_colour(0)[0]);
    EXPECT_GT(dissipation_colour(1)[0], dissipation_colour(1)[2]);
    EXPECT_EQ(dissipation_colour(-5), dissipation_colour(0));
    EXPECT_EQ(dissipation_colour(std::nan("")), dissipation_colour(0));
    EXPECT_EQ(dissipation_colours(5).size(), 5u);
}

}  // namespace
}  // namespace morphodesic::pipeline
