#pragma once

#include <cstddef>
#include <span>

namespace morphodesic::kernels {

/// Long vectors, in parallel over chunks of fixed length: the bits do not depend on the number of threads.
[[nodiscard]] double dot(std::span<const double> a, std::span<const double> b);
[[nodiscard]] double dot(std::span<const double> a, std::span<const float> b);
/// y += factor * x
void add_scaled(std::span<double> y, double factor, std::span<const float> x);
/// out = x + factor * d
void step(std::span<double> out, std::span<const double> x, double factor, std::span<const double> d);
/// out = a - b, rounded to single precision
void difference(std::span<float> out, std::span<const double> a, std::span<const double> b);
void scale(std::span<double> y, double factor);

/// Along one row of cells: flag[i] = 1 where the least det D phi at the corners of cell i falls below `keep` times what
/// it is, or times 1 where it is more, when the displacement w changes by d; 0 elsewhere.
/// @param w, d    one pointer per component, to the first node of the row
/// @param stride  distance of neighbours on each axis
template <int Dim>
void squeezed_cells(std::size_t cells, const double* const (&w)[Dim], const double* const (&d)[Dim],
                    const std::ptrdiff_t (&stride)[Dim], double inverse_h, double keep, unsigned char* flag);

}  // namespace morphodesic::kernels
