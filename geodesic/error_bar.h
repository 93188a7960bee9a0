#pragma once

#include "geodesic/discrete_geodesic.h"

namespace morphodesic {

/// Fills extrapolated_length and error of a result that has all the rest, from what the cascade visited anyway.
///
/// The error is first order in the width of the rim (a step may drift by a share of it for little mismatch), so two
/// widths extrapolate the length (Richardson): l + (l - l_wide) eps / (eps_wide - eps). Where the length falls with
/// the rim, it is material in the tails of H_eps that is moved along: that part of l^2 is first order, and may be
/// most of it where a thin shape bends. The bar is 1.75 times that correction (on the closed forms the order is a
/// little below one before the limit), what is left of the time steps, and what the tolerance leaves.
///
/// The last halving of the grid halves the rim, too, and predicts the same change. By as much as it does not, the error
/// is none of the rim: teeth of a leaf, gaps and holes that are smaller than a cell with either rim. Up to the level
/// where the search ends these are solves of two time steps and a loose tolerance, of which some of this remains.
///
/// Long steps rather leave a part d of the way to the mismatch, eta c d^2. Where the sum of both is least,
/// E = l (l + d), so d = E / l - l (too much where the mismatch saturates; E without the area term). All of it
/// counts where one step or a soft mismatch allows it, else as much as the sizes of the shapes differ: the larger
/// one has material that the smaller one has to fill or to leave. The rest is told by the doubling. Of a shape that
/// is partly hidden sizes are not known.
///
/// And (13) weighs a step with the shape that it begins with. Where a dot grows much, material appears in cells that
/// are empty then, for next to nothing; the trapezoid rule, the mean of both ends, tells how much that is.
///
/// What the grid and the rim leave is a part of either, so the largest of the three counts.
/// @param wide_length  length on the last level with all time steps and the wide rim
/// @param wide_rim     its eps / h
/// @param masked       a part of the first shape is hidden
template <int Dim>
void add_error_bar(GeodesicResult<Dim>& result, double wide_length, double wide_rim, bool masked);

}  // namespace morphodesic
