#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "geodesic/solver/partial_alignment.h"
#include "geodesic/solver/partial_mismatch.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

/// Signed distance to a box, > 0 inside.
double box(double x, double y, double cx, double cy, double half_width, double half_height) {
    const double dx = std::abs(x - cx) - half_width, dy = std::abs(y - cy) - half_height;
    return -(std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) + std::min(std::max(dx, dy), 0.0));
}

/// An L with unequal legs: no symmetry.
double ell(double x, double y) {
    return std::max(box(x, y, 0.42, 0.5, 0.06, 0.28), box(x, y, 0.55, 0.28, 0.19, 0.06));
}

template <class Value>
LevelSet<2> sampled(int level, const Value& value) {
    LevelSet<2> u{DyadicGrid<2>(level)};
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const Point<2> x = u.grid.position(u.grid.node(i));
        u.values[i] = value(x);
    }
    return u;
}

/// The L seen from another place: x = T(y) lies in the frame of the whole shape.
Similarity<2> other_place(double degrees, double scale) {
    Similarity<2> t;
    t.motion = turn_by(degrees * M_PI / 180);
    t.motion.translation = {0.05, -0.04};
    t.scale = scale;
    return t;
}

double error_of(const Similarity<2>& found, const Similarity<2>& truth) {
    double worst = 0.0;
    for (const Point<2>& x : {Point<2>{0.3, 0.3}, Point<2>{0.7, 0.4}, Point<2>{0.4, 0.7}}) {
        const Point<2> a = found(x), b = truth(x);
        worst = std::max(worst, std::hypot(a[0] - b[0], a[1] - b[1]));
    }
    return worst;
}

TEST(PartialAlignment, FindsATurnedShapeOfWhichAThirdIsHidden) {
    const Similarity<2> truth = other_place(130, 1.0);
    const LevelSet<2> whole = sampled(6, [](const Point<2>& x) { return ell(x[0], x[1]); });
    // Hidden in the frame of the whole shape: y > 0.55, the upper part of the long leg.
    const LevelSet<2> partial = sampled(6, [&](const Point<2>& x) {
        const Point<2> y = truth(x);
        return std::min(ell(y[0], y[1]), 0.55 - y[1]);
    });
    const ScalarField<2> mask =
        sampled(6, [&](const Point<2>& x) { return std::min(1.0, std::max(0.0, 0.5 + (0.55 - truth(x)[1]) * 64)); });
    const auto found = PartialAligner<2>(partial, mask).align(whole, {});
    ASSERT_FALSE(found.empty());
    EXPECT_LT(error_of(found.front().motion, truth), 0.01);
    EXPECT_LE(found.size(), 2U);
}

TEST(PartialAlignment, FindsTheSizeIfItIsOpen) {
    const Similarity<2> truth = other_place(-40, 0.8);
    const LevelSet<2> whole = sampled(6, [](const Point<2>& x) { return ell(x[0], x[1]); });
    const LevelSet<2> partial = sampled(6, [&](const Point<2>& x) {
        const Point<2> y = truth(x);
        return ell(y[0], y[1]) / truth.scale;
    });
    PartialAlignmentOptions options;
    options.least_scale = 0.6;
    options.largest_scale = 1.1;
    const auto found = PartialAligner<2>(partial, {}).align(whole, options);
    EXPECT_NEAR(found.front().motion.scale, 0.8, 0.02);
    EXPECT_LT(error_of(found.front().motion, truth), 0.012);
    // With the size kept, the scale stays what it is and the mismatch is larger.
    const auto kept = PartialAligner<2>(partial, {}).align(whole, {});
    EXPECT_EQ(kept.front().motion.scale, 1.0);
    EXPECT_GT(kept.front().mismatch, 2 * found.front().mismatch);
}

