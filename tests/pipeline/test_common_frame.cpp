#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/synthetic.h"
#include "pipeline/common_frame.h"
#include "pipeline/solid_paths.h"

namespace morphodesic::pipeline {
namespace {

using datasets::Rotation;
using datasets::unturned;

Rotation about_z(double degrees) {
    const double c = std::cos(degrees * std::numbers::pi / 180.0), s = std::sin(degrees * std::numbers::pi / 180.0);
    return {c, -s, 0, s, c, 0, 0, 0, 1};
}
constexpr Rotation y_up{1, 0, 0, 0, 0, -1, 0, 1, 0};  // from a file with y up to one with z up
constexpr Rotation z_up{1, 0, 0, 0, 0, 1, 0, -1, 0};  // and back

void expect_near(const Rotation& a, const Rotation& b) {
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(a[i], b[i], 1e-9) << i;
}

TEST(CommonFrame, FilesOfOtherAxesAreTurnedIntoThatOfTheMost) {
    // 0, 1 and 4 have z up, 2 and 3 have y up; the pair (0, 3) was aligned upside down.
    const Rotation wrong{-1, 0, 0, 0, -1, 0, 0, 0, 1};
    const auto [turns, groups] = common_frames(std::vector<std::string>(5), {{0, 1, 1.0, about_z(12)},
                                                                             {2, 0, 1.5, y_up},
                                                                             {1, 2, 1.6, z_up},
                                                                             {2, 3, 1.2, unturned},
                                                                             {0, 3, 1.7, wrong},
                                                                             {3, 1, 1.8, y_up},
                                                                             {4, 0, 2.0, unturned},
                                                                             {4, 3, 2.1, z_up}});
    ASSERT_EQ(turns.size(), 5u);
    EXPECT_EQ(groups, std::vector<std::size_t>(5, 0));
    for (const std::size_t i : {0u, 1u, 4u}) EXPECT_EQ(turns[i], unturned) << i;
    for (const std::size_t i : {2u, 3u}) EXPECT_LT(turn_angle(turns[i]), 100) << i;
    for (const std::size_t i : {2u, 3u}) EXPECT_GT(turns[i][7], 0.9) << i;  // their y is up now
}

TEST(CommonFrame, WhereThePairsDoNotAgreeFilesStayAsTheyAre) {
    const auto [turns, groups] = common_frames(std::vector<std::string>(4), {{0, 1, 1.0, unturned},
                                                                             {2, 3, 1.0, unturned},
                                                                             {0, 2, 5.0, y_up},
                                                                             {0, 3, 5.1, about_z(90)},
                                                                             {1, 2, 5.2, about_z(180)},
                                                                             {1, 3, 5.3, z_up}});
    for (const Rotation& turn : turns) EXPECT_EQ(turn, unturned);
    EXPECT_EQ(groups, (std::vector<std::size_t>{0, 0, 1, 1}));
}

TEST(CommonFrame, ClassesAreNotTurnedToEachOther) {
    const std::vector<PairTurn> pairs{{0, 1, 1.0, y_up}, {2, 3, 1.0, unturned}, {1, 2, 2.0, y_up}, {1, 3, 2.0, y_up}};
    const auto apart = common_frames({"fish", "fish", "bear", "bear"}, pairs);
    expect_near(apart.turns[1], z_up);
    EXPECT_EQ(apart.groups, (std::vector<std::size_t>{0, 0, 1, 1}));
    EXPECT_EQ(apart.turns[2], unturned);
    const auto together = common_frames({"fish", "", "bear", "bear"}, pairs);
    EXPECT_EQ(together.groups, std::vector<std::size_t>(4, 0));
}

TEST(CommonFrame, TurnedSolidsHaveThePictureOfTheSolidThatLiesSo) {
    const DyadicGrid<3> grid(5);
    LevelSet<3> standing(grid), lying(grid);  // a box, and the same one with y instead of z up
    for (std::size_t i = 0; i < standing.values.size(); ++i) {
        const auto x = grid.position(grid.node(i));
        const auto box = [](double a, double b, double c) {
            return std::min({0.1 - std::abs(a - 0.04), 0.2 - std::abs(b), 0.3 - std::abs(c - 0.03)});
        };
        standing.values[i] = box(x[0] - 0.5, x[1] - 0.5, x[2] - 0.5);
        lying.values[i] = box(x[0] - 0.5, -(x[2] - 0.5), x[1] - 0.5);
    }
    StudyView view;
    view.turns = {unturned, y_up};
    const RgbaImage upright = shape_picture(standing, 64, view.of(0)), turned = shape_picture(lying, 64, view.of(1));
    const RgbaImage unlike = shape_picture(lying, 64, view.of(0));
    long different = 0, different_unturned = 0;
    for (std::size_t i = 3; i < upright.pixels.size(); i += 4) {
        different += std::abs(upright.pixels[i] - turned.pixels[i]) > 128 ? 1 : 0;
        different_unturned += std::abs(upright.pixels[i] - unlike.pixels[i]) > 128 ? 1 : 0;
    }
    EXPECT_LE(different, 4);
    EXPECT_GT(different_unturned, 400);
    const auto slice = datasets::slice_picture(standing, 0, 0.55, 64, nullptr, {}, 2);
    const auto same = datasets::slice_picture(lying, 0, 0.55, 64, nullptr, {}, 2, 0.5, y_up);
    long slices_differ = 0;
    for (std::size_t i = 0; i < slice.values.size(); ++i) {
        slices_differ += std::abs(static_cast<int>(slice.values[i]) - static_cast<int>(same.values[i])) > 40 ? 1 : 0;
    }
    EXPECT_LE(slices_differ, 12);
    EXPECT_NE(key_of(view.of(0)), key_of(view.of(1)));
}

}  // namespace
}  // namespace morphodesic::pipeline
