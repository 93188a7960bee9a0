#pragma once

#include "geodesic/discrete_geodesic.h"

namespace morphodesic {

/// The motion that brings a shape to a pose of its own, up to quarter turns, which map the grid to itself: its centroid
/// comes to the middle of the square, and the fourth harmonic of the directions of its contour becomes real, so that
/// straight strokes lie along the grid. The identity for shapes without such a direction (disks), for those it would
/// push out of the square, and in 3D, where the pose was measured to matter little (MEASUREMENTS.md).
/// @return a motion m such that m(u) does not depend, up to quarter turns, on how u was turned and shifted
template <int Dim>
RigidMotion<Dim> canonical_frame(const LevelSet<Dim>& u);

/// Whether a shape stays in the cube however it is turned about its centroid: one that is aligned to a shape in another
/// pose must.
template <int Dim>
bool turns_freely(const LevelSet<Dim>& u);

/// The path as it looks in the pose of the second shape: shapes and deformations of a path that was computed in another
/// frame are turned back and sampled anew on the same grid. Numbers stay those of the path as computed; the fields are
/// for pictures, what is certified is the path itself. A path without a frame is returned as it is.
template <int Dim>
GeodesicResult<Dim> in_pose_of_last(GeodesicResult<Dim> path);

}  // namespace morphodesic
