#pragma once

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic {

/// Length of the contour (area of the surface) of {u > 0}: the total variation int |grad H_eps(u)| dx, taken
/// at the points of kernels::Quadrature::many; |grad u| is regularised by 1e-3, so that the energy is smooth.
/// @param u         [N] level set
/// @param factor    factor of the energy in the gradient
/// @param gradient  [N], the gradient in u is added; null: not wanted
/// @return          the energy without its factor, length^(Dim-1)
/// Source: section 4 of [WBRS09].
template <int Dim>
double area_energy(const DyadicGrid<Dim>& grid, const double* u, double eps, double factor, double* gradient);

}  // namespace morphodesic
