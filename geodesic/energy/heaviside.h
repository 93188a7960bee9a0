#pragma once

#include <cmath>
#include <numbers>

namespace morphodesic {

/// H_eps(x) = 1/2 + arctan(x / eps) / pi, section 4 of [WBRS09].
inline double smooth_heaviside(double x, double eps) {
    return 0.5 + std::atan(x / eps) * std::numbers::inv_pi;
}

/// Its derivative delta_eps(x) = eps / (pi (eps^2 + x^2)).
inline double smooth_delta(double x, double eps) {
    return eps * std::numbers::inv_pi / (eps * eps + x * x);
}

}  // namespace morphodesic
