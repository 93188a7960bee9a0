#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/canonical_frame.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

double angle_of(const RigidMotion<2>& motion) {
    return std::atan2(motion.rotation[2], motion.rotation[0]);
}

TEST(RigidMotion, IsChained) {
    auto first = turn_by(0.4), second = turn_by(-1.1);
    first.translation = {0.1, -0.2};
    second.translation = {0.05, 0.3};
    const Point<2> x{0.3, 0.7};
    const auto both = second.after(first)(x), one_by_one = second(first(x));
    for (std::size_t a = 0; a < 2; ++a) EXPECT_NEAR(both[a], one_by_one[a], 1e-15);
    const auto still = first.inverse().after(first)(x);
    for (std::size_t a = 0; a < 2; ++a) EXPECT_NEAR(still[a], x[a], 1e-15);
}

TEST(CanonicalFrame, TakesStraightStrokesToTheGridHoweverTheyLie) {
    for (const double angle : {0.0, 0.2, 0.7, 1.3, 2.9, -2.1}) {
        const Point<2> centre{0.55, 0.46};
        const auto motion = canonical_frame(tests::turned_box<2>(7, {0.25, 0.06}, centre, angle));
        const double quarters = (angle_of(motion) + angle) / (0.5 * std::numbers::pi);
        EXPECT_NEAR(quarters, std::round(quarters), 0.01) << "angle " << angle;
        for (const double c : motion(centre)) EXPECT_NEAR(c, 0.5, 1e-3) << "angle " << angle;
    }
}

TEST(CanonicalFrame, IsTheIdentityWhereThereIsNone) {
    EXPECT_TRUE(canonical_frame(tests::ball<2>(6, 0.25)).is_identity());
    EXPECT_TRUE(canonical_frame(tests::turned_box<3>(4, {0.25, 0.1, 0.1}, {0.5, 0.5, 0.5}, 0.3)).is_identity());
    // Along the diagonal it fits into the square, along a side it does not.
    const auto long_bar = tests::turned_box<2>(6, {0.6, 0.05}, {0.5, 0.5}, 0.25 * std::numbers::pi);
    EXPECT_TRUE(canonical_frame(long_bar).is_identity());
}

TEST(CanonicalFrame, IsTakenBackForPictures) {
    const int level = 7, steps = 2;
    const auto a = tests::turned_box<2>(level, {0.2, 0.1}, {0.5, 0.5}, 0.1);
    const auto b = tests::turned_box<2>(level, {0.26, 0.07}, {0.53, 0.48}, 0.5);
    GeodesicOptions options;
    options.level = level;
    options.time_steps = steps;
    options.starts = 1;
    const auto path = compute_discrete_geodesic<2>(a, b, options);
    ASSERT_NEAR(std::abs(std::remainder(angle_of(path.frame) + 0.5, 0.5 * std::numbers::pi)), 0.0, 0.01);
    // The first box lies along the second one, seen from the pose of the second.
    const double turned = std::remainder(angle_of(path.motion) - 0.4, std::numbers::pi);
    EXPECT_NEAR(turned, 0.0, 0.02);

    const auto seen = in_pose_of_last(path);
    EXPECT_TRUE(seen.frame.is_identity());
    EXPECT_EQ(seen.path_length, path.path_length);
    const double h = b.grid.spacing();
    const auto first = moved(a, path.motion, level);
    for (std::size_t i = 0; i < b.values.size(); ++i) {
        // Near the contour both have passed one or two interpolations.
        if (std::abs(b.values[i]) < 4 * h) {
            ASSERT_NEAR(seen.shapes.back().values[i], b.values[i], 0.2 * h);
        }
        if (std::abs(first.values[i]) < 4 * h) {
            ASSERT_NEAR(seen.shapes.front().values[i], first.values[i], 0.2 * h);
        }
    }
    // phi_k still takes each shape to the next: what is left of the mismatch is that of the path.
    for (int k = 0; k < steps; ++k) {
        const auto& w = seen.deformations[static_cast<std::size_t>(k)].displacement;
        const auto &before = seen.shapes[static_cast<std::size_t>(k)],
                   &after = seen.shapes[static_cast<std::size_t>(k) + 1];
        double mismatch = 0.0, without = 0.0;
        for (std::size_t i = 0; i < before.values.size(); ++i) {
            auto x = b.grid.position(b.grid.node(i));
            const double here = smooth_heaviside(before.values[i], h);
            without += std::pow(smooth_heaviside(after.values[i], h) - here, 2) * h * h;
            for (std::size_t c = 0; c < 2; ++c) x[c] += w.components[c][i];
            mismatch += std::pow(smooth_heaviside(q1::value(b.grid, after.values.data(), x), h) - here, 2) * h * h;
        }
        EXPECT_LT(mismatch, 0.1 * without) << "step " << k + 1;
    }
}

TEST(CanonicalFrame, PathsThatWereNotTurnedStay) {
    GeodesicResult<2> path;
    path.shapes.push_back(tests::ball<2>(4, 0.3));
    path.deformations.emplace_back(path.shapes.front().grid);
    EXPECT_EQ(in_pose_of_last(path).shapes.front().values, path.shapes.front().values);
}

}  // namespace
}  // namespace morphodesic
