#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <span>
#include <vector>

#include "geodesic/energy/stretched_cells.h"
#include "geodesic/grid/q1_element.h"
#include "tests/support/mismatch_by_points.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

/// One time step: from the background to a ball with holes and bits around it, by the stretch of a few cells.
template <int Dim>
struct StretchedStep {
    static constexpr int level = Dim == 2 ? 5 : 4;
    DyadicGrid<Dim> grid{level};
    std::size_t nodes = grid.node_count();
    std::vector<double> x;  // displacements, u_{k-1}, u_k
    ScalarField<Dim> mask{grid};
    kernels::StepWeights weights{};

    /// @param factor     stretch of the middle of every axis
    /// @param noise      of the displacements, in units of h
    /// @param roughness  noise of u_k, in units of h
    explicit StretchedStep(double factor, double noise = 0.0, double roughness = 1.5) : x((Dim + 2) * nodes) {
        weights.level = level;
        weights.eps = 0.5 * grid.spacing();
        weights.mismatch = 7.0;
        weights.quadrature = kernels::Quadrature::many;
        const auto from = tests::ball<Dim>(level, -0.1), to = tests::ball<Dim>(level, 0.22);
        const double half = 2.0 * grid.spacing(), rest = (0.5 - factor * half) / (0.5 - half);
        std::mt19937 random(3);
        std::uniform_real_distribution<double> any(-noise, noise), rough(-roughness, roughness);
        for (std::size_t i = 0; i < nodes; ++i) {
            const auto at = grid.position(grid.node(i));
            for (std::size_t a = 0; a < Dim; ++a) {
                const double t = at[a] - 0.5, middle = std::clamp(t, -half, half);
                x[a * nodes + i] = (factor - 1) * middle + (rest - 1) * (t - middle) + 1e-3 * at[a];
                if (!grid.on_boundary(grid.node(i))) x[a * nodes + i] += any(random) * grid.spacing();
            }
            x[Dim * nodes + i] = from.values[i];
            x[(Dim + 1) * nodes + i] = to.values[i] - 0.15 + rough(random) * grid.spacing();
            mask.values[i] = at[0];
        }
    }

    template <class T>
    double difference(const std::vector<T>& fields, std::vector<T>& gradient, bool masked = false, int begin = 0,
                      int end = 1 << level) const {
        const std::vector<T> chi(mask.values.begin(), mask.values.end());
        kernels::StepFields<Dim, T> f{};
        kernels::StepGradients<Dim, T> g{};
        for (std::size_t a = 0; a < Dim; ++a) {
            f.cells[a] = grid.cells(static_cast<int>(a));
            f.displacement[a] = fields.data() + a * nodes;
            if (!gradient.empty()) g.displacement[a] = gradient.data() + a * nodes;
        }
        f.u_previous = fields.data() + Dim * nodes;
        f.u_next = f.u_previous + nodes;
        f.mask = masked ? chi.data() : nullptr;
        f.u_next_last_row = grid.cells(Dim - 1);
        if (!gradient.empty()) {
            g.u_previous = gradient.data() + Dim * nodes;
            g.u_next = g.u_previous + nodes;
        }
        return stretched_mismatch<Dim, T>(grid, begin, end, f, weights, g);
    }

    double difference() const {
        std::vector<double> none;
        return difference(x, none);
    }

    /// The mismatch of a cell by the given points of the unit cell.
    double mismatch(std::size_t node, std::span<const Point<Dim>> points) const {
        std::array<const double*, Dim> w;
        for (std::size_t a = 0; a < Dim; ++a) w[a] = x.data() + a * nodes;
        const double* from = x.data() + Dim * nodes;
        return tests::mismatch_by_points<Dim>(grid, node, points, w, from, from + nodes, weights.eps);
    }

    /// Length of the longest edge of a cell after the step, in units of h.
    double stretch(std::size_t node) const {
        const auto corners = q1::corner_offsets(grid);
        double longest = 0.0;
        for (std::size_t c = 0; c < corners.size(); ++c) {
            for (std::size_t axis = 0; axis < Dim; ++axis) {
                if ((c >> axis) & 1) continue;
                const std::size_t one = node + corners[c], other = node + corners[c | (std::size_t{1} << axis)];
                double square = 0.0;
                for (std::size_t a = 0; a < Dim; ++a) {
                    const double e = (x[a * nodes + other] - x[a * nodes + one]) / grid.spacing() + (a == axis ? 1 : 0);
                    square += e * e;
                }
                longest = std::max(longest, std::sqrt(square));
            }
        }
        return longest;
    }
};

