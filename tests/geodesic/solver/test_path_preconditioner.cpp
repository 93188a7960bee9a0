// The preconditioner of whole paths: symmetry, and that moves of shapes and deformations together are not held back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geodesic/grid/injectivity.h"
#include "geodesic/solver/cascade.h"
#include "geodesic/solver/path_minimizer.h"
#include "geodesic/solver/path_preconditioner.h"
#include "geodesic/solver/transport_correction.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class T>
class PathPreconditionerIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PathPreconditionerIn, Dimensions);

double dot(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    return sum;
}

/// Random vector with zero displacements on the boundary, as gradients have.
template <int Dim>
std::vector<float> random_gradient(const PathLayout<Dim>& layout, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    std::vector<float> g(layout.size());
    for (float& v : g) v = uniform(random);
    for (std::size_t i = 0; i < layout.nodes(); ++i) {
        const bool boundary = layout.grid.on_boundary(layout.grid.node(i));
        if (!boundary) continue;
        for (int k = 1; k <= layout.time_steps; ++k) {
            for (int a = 0; a < Dim; ++a) g[layout.displacement(k, a) + i] = 0.0F;
        }
    }
    return g;
}

TYPED_TEST(PathPreconditionerIn, IsSymmetricAndPositiveAndKeepsTheBoundary) {
    constexpr int Dim = TypeParam::value;
    tests::PathProblem<Dim> problem(Dim == 2 ? 5 : 4, 4, GeodesicOptions{});
    PathPreconditioner<Dim> preconditioner(problem.energy);
    preconditioner.update(problem.energy, problem.x);
    const auto& layout = problem.energy.layout();
    const auto a = random_gradient<Dim>(layout, 1), b = random_gradient<Dim>(layout, 2);
    auto pa = a, pb = b;
    preconditioner.apply(pa);
    preconditioner.apply(pb);
    const double scale = std::sqrt(dot(a, pa) * dot(b, pb));
    EXPECT_NEAR(dot(a, pb), dot(b, pa), 1e-4 * scale);
    EXPECT_GT(dot(a, pa), 0.0);
    for (std::size_t i = 0; i < layout.nodes(); ++i) {
        const bool boundary = layout.grid.on_boundary(layout.grid.node(i));
        for (int k = 1; boundary && k <= layout.time_steps; ++k) {
            for (int c = 0; c < Dim; ++c) ASSERT_EQ(pa[layout.displacement(k, c) + i], 0.0F);
        }
    }
}

TYPED_TEST(PathPreconditionerIn, TransportCorrectionIsSymmetricAndSemidefinite) {
    constexpr int Dim = TypeParam::value;
    tests::PathProblem<Dim> problem(Dim == 2 ? 5 : 4, 4, GeodesicOptions{});
    const auto& layout = problem.energy.layout();
    TransportCorrection<Dim> correction(layout);
    const std::vector<std::vector<float>> weights(4, std::vector<float>(layout.nodes(), 14.0F));
    const std::vector<std::vector<float>> inverse_u(3, std::vector<float>(layout.nodes(), 0.1F));
    correction.follow(problem.energy, problem.x);
    for (int k = 0; k < layout.time_steps; ++k) {
        DisplacementView<Dim> w;
        for (int a = 0; a < Dim; ++a) {
            w[static_cast<std::size_t>(a)] = problem.x.data() + layout.displacement(k + 1, a);
        }
        for_each_mismatch_point<Dim>(layout.grid, mismatch_points<Dim>(problem.energy.quadrature()),
                                     problem.energy.level_set(problem.x, k), problem.energy.level_set(problem.x, k + 1),
                                     w, problem.energy.eps(),
                                     [&](const MismatchPoint<Dim>& p) { correction.add_point(k, p); });
    }
    correction.build(problem.energy, problem.x, weights, inverse_u);
    for (unsigned seed = 1; seed < 4; ++seed) {
        const auto a = random_gradient<Dim>(layout, seed), b = random_gradient<Dim>(layout, seed + 10);
        std::vector<float> ta(a.size()), tb(b.size());
        correction.take(a);
        correction.add_to(ta);
        correction.take(b);
        correction.add_to(tb);
        EXPECT_GT(dot(a, ta), 0.0);
        EXPECT_NEAR(dot(a, tb), dot(b, ta), 1e-4 * std::sqrt(dot(a, ta) * dot(b, tb)));
    }
}

