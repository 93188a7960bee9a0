#pragma once

#include <cstddef>
#include <cstdint>

namespace morphodesic::kernels {

inline constexpr std::size_t place_lanes = 8;

/// Places in a grid, in units of h along each axis; [count], a multiple of place_lanes. Where Q1 functions are looked
/// up, places outside of the grid count as the nearest ones in it.
template <int Dim>
struct Places {
    std::size_t count;
    double* x[Dim];
};

/// Values of a Q1 function on a grid of so many cells. SIMD over the places, as everything here.
template <int Dim, class T>
void sample(const int (&cells)[Dim], const T* field, const Places<Dim>& places, double* values);

/// x + share w(x) = y, to be solved for x by damped fixed point iteration.
template <int Dim>
struct Inversion {
    int cells[Dim];
    const double* w[Dim];  ///< in units of the cube [nodes]
    int cells_per_unit;    ///< 1 / h
    double share;
    double near_enough;  ///< residual that is good enough, in units of h
    int iterations;      ///< at most
};

/// @param x  where the iteration starts, and the result
template <int Dim>
void invert(const Inversion<Dim>& problem, const Places<Dim>& y, const Places<Dim>& x);

/// First nodes of the cells that hold the places, and the places in these cells, in [0,1]; [places.count] each.
template <int Dim>
void locate(const int (&cells)[Dim], const Places<Dim>& places, std::uint32_t* node, float* const (&fraction)[Dim]);

}  // namespace morphodesic::kernels
