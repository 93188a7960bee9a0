#pragma once

#include "geodesic/grid/fields.h"

namespace morphodesic {

/// Multilinear prolongation P to the next finer grid (level + 1), exact on multilinear functions: fine += P coarse.
/// Real is double or float.
/// @param grid  the coarse grid; coarse [N of grid], fine [N of level + 1]
template <int Dim, class Real>
void add_prolonged(const DyadicGrid<Dim>& grid, const Real* coarse, Real* fine);

/// Its transpose: coarse = P^T fine. At nodes on the boundary of the cube the result is 0 (Dirichlet).
template <int Dim, class Real>
void restrict_residual(const DyadicGrid<Dim>& grid, const Real* fine, Real* coarse);

/// The field on a coarser level, by its values at the coarse nodes (they are nodes of the fine grid, too).
/// @throws std::invalid_argument if level > field.grid.level()
template <int Dim>
ScalarField<Dim> restricted(const ScalarField<Dim>& field, int level);

}  // namespace morphodesic
