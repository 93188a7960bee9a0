// What elasticity makes of moves of material, against the sums over the nodes of every frame that it stands for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geodesic/solver/move_elasticity.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <int Dim>
struct Problem {
    DyadicGrid<Dim> grid{Dim == 2 ? 6 : 4};
    DyadicGrid<Dim> coarse = grid.coarser();
    PathLayout<Dim> layout{grid, 2};
    PathEnergy<Dim> energy;
    std::vector<double> x;
    Trajectories<Dim> trajectories{layout, coarse};
    std::vector<std::vector<float>> weights{2, std::vector<float>(grid.node_count(), 3.0F)};

    Problem()
        : energy(tests::ball<Dim>(grid.level(), 0.3), tests::ball<Dim>(grid.level(), 0.3), 2, GeodesicOptions{}),
          x(layout.size(), 0.0) {}

    MoveElasticity<Dim> elasticity() {
        trajectories.update(energy, x);
        return {trajectories, grid, coarse, weights};
    }

    /// Displacement of phi_1 along axis 0: `slide` of the last coordinate, fading out towards the faces of the cube.
    void set_displacement(const auto& slide) {
        for (std::size_t i = 0; i < grid.node_count(); ++i) {
            const auto p = grid.position(grid.node(i));
            double fade = 1.0;
            for (double c : p) fade *= std::min(1.0, 4.0 * std::min(c, 1.0 - c));
            x[layout.displacement(1, 0) + i] = fade * slide(p[Dim - 1]);
        }
    }

    [[nodiscard]] std::size_t middle_of_coarse() const {
        typename DyadicGrid<Dim>::Index node;
        node.fill(coarse.cells(0) / 2);
        return coarse.index(node);
    }
};

template <class T>
class MoveElasticityIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(MoveElasticityIn, Dimensions);

TYPED_TEST(MoveElasticityIn, OfAPathThatStandsStillIsThatOfItsSteps) {
    Problem<TypeParam::value> problem;
    const auto found = problem.elasticity();
    for (float stiffness : found.stiffness) EXPECT_NEAR(stiffness, 3.0F, 1e-4F);
    for (const auto& entry : found.masses) {
        EXPECT_TRUE(std::all_of(entry.begin(), entry.end(), [](float m) { return m == 0.0F; }));
    }
}

TYPED_TEST(MoveElasticityIn, GrowsWithTheShearOfThePath) {
    constexpr int Dim = TypeParam::value;
    Problem<Dim> problem;
    constexpr double shear = 0.6;
    problem.set_displacement([](double z) { return shear * (z - 0.5); });
    const auto found = problem.elasticity();
    // |A|^2 = |A^-1|^2 = Dim + shear^2; both steps have it, the first behind and the second before its shape.
    const double expected = 3.0 * std::pow((Dim + shear * shear) / Dim, 2);
    const std::size_t i = problem.middle_of_coarse();
    EXPECT_NEAR(found.stiffness[i], expected, 0.02 * expected);
    for (const auto& entry : found.masses) EXPECT_NEAR(entry[i], 0.0F, 1e-3F);
}

TYPED_TEST(MoveElasticityIn, HoldsMovesBackWhereTheMaterialSlides) {
    constexpr int Dim = TypeParam::value;
    Problem<Dim> problem;
    const double h = problem.grid.spacing();
    // Two blocks slide along each other within some two cells.
    problem.set_displacement([&](double z) { return 0.6 * h * std::tanh((z - 0.5) / h); });
    const auto found = problem.elasticity();
    // Along the slide, a move across it has A v = v + shear v_z: what a constant v across it costs, summed at the nodes
    // of both steps (their A is the same, that of frame 1).
    const auto& a = problem.trajectories.frame(0).a[Dim - 1];
    double across = 0.0;
    typename DyadicGrid<Dim>::Index node;
    node.fill(problem.grid.cells(0) / 2);
    for (int z = problem.grid.cells(0) / 4; z < problem.grid.cells(0) * 3 / 4; ++z) {
        node[Dim - 1] = z;
        const std::size_t i = problem.grid.index(node);
        const double jump = static_cast<double>(a[i + problem.grid.stride(Dim - 1)] - a[i]);
        across += 3.0 * jump * jump;
    }
    constexpr auto cross = static_cast<std::size_t>(kernels::symmetric_entry<Dim>(Dim - 1, Dim - 1));
    constexpr auto along = static_cast<std::size_t>(kernels::symmetric_entry<Dim>(0, 0));
    double found_across = 0.0, found_along = 0.0;
    node.fill(problem.coarse.cells(0) / 2);
    for (int z = problem.coarse.cells(0) / 4; z <= problem.coarse.cells(0) * 3 / 4; ++z) {
        node[Dim - 1] = z;
        found_across += static_cast<double>(found.masses[cross][problem.coarse.index(node)]);
        found_along += static_cast<double>(found.masses[along][problem.coarse.index(node)]);
    }
    // A coarse node stands for 2^(Dim - 1) nodes of its column; half of the jumps is counted.
    const double expected = 0.5 * std::pow(2.0, Dim - 1) * std::pow(h, Dim - 2) * across;
    EXPECT_GT(across, 0.3);
    EXPECT_NEAR(found_across, expected, 0.1 * expected);
    EXPECT_NEAR(found_along, 0.0, 0.02 * expected);
}

}  // namespace
}  // namespace morphodesic
