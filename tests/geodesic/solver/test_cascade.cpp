#include <gtest/gtest.h>

#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/alignment.h"
#include "geodesic/solver/cascade.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class T>
class CascadeIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(CascadeIn, Dimensions);

constexpr int coarse_level(int dim) {
    return dim == 2 ? 6 : 4;
}

template <int Dim>
PathState<Dim> state_of(const tests::PathProblem<Dim>& problem) {
    return {problem.energy.layout(), problem.x};
}

template <int Dim>
double bound(const PathState<Dim>& path) {
    double least = 1e300;
    for (int k = 1; k <= path.layout.time_steps; ++k) {
        DisplacementView<Dim> view;
        for (int a = 0; a < Dim; ++a)
            view[static_cast<std::size_t>(a)] = path.x.data() + path.layout.displacement(k, a);
        least = std::min(least, det_lower_bound<Dim>(path.layout.grid, view));
    }
    return least;
}

TYPED_TEST(CascadeIn, SplittingKeepsTheDeformation) {
    constexpr int dim = TypeParam::value;
    const tests::PathProblem<dim> problem(coarse_level(dim), 2, GeodesicOptions{});
    const auto path = state_of(problem);
    int folds = -1;
    const auto fine = split_in_time(path, problem.energy.first(), problem.energy.last(), folds);
    EXPECT_EQ(folds, 0);
    ASSERT_EQ(fine.layout.time_steps, 4);
    // phi_k = second o first at the nodes, up to the interpolation of the second half.
    const auto& grid = path.layout.grid;
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        auto x = grid.position(grid.node(i));
        const auto start = x;
        for (int a = 0; a < dim; ++a) x[static_cast<std::size_t>(a)] += fine.x[fine.layout.displacement(1, a) + i];
        for (int a = 0; a < dim; ++a) {
            const double second = q1::value(grid, fine.x.data() + fine.layout.displacement(2, a), x);
            const double end = x[static_cast<std::size_t>(a)] + second;
            const double whole = start[static_cast<std::size_t>(a)] + path.x[path.layout.displacement(1, a) + i];
            ASSERT_NEAR(end, whole, 0.1 * grid.spacing());
        }
    }
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        ASSERT_EQ(fine.x[fine.layout.level_set(2) + i], path.x[path.layout.level_set(1) + i]);
    }
}

TYPED_TEST(CascadeIn, SmoothingLeavesWhatTheCoarserGridCanTell) {
    constexpr int dim = TypeParam::value;
    int folds = 0;
    auto path = prolong_in_space(state_of(tests::PathProblem<dim>(coarse_level(dim) - 1, 2, GeodesicOptions{})), folds);
    ASSERT_EQ(folds, 0);
    const auto before = path.x;
    typename DyadicGrid<dim>::Index between;
    between.fill(path.layout.grid.cells_per_axis() / 2 + 1);  // no node of the coarser grid
    double& spike = path.x[path.layout.displacement(2, 0) + path.layout.grid.index(between)];
    spike += 0.3 * path.layout.grid.spacing();
    EXPECT_EQ(smooth_deformations(path), 0);
    for (std::size_t i = 0; i < before.size(); ++i) ASSERT_NEAR(path.x[i], before[i], 1e-15);

    for (int& node : between) node -= 1;  // one that it has, moved across the next
    path.x[path.layout.displacement(1, 0) + path.layout.grid.index(between)] += 2.5 * path.layout.grid.spacing();
    EXPECT_GT(smooth_deformations(path), 0);
    EXPECT_GE(bound(path), 0.05);
}

