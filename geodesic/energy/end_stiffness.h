#pragma once

#include "geodesic/grid/fields.h"
#include "geodesic/solver/geodesic_options.h"

namespace morphodesic {

/// E_deform of (13) with the stiffness of the shape that a step ends with in place of the one that it begins with:
///   int ((1 - delta) H_eps(u o phi) + delta) W(D phi) dx,  u o phi sampled at the nodes.
/// The two are rules of the right and of the left end in time and differ in first order of the step: by the material
/// that appears or vanishes in it, which only one of them counts.
/// @param after  u_k, the shape that the step ends with, on the grid of phi
/// @return +infinity where the deformation folds
template <int Dim>
double end_deformation_energy(const Deformation<Dim>& phi, const LevelSet<Dim>& after, const GeodesicOptions& options);

}  // namespace morphodesic
