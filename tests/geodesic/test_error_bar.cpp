#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "geodesic/error_bar.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

/// A result between two equal disks whose lengths on the way are made up: with the wide rim one level before the last,
/// on it, and at the end.
GeodesicResult<2> result_with_lengths(double before, double wide, double length) {
    GeodesicResult<2> r;
    r.options.level = 5;
    r.options.time_steps = 4;
    r.options.rim_width = 0.5;
    r.options.tolerance = 1e-3;
    r.path_length = length;
    r.path_energy = length * length;
    r.mismatch_energy.assign(4, 0.0);
    r.shapes = {tests::ball<2>(5, 0.2), tests::ball<2>(5, 0.2)};
    for (const auto& [level, rim, l] : {std::tuple(4, 1.0, before), {5, 1.0, wide}, {5, 0.5, length}}) {
        LevelReport report;
        report.level = level;
        report.time_steps = 4;
        report.rim_width = rim;
        report.path_length = l;
        r.levels.push_back(report);
    }
    return r;
}

TEST(ErrorBar, ExtrapolatesWhatIsFirstOrderInTheRim) {
    // l = 1 - eps with eps = 1/16, 1/32, 1/64: the halving of the grid says what the rim says.
    auto r = result_with_lengths(1 - 1.0 / 16, 1 - 1.0 / 32, 1 - 1.0 / 64);
    add_error_bar(r, 1 - 1.0 / 32, 1.0, false);
    EXPECT_NEAR(r.extrapolated_length, 1.0, 1e-12);
    EXPECT_NEAR(r.error, 1.75 / 64 + 1e-3 * r.path_length, 1e-12);
}

TEST(ErrorBar, AddsWhatOnlyTheGridChanges) {
    // The rim says that nothing is left, the last halving of the grid changed the length by a tenth.
    auto r = result_with_lengths(0.9, 1.0, 1.0);
    add_error_bar(r, 1.0, 1.0, false);
    EXPECT_NEAR(r.error, 0.1 + 1e-3, 1e-12);
    r = result_with_lengths(1.1, 1.0, 1.0);
    add_error_bar(r, 1.0, 1.0, false);
    EXPECT_NEAR(r.error, 0.1 + 1e-3, 1e-12);
    // Solves with other time steps or rims say nothing about the grid.
    r = result_with_lengths(0.9, 1.0, 1.0);
    r.levels[0].time_steps = 2;
    add_error_bar(r, 1.0, 1.0, false);
    EXPECT_NEAR(r.error, 0.1 + 1e-3, 1e-12) << "what is left of the time steps";
    r = result_with_lengths(0.9, 1.0, 1.0);
    r.levels[0].rim_width = 0.8;
    add_error_bar(r, 1.0, 1.0, false);
    EXPECT_NEAR(r.error, 1e-3, 1e-12);
    r = result_with_lengths(std::numeric_limits<double>::infinity(), 1.0, 1.0);
    add_error_bar(r, 1.0, 1.0, false);
    EXPECT_NEAR(r.error, 1e-3, 1e-12);
}

TEST(ErrorBar, ExtrapolatesSquaresWhereTheTailsAreMovedAlong) {
    // l^2 = 2 eps / h, as of a shape that moves with nothing but its tails.
    auto r = result_with_lengths(2.0, std::sqrt(2.0), 1.0);
    add_error_bar(r, std::sqrt(2.0), 1.0, false);
    EXPECT_NEAR(r.extrapolated_length, 0.0, 1e-7);
    EXPECT_NEAR(r.error, 1.75 + 1e-3, 1e-7);
}

TEST(ErrorBar, LeavesAPartToTheMismatchOfOneStepOrOfShapesOfOtherSizes) {
    auto r = result_with_lengths(1.0, 1.0, 1.0);
    r.options.time_steps = 1;
    for (auto& level : r.levels) level.time_steps = 1;
    r.mismatch_energy.assign(1, 0.01);  // times eta = 25: E = l^2 + 0.25
    add_error_bar(r, 1.0, 1.0, false);
    EXPECT_NEAR(r.error, 0.25 + 1e-3, 1e-12);
    r = result_with_lengths(1.0, 1.0, 1.0);
    r.mismatch_energy.assign(4, 0.01);  // E = l^2 + 4
    add_error_bar(r, 1.0, 1.0, false);
    EXPECT_NEAR(r.error, 1e-3, 1e-12) << "equal sizes";
    r.shapes[1] = tests::ball<2>(5, 0.2 / std::sqrt(2.0));
    add_error_bar(r, 1.0, 1.0, false);
    EXPECT_NEAR(r.error, 0.5 * 4.0 + 1e-3, 0.02);
    add_error_bar(r, 1.0, 1.0, true);
    EXPECT_NEAR(r.error, 1e-3, 1e-12) << "sizes of what is hidden are not known";
}

/// Of a dot that grows much, long steps strew more dots over the background, where they cost nothing, and these grow.
TEST(ErrorBar, HoldsForADotThatGrowsTwelvefold) {
    GeodesicOptions options;
    options.starts = 1;
    const double exact = std::sqrt(8 * std::numbers::pi) * (0.35 - 0.03);
    for (const auto& [level, steps] : {std::pair(5, 2), {6, 2}, {6, 4}}) {
        options.level = level;
        options.time_steps = steps;
        const auto path =
            compute_discrete_geodesic<2>(tests::ball<2>(level + 1, 0.03), tests::ball<2>(level + 1, 0.35), options);
        EXPECT_LT(path.path_length, 0.6 * exact) << "no case of what is tested";
        EXPECT_LE(exact - path.path_length, path.error) << "level " << level << ", " << steps << " steps";
    }
}

/// A disk with teeth.
LevelSet<2> gear(int level, int teeth, double height) {
    LevelSet<2> u{DyadicGrid<2>(level)};
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const auto x = u.grid.position(u.grid.node(i));
        const double dx = x[0] - 0.5, dy = x[1] - 0.5;
        u.values[i] = 0.25 + height * std::cos(teeth * std::atan2(dy, dx)) - std::hypot(dx, dy);
    }
    return u;
}

/// Teeth that are narrower than a cell look the same with either rim; only finer grids tell how far they are apart.
TEST(ErrorBar, HoldsForTeethThatTheGridHardlySees) {
    GeodesicOptions options;
    options.time_steps = 4;
    options.align = "none";
    options.tolerance = 1e-3;
    for (const auto& [teeth, others, height] : {std::tuple(30, 23, 0.008), {36, 23, 0.012}}) {
        const LevelSet<2> a = gear(7, teeth, height), b = gear(7, others, height);
        const auto solved = [&](int level) {
            options.level = level;
            return compute_discrete_geodesic<2>(a, b, options);
        };
        const auto coarse = solved(5), fine = solved(7);
        EXPECT_GT(fine.path_length, 1.5 * coarse.path_length) << "no case of what is tested";
        EXPECT_LE(fine.path_length - coarse.path_length, coarse.error) << teeth;
    }
}

}  // namespace
}  // namespace morphodesic
