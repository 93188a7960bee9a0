#pragma once

#include "geodesic/discrete_geodesic.h"

namespace morphodesic {

/// Where (id + share w) maps to y, w the displacement of phi; share in [0, 1]. Points stay in the cube. Where the
/// interpolated map folds (large turns within one step) one of the points that come nearest to y is returned.
template <int Dim>
Point<Dim> inverse_at(const Deformation<Dim>& phi, const std::type_identity_t<Point<Dim>>& y, double share = 1.0);

/// Deformation of the whole path up to time t in [0, 1], from the first shape:
///   phi_tau(t) = (id + (t - t_{k-1}) v_tau) o phi_{k-1} o ... o phi_1,  v_tau = (phi_k - id) / tau,  t in (t_{k-1},
///   t_k]
/// sampled at the nodes. Source: (6), (7) of [WBRS09].
/// @throws std::invalid_argument if t is outside [0, 1] or the path has no steps
template <int Dim>
Deformation<Dim> deformation_at(const GeodesicResult<Dim>& path, double t);

/// Shape of the path at time t in [0, 1]: (id + (t - t_{k-1}) v_tau)(S_{k-1}), as a level set; the shape itself where t
/// is a multiple of the time step. Source: (8) of [WBRS09].
/// @throws std::invalid_argument if t is outside [0, 1] or the path has no steps
template <int Dim>
LevelSet<Dim> shape_at(const GeodesicResult<Dim>& path, double t);

/// The path walked back, from its last shape to its first: shapes and energies of the steps in reverse order, inverse
/// deformations sampled at the nodes, motion and frame such that in_pose_of_last gives the pose of what is now the last
/// shape. Other numbers stay those of the path as computed; the fields are for pictures, what is certified is the path
/// itself.
template <int Dim>
GeodesicResult<Dim> reversed(GeodesicResult<Dim> path);

}  // namespace morphodesic
