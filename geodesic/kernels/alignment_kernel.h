#pragma once

#include <cstddef>

namespace morphodesic::kernels {

/// Unknowns of a small motion: angles, then translation.
template <int Dim>
inline constexpr int motion_unknowns = Dim == 2 ? 3 : 6;

/// A row of nodes x of the second shape, and where they lie in the first one before its motion.
template <int Dim>
struct AlignmentRow {
    int cells[Dim];             ///< of the grid of `field`, per axis
    const double* field;        ///< level set of the first shape, [nodes], axis 0 fastest
    const double* target;       ///< H_eps of the second shape at the nodes of the row, [count]
    std::size_t count;          ///< nodes
    double first[Dim];          ///< place of the first node in the first shape, in cells
    double step[Dim];           ///< from node to node, in cells
    double rotation[Dim][Dim];  ///< of the motion
    double from_centre[Dim];    ///< the first node, seen from the moved centre of the cube
    double spacing;             ///< h, also from node to node of the row along axis 0
    double eps;                 ///< width of H_eps
    bool rotate;                ///< false: derivatives in the angles are 0
};

/// Sums over nodes of r^2, r J and J J^T, r = H_eps(first shape, moved) - target, J its derivative in a further motion.
template <int Dim>
struct AlignmentSums {
    double square = 0.0;
    double force[motion_unknowns<Dim>] = {};
    double product[motion_unknowns<Dim>][motion_unknowns<Dim>] = {};  ///< the lower half
};

/// Adds a row. Beyond the cube the level set of the first shape falls by the distance to it. SIMD; the bits depend on
/// the instruction set only.
/// @param derivatives  whether force and product are wanted
template <int Dim>
void add_row(const AlignmentRow<Dim>& row, bool derivatives, AlignmentSums<Dim>& sums);

}  // namespace morphodesic::kernels
