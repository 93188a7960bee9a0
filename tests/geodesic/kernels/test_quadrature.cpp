#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "geodesic/kernels/quadrature.h"

namespace morphodesic {
namespace {

template <class T>
class QuadratureIn : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(QuadratureIn, Dimensions);

constexpr auto rules = {kernels::Quadrature::few, kernels::Quadrature::many};

TYPED_TEST(QuadratureIn, ThirdOrderPolynomialsAreExact) {
    constexpr int dim = TypeParam::value;
    for (const auto rule : rules) {
        const auto points = kernels::quadrature_points<dim>(rule);
        std::array<int, 3> power{};
        for (power[0] = 0; power[0] <= 3; ++power[0]) {
            for (power[1] = 0; power[0] + power[1] <= 3; ++power[1]) {
                for (power[2] = 0; power[0] + power[1] + power[2] <= (dim == 3 ? 3 : power[0] + power[1]); ++power[2]) {
                    double sum = 0.0, exact = 1.0;
                    for (const auto& x : points) {
                        double value = 1.0;
                        for (std::size_t a = 0; a < dim; ++a) value *= std::pow(x[a], power[a]);
                        sum += value / static_cast<double>(points.size());
                    }
                    for (std::size_t a = 0; a < dim; ++a) exact /= power[a] + 1;
                    EXPECT_NEAR(sum, exact, 1e-14) << power[0] << power[1] << power[2];
                }
            }
        }
        for (const auto& x : points) {
            for (const double c : x) EXPECT_TRUE(c > 0 && c < 1) << c;
        }
    }
}

/// What quadrature over all cells leaves of waves that fit the grid, as in the comment of kernels::Quadrature.
template <int Dim>
double aliasing(const std::vector<std::array<double, Dim>>& points) {
    constexpr double rim = 0.35;
    constexpr int most = 4;
    double sum = 0.0;
    std::array<int, 3> g{};
    for (g[0] = -most; g[0] <= most; ++g[0]) {
        for (g[1] = -most; g[1] <= most; ++g[1]) {
            for (g[2] = Dim == 3 ? -most : 0; g[2] <= (Dim == 3 ? most : 0); ++g[2]) {
                const double length = std::hypot(g[0], g[1], g[2]), t = 2 * std::numbers::pi * rim * length;
                if (length == 0) continue;
                std::complex<double> wave = 0.0;
                for (const auto& x : points) {
                    double phase = 0.0;
                    for (std::size_t a = 0; a < Dim; ++a) phase += 2 * std::numbers::pi * g[a] * x[a];
                    wave += std::polar(1.0 / static_cast<double>(points.size()), phase);
                }
                sum += std::norm(wave * (1 + t) * std::exp(-t));
            }
        }
    }
    return std::sqrt(sum);
}

TYPED_TEST(QuadratureIn, ContoursHideLessThanFromGaussPoints) {
    constexpr int dim = TypeParam::value;
    std::vector<std::array<double, dim>> gauss;
    for (int q = 0; q < (1 << dim); ++q) {
        std::array<double, dim> x{};
        for (int a = 0; a < dim; ++a) x[static_cast<std::size_t>(a)] = 0.5 + ((q >> a & 1) - 0.5) / std::sqrt(3.0);
        gauss.push_back(x);
    }
    const auto left_by = [](kernels::Quadrature rule) {
        const auto points = kernels::quadrature_points<dim>(rule);
        return aliasing<dim>({points.begin(), points.end()});
    };
    EXPECT_NEAR(aliasing<dim>(gauss), dim == 2 ? 0.212 : 0.265, 1e-3);
    EXPECT_NEAR(left_by(kernels::Quadrature::few), dim == 2 ? 0.090 : 0.134, 1e-3);
    EXPECT_NEAR(left_by(kernels::Quadrature::many), dim == 2 ? 0.029 : 0.083, 1e-3);
}

}  // namespace
}  // namespace morphodesic