/// A path that reaches the last shape but moves unevenly: the material is carried all the way in the first step. Making
/// it even moves shapes and deformations together; each alone would open a mismatch.
TYPED_TEST(PathPreconditionerIn, UnevenMotionIsEvenedOutInFewIterations) {
    constexpr int Dim = TypeParam::value;
    constexpr int steps = 4, level = Dim == 2 ? 5 : 4;
    Point<Dim> left, right;
    left.fill(0.5);
    right.fill(0.5);
    left[0] = 0.45;
    right[0] = 0.55;
    const auto first = tests::ball<Dim>(level, 0.22, left), last = tests::ball<Dim>(level, 0.22, right);
    GeodesicOptions options;
    options.rim_width = 1.0;
    PathEnergy<Dim> energy(first, last, steps, options);
    auto path = blended_path(first, last, steps);
    for (std::size_t i = 0; i < path.layout.nodes(); ++i) {
        const auto x = path.layout.grid.position(path.layout.grid.node(i));
        double bump = 0.1;
        for (std::size_t a = 0; a < Dim; ++a) bump *= std::sin(std::numbers::pi * x[a]);
        path.x[path.layout.displacement(1, 0) + i] = bump;
        for (int k = 1; k < steps; ++k) path.x[path.layout.level_set(k) + i] = last.values[i];
    }
    MinimizerOptions minimizer;
    minimizer.tolerance = 1e-6;
    minimizer.max_iterations = 25;
    auto few = path.x, many = path.x;
    const double after_few = minimize_path<Dim>(energy, few, minimizer).terms.total;
    minimizer.max_iterations = 400;
    const double after_many = minimize_path<Dim>(energy, many, minimizer).terms.total;
    EXPECT_LT(after_few, 1.08 * after_many);
}

TYPED_TEST(PathPreconditionerIn, ChangesAreShortenedOnlyWhereTheySqueezeCells) {
    constexpr int Dim = TypeParam::value;
    const DyadicGrid<Dim> grid(4);
    VectorField<Dim> w(grid);
    std::array<std::vector<float>, Dim> d;
    for (auto& c : d) c.resize(grid.node_count());
    for (std::size_t i = 0; i < grid.node_count(); ++i) {
        for (int a = 0; a < Dim; ++a) {
            d[static_cast<std::size_t>(a)][i] =
                static_cast<float>(0.02 * tests::smooth_wave<Dim>(grid.position(grid.node(i)), a, 1));
        }
    }
    DisplacementView<Dim> view;
    std::array<float*, Dim> change;
    for (std::size_t a = 0; a < Dim; ++a) {
        view[a] = w.components[a].data();
        change[a] = d[a].data();
    }
    const auto gentle = d;
    EXPECT_EQ(limit_change<Dim>(grid, view, change, 0.3), 0);
    EXPECT_EQ(d, gentle);

    typename DyadicGrid<Dim>::Index middle;
    middle.fill(8);
    d[0][grid.index(middle)] += static_cast<float>(3.0 * grid.spacing());  // over the next nodes: folds
    const auto wild = d;
    EXPECT_GT(limit_change<Dim>(grid, view, change, 0.3), 0);
    DisplacementView<Dim> shortened;
    for (std::size_t a = 0; a < Dim; ++a) {
        w.components[a].assign(d[a].begin(), d[a].end());
        shortened[a] = w.components[a].data();
    }
    const auto det = least_node_det<Dim>(grid, shortened);
    EXPECT_GE(*std::min_element(det.begin(), det.end()), 0.3 - 1e-6);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < grid.node_count(); ++i) changed += d[0][i] != wild[0][i] ? 1 : 0;
    EXPECT_LT(changed, grid.node_count() / 8);
}

}  // namespace
}  // namespace morphodesic
