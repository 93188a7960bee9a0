#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <vector>

#include "geodesic/energy/end_stiffness.h"
#include "geodesic/energy/heaviside.h"
#include "geodesic/energy/path_energy.h"
#include "geodesic/energy/stored_energy_density.h"
#include "tests/support/path_problems.h"

namespace morphodesic {
namespace {

template <class Type>
class EndStiffness : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(EndStiffness, Dimensions);

/// phi = centre + (1 + a (1 - |y|^2 / r^2)^2) y for |y| < r, y = x - centre: what is inside grows.
constexpr double outer_radius = 0.45, growth = 0.2;
double factor(double square) {
    const double t = std::max(0.0, 1.0 - square / (outer_radius * outer_radius));
    return 1.0 + growth * t * t;
}

template <int Dim>
Deformation<Dim> growing(int level) {
    Deformation<Dim> phi{DyadicGrid<Dim>(level)};
    for (std::size_t i = 0; i < phi.grid().node_count(); ++i) {
        const auto x = phi.grid().position(phi.grid().node(i));
        double square = 0.0;
        for (const double c : x) square += (c - 0.5) * (c - 0.5);
        for (std::size_t a = 0; a < Dim; ++a) {
            phi.displacement.components[a][i] = (factor(square) - 1.0) * (x[a] - 0.5);
        }
    }
    return phi;
}

/// The integral in shells: the gradient is that of a radial map, u o phi that of a ball.
template <int Dim>
double exact_energy(double radius, const GeodesicOptions& options, double eps) {
    double sum = 0.0;
    const int shells = 20000;
    for (int i = 0; i < shells; ++i) {
        const double r = outer_radius * (i + 0.5) / shells, step = 1e-6;
        const double image = factor(r * r) * r;
        const double slope =
            (factor((r + step) * (r + step)) * (r + step) - factor((r - step) * (r - step)) * (r - step)) / (2 * step);
        std::array<double, Dim * Dim> b{};
        b[0] = slope - 1.0;
        for (int a = 1; a < Dim; ++a) b[static_cast<std::size_t>(a * Dim + a)] = image / r - 1.0;
        const double stiffness =
            (1 - options.outside_stiffness) * smooth_heaviside(radius - image, eps) + options.outside_stiffness;
        const double shell =
            (Dim == 2 ? 2 * std::numbers::pi * r : 4 * std::numbers::pi * r * r) * outer_radius / shells;
        sum += stiffness * stored_energy_density<Dim>(b, options.lambda, options.mu) * shell;
    }
    return sum;
}

TYPED_TEST(EndStiffness, WeighsAStepWithTheShapeThatItEndsWith) {
    constexpr int Dim = TypeParam::value;
    const int level = Dim == 2 ? 7 : 5;
    const GeodesicOptions options;
    const auto phi = growing<Dim>(level);
    const auto after = tests::ball<Dim>(level, 0.25);
    const double energy = end_deformation_energy(phi, after, options);
    const double exact = exact_energy<Dim>(0.25, options, options.rim_width * phi.grid().spacing());
    EXPECT_NEAR(energy, exact, (Dim == 2 ? 2e-3 : 3e-2) * exact);

    // Where the shape before was a dot, the step began with next to nothing to deform.
    PathEnergy<Dim> begin(tests::ball<Dim>(level, 0.05), after, 1, options);
    std::vector<double> x;
    for (const auto& component : phi.displacement.components) x.insert(x.end(), component.begin(), component.end());
    EXPECT_LT(begin.evaluate(x, {}).deformation.front(), 0.3 * energy);
}

TYPED_TEST(EndStiffness, IsInfiniteWhereTheStepFolds) {
    constexpr int Dim = TypeParam::value;
    auto phi = growing<Dim>(4);
    for (double& w : phi.displacement.components[0]) w *= -40.0;
    EXPECT_EQ(end_deformation_energy(phi, tests::ball<Dim>(4, 0.25), GeodesicOptions{}),
              std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace morphodesic
