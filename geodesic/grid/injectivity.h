#pragma once

#include <array>
#include <limits>
#include <vector>

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic {

/// Displacement components of one deformation, [N] each.
template <int Dim>
using DisplacementView = std::array<const double*, Dim>;

/// Guaranteed lower bound of det D phi over the whole cube. A positive bound proves that phi is 1-1, since phi is the
/// identity on the boundary. 2D: det is affine along each axis of a cell, so the corners decide (the bound is exact).
/// 3D: det is quadratic along each axis; the least of its 27 Bernstein coefficients per cell bounds it; where that is
/// not positive the cell is split up to three times before the bound is given up.
template <int Dim>
double det_lower_bound(const DyadicGrid<Dim>& grid, const DisplacementView<Dim>& displacement);

/// At every node the least det D phi at the corners of the cells around it, [N].
template <int Dim>
std::vector<double> least_node_det(const DyadicGrid<Dim>& grid, const DisplacementView<Dim>& displacement);

/// Makes a deformation that folds admissible: around the cells whose bound is below `threshold` the displacement is
/// smoothed, in growing neighbourhoods; what still folds after that is blended towards the identity as a whole.
/// @param most  more cells than that are not repaired: nothing is changed
/// @return number of cells that folded; 0: nothing was changed
template <int Dim>
int repair_folds(const DyadicGrid<Dim>& grid, const std::array<double*, Dim>& displacement, double threshold = 0.05,
                 int most = std::numeric_limits<int>::max());

/// Shortens a change of the displacement locally, so that no cell is squeezed at once to less than `keep` of what it
/// is: at the nodes of each such cell the change is halved, until there is none left or twelve times.
/// @return number of cells that were in the way
template <int Dim>
int limit_change(const DyadicGrid<Dim>& grid, const DisplacementView<Dim>& displacement,
                 const std::array<float*, Dim>& change, double keep);

}  // namespace morphodesic
