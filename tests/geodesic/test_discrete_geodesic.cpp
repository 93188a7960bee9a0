#include <gtest/gtest.h>

#include <limits>

#include "geodesic/discrete_geodesic.h"
#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/volume_constraint.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/mismatch_by_points.h"
#include "tests/support/path_problems.h"
#include "tests/support/thread_counts.h"

namespace morphodesic {
namespace {

GeodesicOptions options_for(int level, int steps) {
    GeodesicOptions o;
    o.level = level;
    o.time_steps = steps;
    o.align = "none";
    o.starts = 1;
    o.tolerance = 1e-3;
    return o;
}

/// sqrt(pi (2 lambda + 2 mu)) |r1 - r0| (method of the closed form: v = (r'/r) x).
double disk_length(double r0, double r1) {
    return std::sqrt(std::numbers::pi * 8.0) * std::abs(r1 - r0);
}
/// sqrt(pi (6 lambda + 4 mu)) 2/3 |r1^(3/2) - r0^(3/2)|
double ball_length(double r0, double r1) {
    return std::sqrt(std::numbers::pi * 22.0) * 2.0 / 3.0 * std::abs(std::pow(r1, 1.5) - std::pow(r0, 1.5));
}

/// Bars of these disks and balls are 1.1 to 1.7 times the true errors, see docs/convergence.md.
constexpr double most_of_bar = 2.5;

TEST(DiscreteGeodesic, DisksConvergeToTheClosedFormWithFirstOrder) {
    const double exact = disk_length(0.2, 0.25);
    std::vector<double> errors;
    for (const int level : {5, 6, 7}) {
        const auto r = compute_discrete_geodesic<2>(tests::ball<2>(level, 0.2), tests::ball<2>(level, 0.25),
                                                    options_for(level, 4));
        ASSERT_EQ(r.termination, Termination::converged);
        errors.push_back(std::abs(r.path_length - exact));
        EXPECT_LE(std::abs(r.path_length - exact), r.error) << "the true error lies within the bar, level " << level;
        EXPECT_LE(r.error, most_of_bar * std::abs(r.path_length - exact)) << "a bar that says little, level " << level;
        EXPECT_GT(r.min_det, 0.5);
        if (level == 7) {
            EXPECT_LT(errors.back(), 0.03 * exact);
            EXPECT_LT(std::abs(r.extrapolated_length - exact), 0.01 * exact);
        }
    }
    EXPECT_GT(std::log2(errors[0] / errors[2]) / 2.0, 0.7) << "observed order";
}

TEST(DiscreteGeodesic, BallsConvergeToTheClosedForm) {
    const double exact = ball_length(0.2, 0.25);
    std::vector<double> errors;
    for (const int level : {4, 5}) {
        const auto r = compute_discrete_geodesic<3>(tests::ball<3>(level, 0.2), tests::ball<3>(level, 0.25),
                                                    options_for(level, 2));
        ASSERT_EQ(r.termination, Termination::converged);
        errors.push_back(std::abs(r.path_length - exact));
        EXPECT_LE(errors.back(), r.error) << level;
        EXPECT_LE(r.error, most_of_bar * errors.back()) << level;
    }
    EXPECT_LT(errors[1], 0.25 * exact);
    EXPECT_LT(errors[1], 0.75 * errors[0]);
}

TEST(DiscreteGeodesic, BarsHoldForFewStepsBetweenSizesThatDifferMuch) {
    for (const auto& [r0, r1] : {std::pair(0.2, 0.25), {0.15, 0.3}, {0.1, 0.2}, {0.1, 0.3}}) {
        for (const int steps : {1, 2, 4}) {
            for (const bool grows : {true, false}) {
                const auto r = compute_discrete_geodesic<2>(tests::ball<2>(6, grows ? r0 : r1),
                                                            tests::ball<2>(6, grows ? r1 : r0), options_for(6, steps));
                ASSERT_EQ(r.termination, Termination::converged);
                EXPECT_LE(std::abs(r.path_length - disk_length(r0, r1)), r.error) << r0 << " " << r1 << " K " << steps;
                EXPECT_LT(r.error, (steps == 1 ? 1.35 : 0.65) * r.path_length) << "a bar that says nothing";
            }
        }
    }
    // A dot that grows and one that is left: part of the way a few cells wide.
    for (const auto& [r0, r1, steps] : {std::tuple(0.05, 0.3, 4),
                                        {0.04, 0.3, 8},
                                        {0.04, 0.35, 8},
                                        {0.03, 0.35, 16},
                                        {0.3, 0.04, 4},
                                        {0.35, 0.03, 16}}) {
        const auto r =
            compute_discrete_geodesic<2>(tests::ball<2>(6, r0), tests::ball<2>(6, r1), options_for(6, steps));
        ASSERT_EQ(r.termination, Termination::converged);
        EXPECT_LE(std::abs(r.path_length - disk_length(r0, r1)), r.error) << r0 << " " << r1 << " K " << steps;
    }
    // Where the mismatch is soft, most of the way is left to it.
    for (const auto& [r0, r1, weight] : {std::tuple(0.3, 0.1, 5.0), {0.2, 0.25, 1.0}}) {
        auto options = options_for(6, 8);
        options.mismatch_weight_per_step = weight;
        const auto r = compute_discrete_geodesic<2>(tests::ball<2>(6, r0), tests::ball<2>(6, r1), options);
        EXPECT_LE(std::abs(r.path_length - disk_length(r0, r1)), r.error) << r0 << " " << r1 << " eta / K " << weight;
    }
    // The area term is no part of the way.
    auto options = options_for(6, 1);
    const double bar = compute_discrete_geodesic<2>(tests::ball<2>(6, 0.2), tests::ball<2>(6, 0.25), options).error;
    options.area_weight = 0.05;
    EXPECT_LT(compute_discrete_geodesic<2>(tests::ball<2>(6, 0.2), tests::ball<2>(6, 0.25), options).error, 1.2 * bar);
    for (const int steps : {1, 2}) {
        const auto r =
            compute_discrete_geodesic<3>(tests::ball<3>(5, 0.12), tests::ball<3>(5, 0.24), options_for(5, steps));
        ASSERT_EQ(r.termination, Termination::converged);
        EXPECT_LE(std::abs(r.path_length - ball_length(0.12, 0.24)), r.error) << steps;
    }
}

/// The mismatch energy (12) of a path, eta included, by many points in each cell.
double mismatch_by_many_points(const GeodesicResult<2>& path) {
    const auto& grid = path.shapes[0].grid;
    const auto points = tests::midpoints<2>(12);
    double sum = 0.0;
    for (std::size_t k = 0; k < path.deformations.size(); ++k) {
        const auto& w = path.deformations[k].displacement.components;
        q1::for_each_cell(grid, [&](std::size_t node) {
            sum += tests::mismatch_by_points<2>(grid, node, points, {w[0].data(), w[1].data()},
                                                path.shapes[k].values.data(), path.shapes[k + 1].values.data(),
                                                path.options.rim_width * grid.spacing());
        });
    }
    return path.options.eta(path.options.time_steps) * sum;
}

/// Where a shape has to come from next to nothing, a minimiser would rather hide what it adds between the points at
/// which the energy is taken: it stretched cells of the background ten times, so that half of the mismatch was not
/// seen.
TEST(DiscreteGeodesic, NoMismatchIsHiddenInStretchedCells) {
    for (const auto& [r0, r1, steps] : {std::tuple(0.03, 0.35, 4), {0.04, 0.35, 8}}) {
        const auto r =
            compute_discrete_geodesic<2>(tests::ball<2>(6, r0), tests::ball<2>(6, r1), options_for(6, steps));
        double reported = 0.0;
        for (const double mismatch : r.mismatch_energy) reported += mismatch;
        reported *= r.options.eta(steps);
        EXPECT_GT(reported, 0.2) << "no case of what is tested";
        EXPECT_NEAR(reported, mismatch_by_many_points(r), 0.02 * reported) << r0;
    }
}

/// A bar of length 0.6, bent to an arc.
LevelSet<2> bent_bar(int level, double half_width, double curvature) {
    LevelSet<2> u{DyadicGrid<2>(level)};
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const auto x = u.grid.position(u.grid.node(i));
        const double from_middle = x[0] - 0.5, up = x[1] - 0.5 + 1.0 / curvature;  // seen from the middle of the arc
        const double along = std::abs(std::atan2(from_middle, up) / curvature) - 0.3;
        const double across = std::abs(std::hypot(from_middle, up) - 1.0 / curvature) - half_width;
        u.values[i] =
            -(std::hypot(std::max(along, 0.0), std::max(across, 0.0)) + std::min(std::max(along, across), 0.0));
    }
    return u;
}

/// Bending a thin shape costs little, the tails of the diffuse contour that move along a lot: lengths fall by a quarter
/// from level to level.
TEST(DiscreteGeodesic, BarsAllowForTheTailsOfThinShapesThatBend) {
    const auto solved = [](int level, double tolerance) {
        auto options = options_for(level, 4);
        options.tolerance = tolerance;
        options.align = "rigid";
        options.starts = 4;
        return compute_discrete_geodesic<2>(bent_bar(7, 0.04, 0.5), bent_bar(7, 0.04, 2.5), options);
    };
    const double best = solved(7, 1e-3).extrapolated_length;
    const auto r = solved(6, 1e-2);
    EXPECT_GT(r.path_length, 1.3 * best);
    EXPECT_LE(std::abs(r.path_length - best), r.error);
    EXPECT_LT(std::abs(r.extrapolated_length - best), 0.5 * std::abs(r.path_length - best));
}

/// A cross becomes an L: strokes vanish, and the path is stuck in cracks with the narrow rim.
TEST(DiscreteGeodesic, RoundsLowerTheEnergyWhereThePathDoesNotSettleSoon) {
    const auto bar = [](const Point<2>& half, const Point<2>& middle) {
        return tests::turned_box<2>(6, half, middle, 0.0);
    };
    const auto cross = tests::united(bar({0.3, 0.05}, {0.5, 0.5}), bar({0.05, 0.3}, {0.5, 0.5}));
    const auto ell = tests::united(bar({0.05, 0.3}, {0.3, 0.5}), bar({0.2, 0.05}, {0.5, 0.25}));
    auto options = options_for(6, 8);
    options.align = "rigid";
    options.tolerance = 1e-4;
    const auto solved = [&](const LevelSet<2>& a, const LevelSet<2>& b, int rounds) {
        options.rounds = rounds;
        return compute_discrete_geodesic<2>(a, b, options);
    };
    const auto none = solved(cross, ell, 0), one = solved(cross, ell, 1);
    EXPECT_LT(one.total_energy, 0.999 * none.total_energy);
    ASSERT_EQ(one.levels.size(), none.levels.size() + 2);  // given up, with a wider rim, with the one that is wanted
    EXPECT_EQ(one.levels[none.levels.size() - 1].termination, Termination::max_steps);
    EXPECT_LT(one.levels[none.levels.size() - 1].iterations, none.levels.back().iterations);
    EXPECT_GT(one.levels[none.levels.size()].rim_width, 2 * one.options.rim_width);
    EXPECT_EQ(one.levels.back().rim_width, one.options.rim_width);
    EXPECT_EQ(one.termination, Termination::converged);
    EXPECT_GT(one.error, 0.0);
    const auto two = solved(cross, ell, 2);  // the second begins where the first takes long, too
    EXPECT_EQ(two.levels.size(), one.levels.size() + 2);
    EXPECT_LE(two.total_energy, one.total_energy);
    EXPECT_EQ(two.termination, Termination::converged);

    const auto same = solved(ell, ell, 1);
    EXPECT_EQ(same.path_length, 0.0);
    EXPECT_EQ(same.termination, Termination::converged);
    // Nothing sticks where disks grow: the path settles soon, and no round is spent on it.
    const auto small = tests::ball<2>(6, 0.2), large = tests::ball<2>(6, 0.25);
    EXPECT_EQ(solved(small, large, 2).levels.size(), solved(small, large, 0).levels.size());
}

template <int Dim>
std::pair<LevelSet<Dim>, LevelSet<Dim>> two_boxes(int level) {
    Point<Dim> wide, tall, centre;
    wide.fill(0.1);
    tall.fill(0.1);
    wide[0] = 0.2;
    tall[1] = 0.16;
    centre.fill(0.5);
    return {tests::turned_box<Dim>(level, wide, centre, 0.0), tests::turned_box<Dim>(level, tall, centre, 0.3)};
}

template <class T>
class DiscreteGeodesicIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(DiscreteGeodesicIn, Dimensions);

TYPED_TEST(DiscreteGeodesicIn, ResultIsConsistentAndOneToOne) {
    constexpr int dim = TypeParam::value;
    const int level = dim == 2 ? 5 : 4;
    const auto [a, b] = two_boxes<dim>(level);
    auto options = options_for(level, 4);
    options.align = "rigid";
    options.starts = 2;
    const auto r = compute_discrete_geodesic<dim>(a, b, options);
    EXPECT_EQ(r.termination, Termination::converged);
    EXPECT_EQ(r.shapes.size(), 5U);
    EXPECT_EQ(r.deformations.size(), 4U);
    double length = 0.0, energy = 0.0;
    for (const double e : r.deformation_energy) {
        length += std::sqrt(e);
        energy += 4 * e;
    }
    EXPECT_DOUBLE_EQ(r.path_length, length);
    EXPECT_DOUBLE_EQ(r.path_energy, energy);
    EXPECT_LE(r.path_length * r.path_length, r.path_energy * (1 + 1e-12));
    double least = std::numeric_limits<double>::infinity();
    for (const auto& phi : r.deformations) {
        DisplacementView<dim> view;
        for (std::size_t axis = 0; axis < dim; ++axis) view[axis] = phi.displacement.components[axis].data();
        least = std::min(least, det_lower_bound<dim>(r.shapes.front().grid, view));
    }
    EXPECT_DOUBLE_EQ(r.min_det, least) << "the certificate is that of the deformations in the result";
    EXPECT_GT(r.min_det, 0.0);
    EXPECT_GT(r.error, 0.0);
    EXPECT_EQ(r.shapes.back().values, moved(b, r.frame, level).values);
    EXPECT_EQ(r.levels.back().level, level);
}

TYPED_TEST(DiscreteGeodesicIn, BitsDoNotDependOnThreads) {
    constexpr int dim = TypeParam::value;
    const int level = dim == 2 ? 6 : 4;
    const auto boxes = two_boxes<dim>(level);
    auto options = options_for(level, 2);
    options.align = "rigid";
    const auto [one, eight] = tests::on_one_and_eight_threads(
        [&] { return compute_discrete_geodesic<dim>(boxes.first, boxes.second, options); });
    EXPECT_EQ(one.path_length, eight.path_length);
    EXPECT_EQ(one.total_energy, eight.total_energy);
    EXPECT_EQ(one.error, eight.error);
    for (std::size_t k = 0; k < one.deformations.size(); ++k) {
        EXPECT_EQ(one.deformations[k].displacement.components, eight.deformations[k].displacement.components);
        EXPECT_EQ(one.shapes[k].values, eight.shapes[k].values);
    }
}

TYPED_TEST(DiscreteGeodesicIn, IsTheSameOnEveryInstructionSet) {
    // Bits differ with the number of lanes, and with them where the minimiser stops.
    constexpr int dim = TypeParam::value, level = dim == 2 ? 5 : 4;
    const auto box = two_boxes<dim>(level).first;
    const auto ball = tests::ball<dim>(level, 0.22);
    auto options = options_for(level, 2);
    options.align = "rigid";
    options.tolerance = 1e-5;
    const auto best = compute_discrete_geodesic<dim>(box, ball, options);
    ASSERT_EQ(best.termination, Termination::converged);
    tests::for_each_instruction_set([&](const std::string& name) {
        const auto r = compute_discrete_geodesic<dim>(box, ball, options);
        EXPECT_EQ(r.termination, Termination::converged) << name;
        EXPECT_NEAR(r.total_energy, best.total_energy, 0.01 * best.total_energy) << name;
        EXPECT_NEAR(r.path_length, best.path_length, 0.01 * best.path_length) << name;
    });
}

TEST(DiscreteGeodesic, MovedCopyIsNear) {
    const auto [a, b] = two_boxes<2>(7);
    auto options = options_for(6, 2);
    options.align = "rigid";
    auto motion = turn_by(0.8);
    motion.translation = {0.02, -0.03};
    const double typical = compute_discrete_geodesic<2>(a, b, options).path_length;
    const auto copy = compute_discrete_geodesic<2>(moved(a, motion, 7), a, options);
    EXPECT_LT(copy.path_length, 0.02 * typical);
    const auto shifted = compute_discrete_geodesic<2>(moved(a, motion, 7), b, options);
    EXPECT_NEAR(shifted.path_length, typical, 0.01 * typical);
    // The second shape is brought to a pose of its own, so the grid does not see how it was turned either.
    for (const double angle : {0.3, 0.8, 1.9}) {
        motion.rotation = turn_by(angle).rotation;
        const double other = compute_discrete_geodesic<2>(a, moved(b, motion, 7), options).path_length;
        EXPECT_NEAR(other, typical, 0.002 * typical) << angle;
    }
}

TEST(DiscreteGeodesic, NoAlignmentCutsOffAPartOfAShape) {
    // A bar along the diagonal that is longer than the cube: turned to the other bar its ends would stick out.
    const auto a = tests::turned_box<2>(6, {0.6, 0.08}, {0.5, 0.5}, 0.25 * std::numbers::pi);
    const auto b = tests::turned_box<2>(6, {0.4, 0.08}, {0.5, 0.5}, 0.0);
    auto options = options_for(5, 2);
    options.align = "rigid";
    options.starts = 4;
    const auto r = compute_discrete_geodesic<2>(a, b, options);
    ASSERT_EQ(r.termination, Termination::converged) << r.message;
    const double whole = enclosed_volume(a.grid, a.values.data());
    EXPECT_NEAR(enclosed_volume(r.shapes.front().grid, r.shapes.front().values.data()), whole, 0.01 * whole);
}

TEST(DiscreteGeodesic, WhatIsVisibleIsAligned) {
    // A bar with a head, its right half hidden: what is left lies on the whole shape exactly.
    const auto bar = tests::turned_box<2>(6, {0.3, 0.06}, {0.5, 0.5}, 0.0);
    LevelSet<2> whole = tests::ball<2>(6, 0.13, {0.25, 0.5}), part = whole;
    ScalarField<2> mask(whole.grid, 1.0);
    for (std::size_t i = 0; i < whole.values.size(); ++i) {
        const double x = whole.grid.position(whole.grid.node(i))[0];
        whole.values[i] = std::max(whole.values[i], bar.values[i]);
        part.values[i] = std::min(whole.values[i], 0.5 - x);
        if (x > 0.5) mask.values[i] = 0.0;
    }
    std::vector<double> lengths;
    for (const char* align : {"none", "translation", "rigid"}) {
        auto options = options_for(6, 2);
        options.align = align;
        options.starts = 8;
        const auto r = compute_discrete_geodesic<2>(part, whole, options, mask);
        ASSERT_EQ(r.termination, Termination::converged) << r.message;
        EXPECT_LT(std::hypot(r.motion.translation[0], r.motion.translation[1]), 0.004) << align;
        EXPECT_GT(r.motion.rotation[0], std::cos(0.02)) << align;
        lengths.push_back(r.path_length);
    }
    EXPECT_LT(lengths[1], 1.05 * lengths[0]);
    EXPECT_LT(lengths[2], 1.05 * lengths[0]);
}

TEST(DiscreteGeodesic, AMaskThatReachesTheBorderIsMovedWithItsShape) {
    // The same content at several places: what is hidden goes on beyond the border.
    const auto bar = tests::turned_box<2>(6, {0.2, 0.06}, {0.5, 0.5}, 0.0);
    std::vector<double> lengths;
    for (const double shift : {0.0, 0.125, 0.25}) {
        const double cut = 0.5 + shift;
        const auto there = tests::turned_box<2>(6, {0.2, 0.07}, {cut, 0.5}, 0.0);
        LevelSet<2> part = there;
        ScalarField<2> mask(part.grid, 1.0);
        for (std::size_t i = 0; i < part.values.size(); ++i) {
            const double x = part.grid.position(part.grid.node(i))[0];
            part.values[i] = std::min(part.values[i], cut - x);
            if (x > cut) mask.values[i] = 0.0;
        }
        auto options = options_for(6, 2);
        options.align = "translation";
        options.starts = 8;
        const auto r = compute_discrete_geodesic<2>(part, bar, options, mask);
        ASSERT_EQ(r.termination, Termination::converged) << r.message;
        EXPECT_NEAR(r.motion.translation[0], -shift, 0.01);
        lengths.push_back(r.path_length);
    }
    EXPECT_NEAR(lengths[1], lengths[0], 0.05 * lengths[0]);
    EXPECT_NEAR(lengths[2], lengths[0], 0.05 * lengths[0]);
}

TEST(DiscreteGeodesic, AShapeThatNeedsTheWholeCubeIsNotTurned) {
    auto options = options_for(6, 2);
    options.align = "rigid";
    const auto diagonal = tests::turned_box<2>(6, {0.5, 0.06}, {0.5, 0.5}, std::numbers::pi / 4),
               shorter = tests::turned_box<2>(6, {0.3, 0.06}, {0.5, 0.5}, std::numbers::pi / 4);
    const auto turned = compute_discrete_geodesic<2>(diagonal, shorter, options);
    EXPECT_TRUE(turned.frame.is_identity());
    options.align = "translation";
    const auto as_it_stands = compute_discrete_geodesic<2>(diagonal, shorter, options);
    EXPECT_LT(turned.path_length, 1.03 * as_it_stands.path_length);
}

TEST(DiscreteGeodesic, LengthScalesWithTheRootOfTheStiffness) {
    auto options = options_for(4, 1);
    const auto a = tests::ball<2>(4, 0.2), b = tests::ball<2>(4, 0.25);
    const double length = compute_discrete_geodesic<2>(a, b, options).path_length;
    for (const double scale : {1e-9, 1e-6, 1e6}) {
        auto scaled = options;
        scaled.mu *= scale;
        scaled.lambda *= scale;
        scaled.mismatch_weight_per_step *= scale;
        const double found = compute_discrete_geodesic<2>(a, b, scaled).path_length;
        EXPECT_NEAR(found / std::sqrt(scale), length, 1e-3 * length) << scale;
    }
}

TEST(DiscreteGeodesic, LengthIsNearlySymmetric) {
    const auto [a, b] = two_boxes<2>(6);
    auto options = options_for(6, 4);
    options.align = "rigid";
    const double there = compute_discrete_geodesic<2>(a, b, options).path_length;
    const double back = compute_discrete_geodesic<2>(b, a, options).path_length;
    EXPECT_NEAR(there, back, 0.02 * there);
}

TEST(DiscreteGeodesic, SameShapeHasLengthZero) {
    const auto u = tests::ball<2>(5, 0.2);
    const auto r = compute_discrete_geodesic<2>(u, u, options_for(5, 2));
    EXPECT_EQ(r.termination, Termination::converged);
    EXPECT_LT(r.path_length, 1e-6);
    auto options = options_for(6, 4);
    options.align = "rigid";
    const auto bar = tests::turned_box<2>(6, {0.25, 0.06}, {0.5, 0.5}, 0.4);
    EXPECT_EQ(compute_discrete_geodesic<2>(bar, bar, options).path_length, 0.0);
}

TEST(DiscreteGeodesic, AreaIsKeptWhereThatIsAsked) {
    const auto [a, b] = two_boxes<2>(6);
    auto options = options_for(6, 4);
    options.area_weight = 0.005;
    options.preserve_volume = true;
    const auto r = compute_discrete_geodesic<2>(a, b, options);
    ASSERT_EQ(r.termination, Termination::converged);
    const double first = enclosed_volume(r.shapes.front().grid, r.shapes.front().values.data());
    const double last = enclosed_volume(r.shapes.back().grid, r.shapes.back().values.data());
    EXPECT_NEAR(first, 4 * 0.2 * 0.1, 5e-3 * first);
    for (std::size_t k = 0; k < r.shapes.size(); ++k) {
        const double expected = first + (last - first) * static_cast<double>(k) / 4.0;
        EXPECT_NEAR(enclosed_volume(r.shapes[k].grid, r.shapes[k].values.data()), expected, 1e-6 * expected);
    }
}

TEST(DiscreteGeodesic, LengthHardlyDependsOnTheNumberOfSteps) {
    const auto [a, b] = two_boxes<2>(5);
    double least = 1e300, most = 0.0;
    for (const int steps : {2, 4, 8}) {
        const double length = compute_discrete_geodesic<2>(a, b, options_for(5, steps)).path_length;
        least = std::min(least, length);
        most = std::max(most, length);
    }
    EXPECT_LT(most - least, 0.03 * most);
}

TEST(DiscreteGeodesic, ObserverCancels) {
    const auto [a, b] = two_boxes<2>(6);
    int calls = 0;
    const auto r =
        compute_discrete_geodesic<2>(a, b, options_for(6, 4), {}, [&](const LevelReport&) { return ++calls < 2; });
    EXPECT_EQ(r.termination, Termination::cancelled);
    EXPECT_EQ(calls, 2);
    EXPECT_TRUE(std::isnan(r.path_length));
}

TEST(DiscreteGeodesic, IterationLimitIsSaid) {
    const auto [a, b] = two_boxes<2>(6);
    auto options = options_for(6, 4);
    options.max_iterations = 1;
    const auto r = compute_discrete_geodesic<2>(a, b, options);
    EXPECT_EQ(r.termination, Termination::max_steps);
    EXPECT_FALSE(r.message.empty());
}

TEST(DiscreteGeodesic, BadInputIsRefused) {
    const auto u = tests::ball<2>(4, 0.2);
    EXPECT_THROW(compute_discrete_geodesic<2>(u, u, options_for(5, 2)), std::invalid_argument);
    EXPECT_THROW(compute_discrete_geodesic<2>(u, LevelSet<2>(u.grid, -1.0), options_for(4, 2)), std::invalid_argument);
    EXPECT_THROW(compute_discrete_geodesic<2>(u, u, options_for(4, 3)), std::invalid_argument);
    for (const double value : {std::nan(""), HUGE_VAL}) {
        auto broken = u;
        broken.values.front() = value;
        EXPECT_THROW(compute_discrete_geodesic<2>(broken, u, options_for(4, 2)), std::invalid_argument);
        EXPECT_THROW(compute_discrete_geodesic<2>(u, broken, options_for(4, 2)), std::invalid_argument);
    }
    for (const double value : {-0.5, 1.5, std::nan("")}) {
        const ScalarField<2> mask(u.grid, value);
        EXPECT_THROW(compute_discrete_geodesic<2>(u, u, options_for(4, 2), mask), std::invalid_argument);
    }
    EXPECT_THROW(compute_discrete_geodesic<2>(u, u, options_for(4, 2), ScalarField<2>(DyadicGrid<2>(3), 1.0)),
                 std::invalid_argument);
    EXPECT_THROW(compute_discrete_geodesic<2>(u, u, options_for(4, 2), ScalarField<2>(u.grid, 0.0)),
                 std::invalid_argument);
    const auto speck = tests::ball<2>(7, 0.02, {0.47, 0.47});  // between the nodes of level 4
    EXPECT_THROW(compute_discrete_geodesic<2>(speck, tests::ball<2>(7, 0.2), options_for(4, 2)), std::invalid_argument);
}

}  // namespace
}  // namespace morphodesic
