#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "geodesic/grid/fields.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/row_places.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class T>
class PlaceKernelIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PlaceKernelIn, Dimensions);

/// Places around the nodes of a row in the middle of a box of cells, some of them outside.
template <int Dim>
struct PlaceProblem {
    DyadicGrid<Dim> grid = [] {
        typename DyadicGrid<Dim>::Index cells;
        cells.fill(12);
        cells[0] = 16;
        return DyadicGrid<Dim>(4, cells);
    }();
    std::mt19937 random{7};
    std::size_t row =
        static_cast<std::size_t>(grid.nodes(0)) * (grid.node_count() / 2 / static_cast<std::size_t>(grid.nodes(0)));

    [[nodiscard]] std::vector<double> field(double size) {
        std::uniform_real_distribution<double> value(-size, size);
        std::vector<double> f(grid.node_count());
        std::generate(f.begin(), f.end(), [&] { return value(random); });
        return f;
    }
    [[nodiscard]] RowPlaces<Dim> places(double reach) {
        std::uniform_real_distribution<double> move(-reach, reach);
        RowPlaces<Dim> p(grid, row);
        for (std::size_t a = 0; a < Dim; ++a) {
            for (std::size_t i = 0; i < p.count(); ++i) p[a][i] += move(random);
        }
        return p;
    }
    /// In units of the cube.
    [[nodiscard]] Point<Dim> place(const RowPlaces<Dim>& p, std::size_t i) const {
        Point<Dim> x;
        for (std::size_t a = 0; a < Dim; ++a) x[a] = p[a][i] * grid.spacing();
        return x;
    }
};

TYPED_TEST(PlaceKernelIn, SamplesAreThoseOfTheQ1Function) {
    constexpr int Dim = TypeParam::value;
    tests::for_each_instruction_set([](const std::string&) {
        PlaceProblem<Dim> problem;
        const auto field = problem.field(1.0);
        const std::vector<float> single(field.begin(), field.end());
        const std::vector<double> rounded(single.begin(), single.end());
        auto places = problem.places(9.0);
        const std::vector<double> found(places.sample(field.data()), places.sample(field.data()) + places.count());
        const double* found_single = places.sample(single.data());
        for (std::size_t i = 0; i < places.count(); ++i) {
            const auto x = problem.place(places, i);
            EXPECT_NEAR(found[i], q1::value(problem.grid, field.data(), x), 1e-13);
            EXPECT_NEAR(found_single[i], q1::value(problem.grid, rounded.data(), x), 1e-13);
        }
    });
}

TYPED_TEST(PlaceKernelIn, PlacesAreFoundInACoarserGrid) {
    constexpr int Dim = TypeParam::value;
    tests::for_each_instruction_set([](const std::string&) {
        PlaceProblem<Dim> problem;
        const auto coarse = problem.grid.coarser();
        auto places = problem.places(5.0);
        for (std::size_t a = 0; a < Dim; ++a) {
            for (std::size_t i = 0; i < places.count(); ++i) places[a][i] *= 0.5;
        }
        std::vector<std::uint32_t> node(places.count() + 1, 77);
        std::array<std::vector<float>, Dim> fraction;
        std::array<float*, Dim> out;
        for (std::size_t a = 0; a < Dim; ++a) {
            fraction[a].resize(places.count());
            out[a] = fraction[a].data();
        }
        places.locate(coarse, node.data(), out);
        EXPECT_EQ(node.back(), 77U);  // nothing is written beyond the row
        for (std::size_t i = 0; i < places.count(); ++i) {
            Point<Dim> x;
            for (std::size_t a = 0; a < Dim; ++a) x[a] = places[a][i] * coarse.spacing();
            const auto expected = q1::locate(coarse, x);
            EXPECT_EQ(node[i], expected.node);
            for (std::size_t a = 0; a < Dim; ++a) EXPECT_NEAR(fraction[a][i], expected.fraction[a], 1e-6);
        }
    });
}

TYPED_TEST(PlaceKernelIn, InversesOfADeformationAreFound) {
    constexpr int Dim = TypeParam::value;
    tests::for_each_instruction_set([](const std::string&) {
        PlaceProblem<Dim> problem;
        std::array<std::vector<double>, Dim> w;
        std::array<const double*, Dim> view;
        for (std::size_t a = 0; a < Dim; ++a) {  // shears and squeezes cells, without folds
            w[a] = problem.field(0.2 * problem.grid.spacing());
            view[a] = w[a].data();
        }
        for (const double share : {0.5, 1.0}) {
            RowPlaces<Dim> y(problem.grid, problem.row), x = y;
            x.solve(y, view, problem.grid.cells_per_unit(), share, 1e-6, 200);
            for (std::size_t i = 0; i < x.count(); ++i) {
                for (std::size_t a = 0; a < Dim; ++a) {
                    const double moved = q1::value(problem.grid, view[a], problem.place(x, i));
                    EXPECT_NEAR(x[a][i] + share * moved * problem.grid.cells_per_unit(), y[a][i], 1e-6);
                }
            }
        }
    });
}

}  // namespace
}  // namespace morphodesic
