#pragma once

#include <array>
#include <cstddef>

namespace morphodesic::kernels {

/// Entries of a symmetric Dim x Dim matrix, row by row from the diagonal on: xx, xy, yy; xx, xy, xz, yy, yz, zz.
template <int Dim>
inline constexpr int symmetric_entries = Dim*(Dim + 1) / 2;

/// Place of entry (i, j) in that order.
template <int Dim>
constexpr int symmetric_entry(int i, int j) {
    const int low = i < j ? i : j, high = i < j ? j : i;
    return low * Dim - low * (low - 1) / 2 + high - low;
}

/// Operator on vector fields (v_a at node i) on a grid of n nodes:
///   (A v)_a = diagonal v_a - sum over axes (edge[i] v_a[i + stride] + edge[i - stride] v_a[i - stride])
///             + sum_b mass_ab v_b,
/// the (2 Dim + 1)-point stencil for each component, coupled by a symmetric matrix at each node. All arrays are in
/// single precision; edges and fields are padded so that i - stride and i + stride can be read for every node i.
template <int Dim>
struct Stencil {
    const float* edge[Dim];
    std::ptrdiff_t stride[Dim];
    const float* diagonal;                               ///< sum of the edges [n]
    const float* mass[symmetric_entries<Dim>];           ///< [n] each
    const float* block_inverse[symmetric_entries<Dim>];  ///< (diagonal I + mass)^-1 [n] each; 0 on the boundary
};

template <int Dim>
using VectorIn = std::array<const float*, Dim>;
template <int Dim>
using VectorOut = std::array<float*, Dim>;

/// One sweep of damped block Jacobi: out = x + omega block_inverse (b - A x), for n nodes.
template <int Dim>
void jacobi_sweep(std::size_t n, const Stencil<Dim>& a, float omega, const VectorIn<Dim>& b, const VectorIn<Dim>& x,
                  const VectorOut<Dim>& out);

/// The same from x = 0, which is not read: out = omega block_inverse b.
template <int Dim>
void first_sweep(std::size_t n, const Stencil<Dim>& a, float omega, const VectorIn<Dim>& b, const VectorOut<Dim>& out);

/// out = b - A x, for n nodes.
template <int Dim>
void residual(std::size_t n, const Stencil<Dim>& a, const VectorIn<Dim>& b, const VectorIn<Dim>& x,
              const VectorOut<Dim>& out);

}  // namespace morphodesic::kernels
