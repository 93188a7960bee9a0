#pragma once

#include "geodesic/grid/dyadic_grid.h"
#include "geodesic/kernels/step_kernel.h"

namespace morphodesic {

/// What the rule of the kernel overlooks of the mismatch (12) in cells that one time step stretches: the difference
/// between a dense quadrature of them and the rule, for the cells with the last index in [row_begin, row_end).
///
/// The deformed points of a stretched cell lie further apart than contours are wide. A minimiser finds that out: it
/// stretches background cells many times, which costs next to nothing, so that material that comes from nowhere lies
/// between their points. The difference counts more and more where the longest edge of a cell becomes two to three
/// times as long as it was (1.5 to 2.5 times with the rule of fewer points), in whole beyond.
///
/// Adds the gradients of weights.mismatch times the difference to `gradients`, as kernels::step_energy_rows does.
/// @return the difference, to be added to StepSums::mismatch
template <int Dim, class T>
double stretched_mismatch(const DyadicGrid<Dim>& grid, int row_begin, int row_end,
                          const kernels::StepFields<Dim, T>& fields, const kernels::StepWeights& weights,
                          const kernels::StepGradients<Dim, T>& gradients);

}  // namespace morphodesic
