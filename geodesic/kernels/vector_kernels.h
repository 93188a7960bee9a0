#pragma once

#include <cstddef>
#include <span>

namespace morphodesic::kernels {

/// Long vectors, in parallel over chunks of fixed length: the bits do not depend on the number of threads. Products are
/// summed in double precision.
[[nodiscard]] double dot(std::span<const float> a, std::span<const float> b);
/// result[j] = a . b_j, reading a once
void dots(std::span<const float> a, std::span<const std::span<const float>> b, std::span<double> result);
/// out = factor * a + sum_j factors[j] b_j; out may be a
void combine(std::span<float> out, float factor, std::span<const float> a, std::span<const double> factors,
             std::span<const std::span<const float>> b);
/// out = x + factor * d
void step(std::span<double> out, std::span<const double> x, double factor, std::span<const float> d);
/// s = x - x0, y = g - g0, rounded to single precision. @return s . y
[[nodiscard]] double differences(std::span<float> s, std::span<const double> x, std::span<const double> x0,
                                 std::span<float> y, std::span<const float> g, std::span<const float> g0);

/// Along one row of cells: flag[i] = 1 where the least det D phi at the corners of cell i falls below `keep` times what
/// it is, or times 1 where it is more, when the displacement w changes by d; 0 elsewhere.
/// @param w, d    one pointer per component, to the first node of the row
/// @param stride  distance of neighbours on each axis
template <int Dim>
void squeezed_cells(std::size_t cells, const double* const (&w)[Dim], const float* const (&d)[Dim],
                    const std::ptrdiff_t (&stride)[Dim], double inverse_h, double keep, unsigned char* flag);

}  // namespace morphodesic::kernels
