#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace morphodesic::kernels {

/// A row of cells along axis 0 in the time step u_{k-1} = from, u_k = to, phi = id + w. Fields [nodes of the grid].
template <int Dim>
struct MismatchRow {
    int cells[Dim];      ///< of the grid; on axis 0 a multiple of 8
    int low[Dim];        ///< the first cell of the row
    int cells_per_unit;  ///< 1 / h
    double eps;          ///< width of H_eps
    const double *from, *to, *w[Dim];
};

/// What is found at the points of the cells of a row: [points][cells].
template <int Dim>
struct MismatchRowPoints {
    std::vector<unsigned char> near;    ///< 1: close to a contour; else nothing is said of the point
    std::vector<std::int64_t> node;     ///< first node of the cell that holds the deformed point
    std::vector<double> fraction[Dim];  ///< its place in that cell
    std::vector<double> here, there;    ///< delta_eps of u_{k-1} at the point and of u_k at the deformed point
    std::vector<double> slope[Dim];     ///< grad u_k at the deformed point

    void resize(std::size_t points);
};

/// Looks at `points` of the unit cell in every cell of the row, and marks those that are closer than 6 eps to a contour
/// of u_{k-1}, or that are moved so close to one of u_k; elsewhere delta_eps^2 |grad u|^2 is below 1e-3 of its largest
/// value. SIMD over the cells.
/// @return whether there is any
template <int Dim>
bool mismatch_points_of(const MismatchRow<Dim>& row, std::span<const std::array<double, Dim>> points,
                        MismatchRowPoints<Dim>& found);

}  // namespace morphodesic::kernels
