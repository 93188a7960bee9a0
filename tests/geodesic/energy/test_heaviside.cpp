#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geodesic/energy/heaviside.h"
#include "geodesic/kernels/heaviside_kernel.h"

namespace morphodesic::tests {
namespace {

TEST(Heaviside, OfManyValuesIsThatOfEachOne) {
    const double eps = 0.0078125;
    std::vector<double> all;
    for (const double size : {0.0, 1e-300, 1e-9, 0.003, 0.0078125, 0.008, 0.1, 1.5, 1e6, 1e300}) {
        all.push_back(size);
        all.push_back(-size);
    }
    for (std::size_t n = 0; n <= all.size(); ++n) {  // every length of the rest after full vectors
        std::vector<double> u(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(n)), h(n);
        kernels::smooth_heaviside(u, eps, h);
        for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(h[i], smooth_heaviside(u[i], eps), 1e-15) << u[i];
        kernels::smooth_heaviside(u, eps, u);
        EXPECT_EQ(u, h);
    }
}

TEST(Heaviside, DoesNotDependOnThePlace) {
    const std::vector<double> u(23, 0.0041);
    std::vector<double> h(u.size());
    kernels::smooth_heaviside(u, 0.01, h);
    for (const double value : h) EXPECT_EQ(value, h[0]);
}

TEST(Heaviside, DeltaIsItsDerivative) {
    const double eps = 0.01, step = 1e-6;
    for (const double u : {-0.2, -0.01, 0.0, 0.003, 0.05}) {
        const double slope = (smooth_heaviside(u + step, eps) - smooth_heaviside(u - step, eps)) / (2 * step);
        EXPECT_NEAR(slope, smooth_delta(u, eps), 1e-6 * smooth_delta(0.0, eps));
    }
}

}  // namespace
}  // namespace morphodesic::tests
