#pragma once

#include <vector>

#include "geodesic/discrete_geodesic.h"
#include "geodesic/energy/path_energy.h"

namespace morphodesic {

/// A discrete path on one level of the cascade, between two fixed shapes.
template <int Dim>
struct PathState {
    PathLayout<Dim> layout;
    std::vector<double> x;  ///< PathLayout order
};

/// u_k, k = 0..K.
template <int Dim>
const double* shape_of(const PathState<Dim>& path, const LevelSet<Dim>& first, const LevelSet<Dim>& last, int k);

/// phi = id, u_k blended linearly between the two shapes.
template <int Dim>
PathState<Dim> blended_path(const LevelSet<Dim>& first, const LevelSet<Dim>& last, int time_steps);

/// K -> 2 K: each deformation is cut in two halves, phi = second o (id + w / 2), with the shape between carried along
/// as in (6)-(8). Folds of the halves are repaired; their number is returned in `folds`.
template <int Dim>
PathState<Dim> split_in_time(const PathState<Dim>& path, const LevelSet<Dim>& first, const LevelSet<Dim>& last,
                             int& folds);

/// Level -> level + 1 by multilinear prolongation. Folds are repaired; their number is returned in `folds`.
template <int Dim>
PathState<Dim> prolong_in_space(const PathState<Dim>& path, int& folds);

/// repair_folds of every deformation. @return number of cells that folded
template <int Dim>
int repair_folds(PathState<Dim>& path, double threshold = 0.05);

/// Leaves of every deformation what the next coarser grid can tell: its values at that grid's nodes, multilinear in
/// between. Folds are repaired. @return number of cells that folded
template <int Dim>
int smooth_deformations(PathState<Dim>& path);

/// Replaces the shapes between by the best ones for the deformations of the path: along the trajectories H_eps(u_k) is
/// blended linearly between H_eps(u_0), carried along by phi_k o ... o phi_1, and H_eps(u_K), pulled back by
/// phi_K o ... o phi_{k+1}. That minimises the mismatch part of (14) exactly (it is quadratic in H_eps(u_k) along
/// trajectories), tails of the arctan included, which a gradient in u can hardly see.
template <int Dim>
void transport_shapes(PathState<Dim>& path, const LevelSet<Dim>& first, const LevelSet<Dim>& last, double eps);

}  // namespace morphodesic
