#pragma once

#include <cstddef>

namespace morphodesic::kernels {

/// Symmetric (2 Dim + 1)-point stencil on the nodes of a grid, in single precision, applied to `count` nodes in storage
/// order. Edge a of node i joins i and i + stride[a]; edges that would leave the grid have weight 0, and the inverse
/// diagonal is 0 on the boundary (Dirichlet), so one flat loop serves all nodes. Fields that are read at neighbours
/// must be readable stride[Dim - 1] entries beyond both ends.
template <int Dim>
struct Stencil {
    const float* edge[Dim];         ///< weight of the edge to the next node on each axis, >= 0
    const float* diagonal;          ///< sum of the edges at a node plus the mass term
    const float* inverse_diagonal;  ///< 1 / diagonal inside, 0 on the boundary
    std::ptrdiff_t stride[Dim];
};

/// out = x + omega D^-1 (b - A x): one damped Jacobi sweep. out must not alias x.
template <int Dim>
void jacobi_sweep(std::size_t count, const Stencil<Dim>& a, float omega, const float* b, const float* x, float* out);

/// out = b - A x.
template <int Dim>
void residual(std::size_t count, const Stencil<Dim>& a, const float* b, const float* x, float* out);

}  // namespace morphodesic::kernels
