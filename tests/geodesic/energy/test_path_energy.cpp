#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geodesic/energy/area_energy.h"
#include "geodesic/energy/heaviside.h"
#include "geodesic/energy/path_energy.h"
#include "geodesic/energy/stored_energy_density.h"
#include "geodesic/energy/stretched_cells.h"
#include "geodesic/grid/q1_element.h"
#include "tests/support/path_problems.h"
#include "tests/support/thread_counts.h"

namespace morphodesic {
namespace {

template <class T>
class PathEnergyIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PathEnergyIn, Dimensions);

constexpr int level_of(int dim) {
    return dim == 2 ? 7 : 5;
}

/// Which unknowns move in a Taylor test.
enum class Part { deformations, shapes, all };

template <int Dim>
double order(const GeodesicOptions& options, Part part, const ScalarField<Dim>& mask = {}, double step = 0.1) {
    tests::PathProblem<Dim> problem(level_of(Dim), 2, options, mask);
    const auto& layout = problem.energy.layout();
    for (std::size_t i = 0; i < layout.size(); ++i) {
        const bool shape = i >= layout.level_set(1);
        if ((part == Part::deformations && shape) || (part == Part::shapes && !shape)) problem.direction[i] = 0.0;
    }
    std::vector<double> gradient(problem.x.size());
    problem.energy.evaluate(problem.x, gradient);
    double norm = 0.0;
    for (std::size_t i = 0; i < gradient.size(); ++i) norm += std::abs(gradient[i] * problem.direction[i]);
    EXPECT_GT(norm, 1e-6) << "a gradient without effect would pass for the wrong reason";
    const auto energy = [&](const std::vector<double>& x) { return problem.energy.evaluate(x, {}).total; };
    return tests::taylor_order(energy, gradient, problem.x, problem.direction, step * layout.grid.spacing());
}

/// Only one of the three energies.
GeodesicOptions only_deformation() {
    GeodesicOptions o;
    o.mismatch_weight_per_step = 1e-12;
    return o;
}
GeodesicOptions only_mismatch() {
    GeodesicOptions o;
    o.lambda = 0.0;
    o.mu = 1e-12;
    return o;
}
GeodesicOptions only_area() {
    GeodesicOptions o = only_mismatch();
    o.mismatch_weight_per_step = 1e-12;
    o.area_weight = 1.0;
    return o;
}

TYPED_TEST(PathEnergyIn, DeformationEnergyGradientInPhiPassesTaylorTest) {
    EXPECT_NEAR(order<TypeParam::value>(only_deformation(), Part::deformations), 2.0, 0.1);
}
TYPED_TEST(PathEnergyIn, DeformationEnergyGradientInUPassesTaylorTest) {
    EXPECT_NEAR(order<TypeParam::value>(only_deformation(), Part::shapes), 2.0, 0.1);
}
TYPED_TEST(PathEnergyIn, MismatchGradientInPhiPassesTaylorTest) {
    // Q1 fields have kinks at cell faces that a moved point may cross: the order is a little below 2.
    EXPECT_GT(order<TypeParam::value>(only_mismatch(), Part::deformations), 1.8);
}
TYPED_TEST(PathEnergyIn, MismatchGradientInUPassesTaylorTest) {
    EXPECT_NEAR(order<TypeParam::value>(only_mismatch(), Part::shapes), 2.0, 0.1);
}
TYPED_TEST(PathEnergyIn, AreaGradientInUPassesTaylorTest) {
    // |grad u| is the least smooth of all terms, so the steps are small.
    EXPECT_NEAR(order<TypeParam::value>(only_area(), Part::shapes, {}, 0.01), 2.0, 0.1);
}
TYPED_TEST(PathEnergyIn, WholeGradientPassesTaylorTest) {
    GeodesicOptions o;
    o.area_weight = 0.01;
    EXPECT_GT(order<TypeParam::value>(o, Part::all), 1.8);
}
TYPED_TEST(PathEnergyIn, MaskedGradientPassesTaylorTest) {
    constexpr int dim = TypeParam::value;
    ScalarField<dim> mask{DyadicGrid<dim>(level_of(dim))};
    for (std::size_t i = 0; i < mask.values.size(); ++i) {
        mask.values[i] = smooth_heaviside(mask.grid.position(mask.grid.node(i))[0] - 0.45, 0.05);
    }
    EXPECT_GT(order<dim>(GeodesicOptions{}, Part::all, mask), 1.8);
}

TYPED_TEST(PathEnergyIn, SinglePrecisionAgreesWithDouble) {
    constexpr int dim = TypeParam::value;
    for (const int level : {3, level_of(dim)}) {  // 3: too few cells for the lanes
        GeodesicOptions o;
        o.area_weight = 0.01;
        ScalarField<dim> mask{DyadicGrid<dim>(level)};
        for (std::size_t i = 0; i < mask.values.size(); ++i) {
            mask.values[i] = smooth_heaviside(mask.grid.position(mask.grid.node(i))[0] - 0.45, 0.05);
        }
        tests::PathProblem<dim> problem(level, 2, o, mask);
        // Squeezed somewhere, so that the barrier acts.
        typename DyadicGrid<dim>::Index middle;
        middle.fill((1 << level) / 2);
        problem.x[problem.energy.layout().displacement(1, 0) + problem.energy.layout().grid.index(middle)] +=
            0.82 / (1 << level);
        std::vector<double> gradient(problem.x.size());
        std::vector<float> single(problem.x.size());
        const auto exact = problem.energy.evaluate(problem.x, gradient);
        const auto near = problem.energy.evaluate_single(problem.x, single);
        ASSERT_GT(exact.barrier, 0.0);
        EXPECT_NEAR(near.total, exact.total, 2e-6 * exact.total);
        EXPECT_NEAR(near.min_det, exact.min_det, 1e-5);
        EXPECT_EQ(problem.energy.evaluate_single(problem.x, {}).total, near.total);
        for (std::size_t k = 0; k < 2; ++k) {
            EXPECT_NEAR(near.deformation[k], exact.deformation[k], 2e-6 * exact.deformation[k]);
            EXPECT_NEAR(near.mismatch[k], exact.mismatch[k], 2e-6 * exact.mismatch[k]);
        }
        double norm = 0.0, error = 0.0;
        for (std::size_t i = 0; i < gradient.size(); ++i) {
            norm += gradient[i] * gradient[i];
            error += std::pow(gradient[i] - static_cast<double>(single[i]), 2);
        }
        EXPECT_LT(std::sqrt(error), 1e-5 * std::sqrt(norm));
    }
}

TYPED_TEST(PathEnergyIn, BarrierGradientPassesTaylorTest) {
    // Squeezed to det = 0.15 in the background: the barrier acts, nothing else does.
    constexpr int dim = TypeParam::value;
    GeodesicOptions o = only_mismatch();
    o.mismatch_weight_per_step = 1e-12;
    tests::PathProblem<dim> problem(level_of(dim), 1, o);
    const auto& layout = problem.energy.layout();
    for (std::size_t i = 0; i < layout.nodes(); ++i) {
        const auto x = layout.grid.position(layout.grid.node(i));
        for (int a = 0; a < dim; ++a) problem.x[layout.displacement(1, a) + i] = 0.0;
        double bump = 1.0;
        for (std::size_t a = 1; a < dim; ++a) bump *= std::sin(std::numbers::pi * x[a]);
        problem.x[layout.displacement(1, 0) + i] =
            0.85 / (2 * std::numbers::pi) * std::sin(2 * std::numbers::pi * x[0]) * bump;
    }
    std::vector<double> gradient(problem.x.size());
    const auto terms = problem.energy.evaluate(problem.x, gradient);
    ASSERT_GT(terms.barrier, 1e-7);
    ASSERT_LT(terms.min_det, 0.2);
    const auto energy = [&](const std::vector<double>& x) { return problem.energy.evaluate(x, {}).total; };
    EXPECT_GT(tests::taylor_order(energy, gradient, problem.x, problem.direction, 0.05 * layout.grid.spacing()), 1.8);
}

/// The energies again, written down naively.
template <int Dim>
double naive_energy(const PathEnergy<Dim>& energy, const std::vector<double>& x, const ScalarField<Dim>& mask) {
    const auto& layout = energy.layout();
    const auto& grid = layout.grid;
    const auto& o = energy.options();
    const auto offsets = q1::corner_offsets(grid);
    const double h = grid.spacing(), eps = energy.eps();
    double total = 0.0;
    for (int k = 1; k <= layout.time_steps; ++k) {
        q1::for_each_cell(grid, [&](std::size_t node) {
            const auto points = kernels::quadrature_points<Dim>(energy.quadrature());
            for (const Point<Dim>& local : points) {
                Point<Dim> here = grid.position(grid.node(node));
                for (int a = 0; a < Dim; ++a) {
                    here[static_cast<std::size_t>(a)] += h * local[static_cast<std::size_t>(a)];
                }
                const double u = q1::value(grid, energy.level_set(x, k - 1), here);
                const double chi = k == 1 && !mask.values.empty() ? q1::value(grid, mask.values.data(), here) : 1.0;
                std::array<double, Dim * Dim> b{};
                Point<Dim> there = here;
                for (int i = 0; i < Dim; ++i) {
                    for (int c = 0; c < (1 << Dim); ++c) {
                        const double w = x[layout.displacement(k, i) + node + offsets[static_cast<std::size_t>(c)]];
                        there[static_cast<std::size_t>(i)] += q1::shape<Dim>(c, local) * w;
                        for (int j = 0; j < Dim; ++j) {
                            b[static_cast<std::size_t>(i * Dim + j)] += q1::shape_slope<Dim>(c, local, j) * w / h;
                        }
                    }
                }
                const double v = q1::value(grid, energy.level_set(x, k), there);
                const double weight = (1 - o.outside_stiffness) * smooth_heaviside(u, eps) + o.outside_stiffness;
                const double residual = smooth_heaviside(v, eps) - smooth_heaviside(u, eps);
                const double volume = std::pow(h, Dim) / static_cast<double>(points.size());
                total += volume * (layout.time_steps * weight * stored_energy_density<Dim>(b, o.lambda, o.mu) +
                                   energy.eta() * chi * residual * residual);
            }
        });
    }
    return total;
}

TYPED_TEST(PathEnergyIn, KernelsAgreeWithTheFormulas) {
    constexpr int dim = TypeParam::value;
    ScalarField<dim> mask{DyadicGrid<dim>(4)};
    for (std::size_t i = 0; i < mask.values.size(); ++i) mask.values[i] = mask.grid.position(mask.grid.node(i))[1];
    for (const double rim_width : {0.5, 1.0}) {
        GeodesicOptions options;
        options.rim_width = rim_width;
        tests::PathProblem<dim> problem(4, 3, options, mask);
        const double fast = problem.energy.evaluate(problem.x, {}).total;
        EXPECT_NEAR(fast, naive_energy<dim>(problem.energy, problem.x, mask), 1e-11 * fast);
    }
}

/// What stretched cells add to it, see test_stretched_cells.cpp.
template <int Dim>
double stretched_part(const PathEnergy<Dim>& energy, const std::vector<double>& x) {
    const auto& layout = energy.layout();
    double sum = 0.0;
    for (int k = 1; k <= layout.time_steps; ++k) {
        kernels::StepFields<Dim, double> fields{};
        for (int a = 0; a < Dim; ++a) {
            fields.cells[a] = layout.grid.cells(a);
            fields.displacement[a] = x.data() + layout.displacement(k, a);
        }
        fields.u_previous = energy.level_set(x, k - 1);
        fields.u_next = energy.level_set(x, k);
        fields.u_next_last_row = layout.grid.cells(Dim - 1);
        kernels::StepWeights weights{};
        weights.level = layout.grid.level();
        weights.eps = energy.eps();
        weights.quadrature = energy.quadrature();
        sum += stretched_mismatch<Dim, double>(layout.grid, 0, layout.grid.cells(Dim - 1), fields, weights, {});
    }
    return energy.eta() * sum;
}

/// Stretches the middle of every axis by a factor, squeezes the rest, and shifts everything.
template <int Dim>
void stretch_and_shift(tests::PathProblem<Dim>& problem, double factor, double shift) {
    const auto& layout = problem.energy.layout();
    constexpr double half = 0.075;
    const double rest = (0.5 - factor * half) / (0.5 - half);
    for (std::size_t i = 0; i < layout.nodes(); ++i) {
        const auto x = layout.grid.position(layout.grid.node(i));
        for (int a = 0; a < Dim; ++a) {
            const double t = x[static_cast<std::size_t>(a)] - 0.5;
            const double middle = std::clamp(t, -half, half);
            problem.x[layout.displacement(1, a) + i] += (factor - 1) * middle + (rest - 1) * (t - middle) + shift;
        }
    }
}

TYPED_TEST(PathEnergyIn, KernelsAgreeWithTheFormulasWhereCellsAreStretchedOrLeaveTheGrid) {
    // The points of a cell are spread over 2, 3 and more cells along an axis; the kernel reads u_k differently for
    // each.
    constexpr int dim = TypeParam::value;
    for (const auto& [factor, shift] : {std::pair(1.4, 0.0), {2.0, 0.0}, {4.0, 0.0}, {1.0, 0.2}, {2.0, -0.3}}) {
        tests::PathProblem<dim> problem(dim == 2 ? 5 : 4, 2, GeodesicOptions{});
        stretch_and_shift<dim>(problem, factor, shift);
        std::vector<double> gradient(problem.x.size());
        const auto terms = problem.energy.evaluate(problem.x, gradient);
        ASSERT_GT(terms.min_det, 0.0);
        const double naive = naive_energy<dim>(problem.energy, problem.x, {}) + terms.barrier +
                             stretched_part<dim>(problem.energy, problem.x);
        EXPECT_NEAR(terms.total, naive, 1e-11 * naive) << factor;
        std::vector<float> single(problem.x.size());
        EXPECT_NEAR(problem.energy.evaluate_single(problem.x, single).total, terms.total, 2e-6 * terms.total);
        if (shift != 0.0) continue;  // u_k has a kink at the border
        const auto energy = [&](const std::vector<double>& x) { return problem.energy.evaluate(x, {}).total; };
        const double step = 0.02 * problem.energy.layout().grid.spacing();
        EXPECT_GT(tests::taylor_order(energy, gradient, problem.x, problem.direction, step), 1.8) << factor;
    }
}

TYPED_TEST(PathEnergyIn, BitsDoNotDependOnThreads) {
    constexpr int dim = TypeParam::value;
    tests::PathProblem<dim> problem(level_of(dim), 4, GeodesicOptions{});
    const auto [one, eight] = tests::on_one_and_eight_threads([&] {
        std::vector<double> gradient(problem.x.size());
        const double total = problem.energy.evaluate(problem.x, gradient).total;
        return std::pair(total, gradient);
    });
    EXPECT_EQ(one, eight);
}

TYPED_TEST(PathEnergyIn, WhatSinglePrecisionLetsPassDoesNotFoldInDoublePrecision) {
    // One step that squeezes the cube along the first axis, around the least det that is let pass.
    constexpr int dim = TypeParam::value;
    const int level = level_of(dim);
    PathEnergy<dim> energy(tests::ball<dim>(level, 0.2), tests::ball<dim>(level, 0.2), 1, GeodesicOptions{});
    const auto& layout = energy.layout();
    std::vector<double> x(layout.size(), 0.0);
    std::vector<float> gradient(layout.size());
    const double h = layout.grid.spacing();
    const int middle = layout.grid.cells(0) / 2;
    int passed = 0, refused_in_single = 0;
    for (int i = 0; i <= 60; ++i) {
        const double det = energy.least_det * (0.97 + 0.001 * i);
        for (std::size_t node = 0; node < layout.nodes(); ++node) {  // one column of cells, the others make room
            const int at = layout.grid.node(node)[0];
            const double share = at <= middle ? 1.0 * at / middle : 1.0 * (2 * middle - at) / (middle - 1);
            x[layout.displacement(1, 0) + node] = (at <= middle ? 0.5 : -0.5) * (1 - det) * h * share;
        }
        const bool single = std::isfinite(energy.evaluate_single(x, gradient).total);
        const bool twice = std::isfinite(energy.evaluate(x, {}).total);
        EXPECT_TRUE(twice || !single) << det;
        passed += single;
        refused_in_single += twice && !single;
    }
    EXPECT_GT(passed, 0);
    EXPECT_GT(refused_in_single, 0);
}

TYPED_TEST(PathEnergyIn, FoldedDeformationHasInfiniteEnergy) {
    constexpr int dim = TypeParam::value;
    tests::PathProblem<dim> problem(4, 2, GeodesicOptions{});
    for (auto& value : problem.x) value *= 30.0;
    EXPECT_EQ(problem.energy.evaluate(problem.x, {}).total, std::numeric_limits<double>::infinity());
}

TYPED_TEST(PathEnergyIn, LengthSquaredIsAtMostThePathEnergy) {
    constexpr int dim = TypeParam::value;
    tests::PathProblem<dim> problem(4, 4, GeodesicOptions{});
    const auto terms = problem.energy.evaluate(problem.x, {});
    EXPECT_GT(terms.path_length(), 0.0);
    EXPECT_LE(terms.path_length() * terms.path_length(), terms.path_energy() * (1 + 1e-12));
}

TYPED_TEST(PathEnergyIn, RefusesDifferentGrids) {
    constexpr int dim = TypeParam::value;
    EXPECT_THROW(PathEnergy<dim>(tests::ball<dim>(4, 0.2), tests::ball<dim>(5, 0.2), 2, GeodesicOptions{}),
                 std::invalid_argument);
}

TEST(AreaEnergy, CircleAndSphere) {
    // int |grad H_eps(u)| of a distance function tends to the length of the contour; the arctan's tails cost eps / r.
    const auto disk = tests::ball<2>(8, 0.3);
    const auto solid = tests::ball<3>(6, 0.3);
    const double length = area_energy<2>(disk.grid, disk.values.data(), disk.grid.spacing(), 1.0, nullptr);
    EXPECT_NEAR(length, 2 * std::numbers::pi * 0.3, 0.02 * length);
    const double area = area_energy<3>(solid.grid, solid.values.data(), solid.grid.spacing(), 1.0, nullptr);
    EXPECT_NEAR(area, 4 * std::numbers::pi * 0.09, 0.1 * area);
}

}  // namespace
}  // namespace morphodesic
