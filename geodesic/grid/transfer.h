#pragma once

#include <span>

#include "geodesic/grid/fields.h"

namespace morphodesic {

/// Multilinear prolongation to the next finer grid (level + 1): exact on multilinear functions.
/// @param coarse [N of `grid`], fine [N of level + 1]
template <int Dim>
void prolong(const DyadicGrid<Dim>& grid, std::span<const double> coarse, std::span<double> fine);

/// Transpose of prolong: coarse = P^T fine, with `grid` the coarse grid.
template <int Dim>
void prolong_transposed(const DyadicGrid<Dim>& grid, std::span<const double> fine, std::span<double> coarse);

/// The field on a coarser level, by its values at the coarse nodes (they are nodes of the fine grid, too).
/// @throws std::invalid_argument if level > field.grid.level()
template <int Dim>
ScalarField<Dim> restricted(const ScalarField<Dim>& field, int level);

}  // namespace morphodesic
