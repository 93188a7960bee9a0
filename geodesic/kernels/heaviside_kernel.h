#pragma once

#include <span>

namespace morphodesic::kernels {

/// out[i] = H_eps(u[i]) = 1/2 + arctan(u[i] / eps) / pi, see energy/heaviside.h, for many values at once. SIMD, good to
/// 1e-15; the bits depend on the instruction set and not on the place in the span. Spans of the same length; out may be
/// u.
void smooth_heaviside(std::span<const double> u, double eps, std::span<double> out);

}  // namespace morphodesic::kernels
