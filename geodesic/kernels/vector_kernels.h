#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace morphodesic::kernels {

/// A float of which the upper half is kept (8 bits of mantissa, "bfloat16"), rounded to nearest: half of the memory to
/// be read where long vectors wait for it.
struct HalfFloat {
    std::uint16_t bits = 0;

    HalfFloat() = default;
    explicit HalfFloat(float value) {
        const auto all = std::bit_cast<std::uint32_t>(value);
        bits = static_cast<std::uint16_t>((all + 0x7FFFU + ((all >> 16) & 1U)) >> 16);
    }
    [[nodiscard]] float value() const { return std::bit_cast<float>(static_cast<std::uint32_t>(bits) << 16); }
};

/// Long vectors, in parallel over chunks of fixed length: the bits do not depend on the number of threads. Products are
/// summed in double precision, those with half floats in single precision within a chunk.
[[nodiscard]] double dot(std::span<const float> a, std::span<const float> b);
/// result[j] = a . b_j, reading a once
void dots(std::span<const float> a, std::span<const std::span<const HalfFloat>> b, std::span<double> result);
/// out = factor * a + sum_j factors[j] b_j; out may be a
void combine(std::span<float> out, float factor, std::span<const float> a, std::span<const double> factors,
             std::span<const std::span<const HalfFloat>> b);
/// out = x + factor * d
void step(std::span<double> out, std::span<const double> x, double factor, std::span<const float> d);
/// s = x - x0, y = g - g0, rounded. @return s . y of the rounded ones
[[nodiscard]] double differences(std::span<HalfFloat> s, std::span<const double> x, std::span<const double> x0,
                                 std::span<HalfFloat> y, std::span<const float> g, std::span<const float> g0);

/// Distance of neighbouring nodes in memory, on each axis.
template <int Dim>
using Strides = std::array<std::ptrdiff_t, Dim>;

/// Along one row of cells: flag[i] = 1 where the least det D phi at the corners of cell i falls below `keep` times what
/// it is, or times 1 where it is more, when the displacement w changes by d; 0 elsewhere. @return whether there is any
/// @param w, d  one pointer per component, to the first node of the row
template <int Dim>
bool squeezed_cells(std::size_t cells, const double* const (&w)[Dim], const float* const (&d)[Dim],
                    const Strides<Dim>& stride, double inverse_h, double keep, unsigned char* flag);

/// Along one row of cells: flag[i] = 1 where the values of u at the corners of cell i have both signs and differ by
/// more than `limit`; 0 elsewhere. @return whether there is any
/// @param u  from the first node of the row on
template <int Dim>
bool steep_cells(std::size_t cells, const double* u, const Strides<Dim>& stride, double limit, unsigned char* flag);

/// Along one row of cells: flag[i] = 1 where an edge of cell i is longer than `limit` times what it was when the
/// displacement w moves its ends; 0 elsewhere. @return whether there is any
/// @param w  one pointer per component, to the first node of the row
template <int Dim, class T>
bool stretched_cells(std::size_t cells, const T* const (&w)[Dim], const Strides<Dim>& stride, double inverse_h,
                     double limit, unsigned char* flag);

}  // namespace morphodesic::kernels
