#pragma once

#include <array>
#include <cmath>
#include <limits>

namespace morphodesic {

/// Stored energy density, isotropic, polyconvex, zero at rotations, from the displacement gradient B = A - I
/// (row-major):
///   W(A) = mu/2 |A|^2 + lambda/4 det(A)^2 - (mu + lambda/2) log det A - Dim mu/2 - lambda/4,
/// written so that nothing cancels near the identity. Its second-order part there is the dissipation rate (1).
/// @return W >= 0; +infinity where det A <= 0
/// Source: (2) of [WBRS09] and its section 2; the kernels compute the same in SIMD.
template <int Dim>
double stored_energy_density(const std::array<double, Dim * Dim>& b, double lambda, double mu) {
    const auto at = [&](int i, int j) { return b[static_cast<std::size_t>(i * Dim + j)]; };
    double trace = 0.0, square = 0.0, higher = 0.0;  // det A = 1 + trace + higher
    for (int i = 0; i < Dim; ++i) trace += at(i, i);
    for (const double x : b) square += x * x;
    if constexpr (Dim == 2) {
        higher = at(0, 0) * at(1, 1) - at(0, 1) * at(1, 0);
    } else {
        for (int i = 0; i < 3; ++i) {
            for (int j = i + 1; j < 3; ++j) higher += at(i, i) * at(j, j) - at(i, j) * at(j, i);
        }
        higher += at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
                  at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                  at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
    }
    const double d = trace + higher;
    if (!(d > -1.0)) return std::numeric_limits<double>::infinity();
    // d - log(1 + d), by its series where the difference would cancel.
    double rest = d - std::log1p(d);
    if (std::abs(d) < 0.01) {
        rest = 0.0;
        for (int n = 9; n >= 2; --n) rest = 1.0 / n - d * rest;
        rest *= d * d;
    }
    return mu * (0.5 * square - higher) + 0.25 * lambda * d * d + (mu + 0.5 * lambda) * rest;
}

/// Local rate of dissipation (1) of a velocity with gradient B: lambda/2 (tr eps)^2 + mu |eps|^2, eps = (B + B^T) / 2.
template <int Dim>
double dissipation_rate(const std::array<double, Dim * Dim>& b, double lambda, double mu) {
    double trace = 0.0, square = 0.0;
    for (int i = 0; i < Dim; ++i) {
        trace += b[static_cast<std::size_t>(i * Dim + i)];
        for (int j = 0; j < Dim; ++j) {
            const double e =
                0.5 * (b[static_cast<std::size_t>(i * Dim + j)] + b[static_cast<std::size_t>(j * Dim + i)]);
            square += e * e;
        }
    }
    return 0.5 * lambda * trace * trace + mu * square;
}

}  // namespace morphodesic
