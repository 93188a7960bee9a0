#pragma once

#include <cstddef>

namespace morphodesic::kernels {

/// One cell of a time step, and the u_k it is moved into.
template <int Dim, class T>
struct SampledCell {
    int cells[Dim];                     ///< of the grid
    int low[Dim];                       ///< its place in the grid
    int first[Dim], last[Dim];          ///< nodes of u_k that points may lie between
    double w[Dim][1 << Dim];            ///< phi_k - id at the corners, in units of h
    double u[1 << Dim], chi[1 << Dim];  ///< u_{k-1} and the mask there
    double eps;                         ///< width of H_eps
    const T* u_next;                    ///< u_k [nodes of the grid]
    std::size_t begin;                  ///< node that the gradient in u_k starts with
};

/// Points of the unit cell, and what each counts; [count], a multiple of sample_lanes.
template <int Dim>
struct SamplePoints {
    std::size_t count;
    const double *x[Dim], *factor;
};
inline constexpr std::size_t sample_lanes = 8;

/// The sum over the points, and its gradient at the corners of the cell.
template <int Dim>
struct SampledSums {
    double mismatch = 0.0;
    double w[Dim][1 << Dim] = {}, u[1 << Dim] = {};
};

/// Sum of factor chi (H_eps(u_k o phi_k) - H_eps(u_{k-1}))^2 over the points, the integrand of (12). SIMD over points.
/// @param gradient  whether the gradient is wanted
/// @param u_next    `scale` times that in u_k is added here [nodes from cell.begin on]; may be null
template <int Dim, class T>
SampledSums<Dim> sampled_mismatch(const SampledCell<Dim, T>& cell, const SamplePoints<Dim>& points, bool gradient,
                                  double scale, T* u_next);

}  // namespace morphodesic::kernels
