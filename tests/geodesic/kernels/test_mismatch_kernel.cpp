#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/mismatch_points.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class T>
class MismatchKernelIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(MismatchKernelIn, Dimensions);

/// Every point near one of the contours is visited once, with the values of the fields there, and no point far from
/// both.
TYPED_TEST(MismatchKernelIn, PointsNearContoursAreVisitedOnceWithWhatIsThere) {
    constexpr int Dim = TypeParam::value;
    tests::for_each_instruction_set([](const std::string&) {
        tests::PathProblem<Dim> problem(Dim == 2 ? 6 : 4, 2, GeodesicOptions{});
        const auto& grid = problem.energy.layout().grid;
        const double eps = 0.25 * grid.spacing();
        const double *from = problem.energy.level_set(problem.x, 1), *to = problem.energy.level_set(problem.x, 2);
        DisplacementView<Dim> w;
        for (int a = 0; a < Dim; ++a)
            w[static_cast<std::size_t>(a)] = problem.x.data() + problem.energy.layout().displacement(2, a);
        const auto points = mismatch_points<Dim>(kernels::Quadrature::many);
        std::map<std::pair<std::size_t, Point<Dim>>, MismatchPoint<Dim>> visited;
        std::size_t visits = 0;
        for_each_mismatch_point<Dim>(grid, points, from, to, w, eps, [&](const MismatchPoint<Dim>& p) {
            visited[{p.node, p.fraction}] = p;
            ++visits;
        });
        EXPECT_EQ(visits, visited.size());
        EXPECT_LT(visits, grid.cell_count() * points.size() / 2);
        std::size_t near = 0;
        q1::for_each_cell(grid, [&](std::size_t node) {
            for (const auto& point : points) {
                Point<Dim> x = grid.position(grid.node(node)), y;
                for (std::size_t a = 0; a < Dim; ++a) x[a] += point[a] * grid.spacing();
                for (std::size_t a = 0; a < Dim; ++a) y[a] = x[a] + q1::value(grid, w[a], x);
                const double before = q1::value(grid, from, x), after = q1::value(grid, to, y);
                const auto found = visited.find({node, point});
                if (std::min(std::abs(before), std::abs(after)) < 6.0 * eps) {
                    ++near;
                    ASSERT_NE(found, visited.end());
                }
                if (found == visited.end()) continue;
                const auto& p = found->second;
                const auto target = q1::locate(grid, y);
                EXPECT_NEAR(p.here, smooth_delta(before, eps), 1e-10 / eps);
                EXPECT_NEAR(p.there, smooth_delta(after, eps), 1e-10 / eps);
                double steep_to = 1.0;
                for (std::size_t a = 0; a < Dim; ++a) {
                    EXPECT_EQ(p.target.node, target.node);
                    EXPECT_NEAR(p.target.fraction[a], target.fraction[a], 1e-10);
                    double slope = 0.0;
                    for (std::size_t c = 0; c < (1 << Dim); ++c) {
                        const double v = to[target.node + q1::corner_offsets(grid)[c]];
                        slope += q1::shape_slope<Dim>(static_cast<int>(c), target.fraction, static_cast<int>(a)) * v;
                        EXPECT_EQ(p.displacement[a][c], w[a][node + q1::corner_offsets(grid)[c]]);
                    }
                    EXPECT_NEAR(p.slope[a], slope * grid.cells_per_unit(), 1e-8);
                    steep_to = std::max(steep_to, std::abs(p.slope[a]));
                }
                // Level sets of shapes between are steeper than distances by little here.
                EXPECT_LT(std::min(std::abs(before) / 2.0, std::abs(after) / steep_to), 6.0 * eps * (1.0 + 1e-9));
            }
        });
        EXPECT_GT(near, 20U);
        EXPECT_GE(visits, near);
    });
}

}  // namespace
}  // namespace morphodesic