TYPED_TEST(CascadeIn, ProlongedFoldIsRepaired) {
    // Two neighbouring nodes so close that the finer grid, or the one itself, folds.
    constexpr int dim = TypeParam::value;
    tests::PathProblem<dim> problem(coarse_level(dim), 2, GeodesicOptions{});
    auto path = state_of(problem);
    typename DyadicGrid<dim>::Index middle;
    middle.fill(path.layout.grid.cells_per_axis() / 2);
    path.x[path.layout.displacement(1, 0) + path.layout.grid.index(middle)] += 1.4 * path.layout.grid.spacing();
    ASSERT_LT(bound(path), 0.0);
    int folds = 0;
    const auto fine = prolong_in_space(path, folds);
    EXPECT_GT(folds, 0);
    EXPECT_GE(bound(fine), 0.05);
    PathEnergy<dim> energy(tests::ball<dim>(coarse_level(dim) + 1, 0.2),
                           tests::PathProblem<dim>::shifted_ball(coarse_level(dim) + 1), 2, GeodesicOptions{});
    EXPECT_TRUE(std::isfinite(energy.evaluate(fine.x, {}).total));
}

TYPED_TEST(CascadeIn, TransportedShapesLowerTheMismatch) {
    constexpr int dim = TypeParam::value;
    tests::PathProblem<dim> problem(coarse_level(dim), 4, GeodesicOptions{});
    auto path = state_of(problem);
    const auto mismatch = [&](const std::vector<double>& x) {
        double sum = 0.0;
        for (const double m : problem.energy.evaluate(x, {}).mismatch) sum += m;
        return sum;
    };
    const double before = mismatch(path.x);
    transport_shapes(path, problem.energy.first(), problem.energy.last(), problem.energy.eps());
    EXPECT_LT(mismatch(path.x), before);
}

template <int Dim>
RigidMotion<Dim> turn(double angle) {
    RigidMotion<Dim> m;
    m.rotation[0] = m.rotation[Dim + 1] = std::cos(angle);
    m.rotation[1] = -std::sin(angle);
    m.rotation[Dim] = std::sin(angle);
    return m;
}

TYPED_TEST(CascadeIn, AlignmentFindsTheMotionOfAMovedShape) {
    constexpr int dim = TypeParam::value;
    Point<dim> half, centre;
    half.fill(0.06);
    half[0] = 0.22;
    half[dim - 1] = 0.1;
    centre.fill(0.5);
    auto a = tests::turned_box<dim>(coarse_level(dim) + 1, half, centre, 0.0);
    // An appendix makes the box ambiguous no more.
    centre[0] = 0.62;
    centre[1] = 0.58;
    Point<dim> small;
    small.fill(0.07);
    a = tests::united(a, tests::turned_box<dim>(coarse_level(dim) + 1, small, centre, 0.0));
    for (const double angle : {0.3, 2.0, 4.0}) {
        auto motion = turn<dim>(angle);
        motion.translation[0] = 0.03;
        const auto b = moved(a, motion, a.grid.level());
        const auto found = align(a, b, "rigid", 3);
        ASSERT_FALSE(found.empty());
        for (std::size_t i = 0; i < motion.rotation.size(); ++i) {
            EXPECT_NEAR(found.front().motion.rotation[i], motion.rotation[i], 0.02) << "angle " << angle;
        }
        EXPECT_NEAR(found.front().motion.translation[0], motion.translation[0], 0.005);
    }
    EXPECT_THROW(align(a, LevelSet<dim>(a.grid, -1.0), "rigid", 1), std::invalid_argument);
}

TYPED_TEST(CascadeIn, MovedByIdentityIsTheSame) {
    constexpr int dim = TypeParam::value;
    const auto u = tests::ball<dim>(coarse_level(dim), 0.2);
    const auto same = moved(u, RigidMotion<dim>{}, coarse_level(dim));
    for (std::size_t i = 0; i < u.values.size(); ++i) ASSERT_NEAR(same.values[i], u.values[i], 1e-13);
}

TEST(RigidMotion, InverseUndoes) {
    auto m = turn<3>(0.7);
    m.translation = {0.1, -0.2, 0.05};
    const Point<3> x{0.3, 0.8, 0.4}, y = m.inverse()(m(x));
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(y[a], x[a], 1e-15);
}

}  // namespace
}  // namespace morphodesic