template <class T>
class StretchedCellsIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(StretchedCellsIn, Dimensions);

TYPED_TEST(StretchedCellsIn, TheDifferenceIsWhatTheRuleOverlooks) {
    constexpr int dim = TypeParam::value;
    const auto dense = tests::midpoints<dim>(dim == 2 ? 60 : 9);
    for (const double noise : {0.0, 0.15}) {
        const StretchedStep<dim> step(5.0, noise);
        std::vector<double> expected(static_cast<std::size_t>(step.grid.cells(0)));
        q1::for_each_cell(step.grid, [&](std::size_t node) {
            const double s = step.stretch(node);
            if (s <= 2.0) return;
            const double t = std::min(1.0, (s * s - 4.0) / (9.0 - 4.0));
            const double rule = step.mismatch(node, kernels::quadrature_points<dim>(kernels::Quadrature::many));
            expected[static_cast<std::size_t>(step.grid.node(node)[dim - 1])] +=
                t * t * (3 - 2 * t) * (step.mismatch(node, dense) - rule);
        });
        double size = 0.0, off = 0.0;
        std::vector<double> none;
        for (int row = 0; row < step.grid.cells(0); ++row) {
            const double wanted = expected[static_cast<std::size_t>(row)];
            size += std::abs(wanted);
            off += std::abs(step.difference(step.x, none, false, row, row + 1) - wanted);
        }
        ASSERT_GT(size, 1e-6) << "no case of what is tested";
        EXPECT_LT(off, 0.25 * size) << noise;
    }
}

TYPED_TEST(StretchedCellsIn, CellsThatKeepTheirSizeStayAsTheyAre) {
    constexpr int dim = TypeParam::value;
    const StretchedStep<dim> step(1.95);
    std::vector<double> gradient(step.x.size());
    EXPECT_EQ(step.difference(step.x, gradient), 0.0);
    EXPECT_EQ(std::count(gradient.begin(), gradient.end(), 0.0), static_cast<std::ptrdiff_t>(gradient.size()));
    // With fewer points cells count earlier.
    auto few = step;
    few.weights.quadrature = kernels::Quadrature::few;
    EXPECT_NE(few.difference(), 0.0);
    // Nothing jumps where the difference begins to count.
    const StretchedStep<dim> more(2.04);
    EXPECT_LT(std::abs(more.difference()), 0.02 * std::abs(StretchedStep<dim>(3.5).difference()));
}

TYPED_TEST(StretchedCellsIn, GradientsPassTaylorTests) {
    constexpr int dim = TypeParam::value;
    for (const double factor : {2.4, 4.0}) {  // where the difference counts in part, and in whole
        for (int part = 0; part < 3; ++part) {
            const StretchedStep<dim> step(factor, 0.02, 0.3);
            std::vector<double> direction(step.x.size());
            for (std::size_t i = 0; i < step.nodes; ++i) {
                const auto at = step.grid.position(step.grid.node(i));
                for (int field = 0; field < dim + 2; ++field) {
                    if (std::max(0, field - dim + 1) != part) continue;
                    direction[static_cast<std::size_t>(field) * step.nodes + i] = tests::smooth_wave<dim>(at, field, 2);
                }
            }
            std::vector<double> gradient(step.x.size());
            step.difference(step.x, gradient, true);
            const auto energy = [&](const std::vector<double>& x) {
                std::vector<double> none;
                return step.weights.mismatch * step.difference(x, none, true);
            };
            EXPECT_GT(std::abs(std::inner_product(gradient.begin(), gradient.end(), direction.begin(), 0.0)), 1e-6);
            EXPECT_GT(tests::taylor_order(energy, gradient, step.x, direction, 0.004 * step.grid.spacing()), 1.8)
                << factor << " part " << part;
        }
    }
}

TYPED_TEST(StretchedCellsIn, SinglePrecisionAgrees) {
    constexpr int dim = TypeParam::value;
    const StretchedStep<dim> step(4.0, 0.1);
    std::vector<double> gradient(step.x.size());
    const double expected = step.difference(step.x, gradient, true);
    const std::vector<float> single(step.x.begin(), step.x.end());
    std::vector<float> single_gradient(single.size());
    EXPECT_NEAR(step.difference(single, single_gradient, true), expected, 1e-5 * std::abs(expected));
    double most = 0.0, worst = 0.0;
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        most = std::max(most, std::abs(gradient[i]));
        worst = std::max(worst, std::abs(gradient[i] - static_cast<double>(single_gradient[i])));
    }
    EXPECT_LT(worst, 1e-4 * most);
}

}  // namespace
}  // namespace morphodesic