TEST(PartialAlignment, TranslationsDoNotTurn) {
    const LevelSet<2> whole = sampled(5, [](const Point<2>& x) { return ell(x[0], x[1]); });
    const LevelSet<2> shifted = sampled(5, [](const Point<2>& x) { return ell(x[0] + 0.08, x[1] - 0.06); });
    PartialAlignmentOptions options;
    options.rotate = false;
    const auto found = PartialAligner<2>(shifted, {}).align(whole, options);
    EXPECT_EQ(found.front().motion.motion.rotation, RigidMotion<2>::identity());
    EXPECT_NEAR(found.front().motion.motion.translation[0], 0.08, 0.005);
    EXPECT_NEAR(found.front().motion.motion.translation[1], -0.06, 0.005);
}

TEST(PartialAlignment, AnUnmovedFieldKeepsItsValues) {
    const LevelSet<2> whole = sampled(5, [](const Point<2>& x) { return ell(x[0], x[1]); });
    EXPECT_EQ(carried(whole, Similarity<2>{}, 5).values, whole.values);
}

TEST(PartialAlignment, NothingVisibleIsRefused) {
    const LevelSet<2> whole = sampled(5, [](const Point<2>& x) { return ell(x[0], x[1]); });
    EXPECT_THROW(PartialAligner<2>(whole, ScalarField<2>(whole.grid, 0.0)), std::invalid_argument);
}

template <class Dimension>
class PartialMismatchIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PartialMismatchIn, Dimensions);

/// Central differences in every unknown: angles, translation, logarithm of the size.
TYPED_TEST(PartialMismatchIn, GradientIsThatOfTheMismatch) {
    constexpr int dim = TypeParam::value;
    using Problem = partial::MismatchProblem<dim>;
    using Row = typename Problem::Row;
    Point<dim> half, centre;
    for (std::size_t a = 0; a < dim; ++a)
        half[a] = 0.12 + 0.05 * static_cast<double>(a), centre[a] = 0.5 + 0.02 * static_cast<double>(a);
    const LevelSet<dim> partial = tests::turned_box<dim>(5, half, centre, 0.3);
    const partial::Sampler<dim> part(partial), whole(tests::turned_box<dim>(5, half, centre, -0.2));
    ScalarField<dim> mask(partial.grid, 1.0);
    for (std::size_t i = 0; i < mask.values.size(); ++i) {
        mask.values[i] = std::clamp(2.0 - 2.5 * partial.grid.position(partial.grid.node(i))[0], 0.0, 1.0);
    }
    const partial::Samples<dim> samples(part, mask, 16);
    PartialAlignmentOptions options;
    options.missing_weight = 0.4;
    const Problem problem(samples, whole, options);
    partial::Motion<dim> at;
    Row turn = Row::Zero();
    for (int i = 0; i < Problem::angles; ++i) turn(i) = 0.1 * (i + 1);
    at.rotation = small_rotation<dim>(turn);
    for (int i = 0; i < dim; ++i) at.translation(i) = 0.013 * (i + 1);
    at.scale = 1.07;
    const auto moved = [&](int unknown, double t) {
        partial::Motion<dim> m = at;
        Row step = Row::Zero();
        step(unknown) = t;
        m.rotation = small_rotation<dim>(step) * at.rotation;
        m.translation += step.template segment<dim>(Problem::angles);
        m.scale *= std::exp(step(Problem::unknowns - 1));
        return m;
    };
    // Without the factor of the size in front of the sum, which Gauss and Newton take as fixed.
    const auto sum = [&](const partial::Motion<dim>& m) {
        return problem.evaluate(m, nullptr, nullptr) / std::pow(m.scale * samples.spacing, dim);
    };
    Row gradient;
    typename Problem::System normal;
    (void)problem.evaluate(at, &gradient, &normal);
    for (int i = 0; i < Problem::unknowns; ++i) {
        constexpr double t = 1e-5;
        const double difference = (sum(moved(i, t)) - sum(moved(i, -t))) / (2 * t);
        EXPECT_NEAR(2 * gradient(i), difference, 2e-3 * gradient.norm()) << "unknown " << i;
        EXPECT_GT(std::abs(difference), 0.005 * gradient.norm()) << "unknown " << i << " is not tried out";
    }
}

}  // namespace
}  // namespace morphodesic
