#pragma once

#include <string>
#include <vector>

#include "geodesic/solver/rigid_motion.h"

namespace morphodesic {

template <int Dim>
struct AlignmentCandidate {
    RigidMotion<Dim> motion;
    double mismatch = 0.0;  ///< int (H_eps(a o motion^-1) - H_eps(b))^2 dx, length^Dim
};

/// Proper rigid motions of shape a that are local minima of its mismatch with shape b, best first, different from each
/// other by more than a few degrees on the coarse grid (some meet on the finer one; they are starts all the same).
/// Starts: centroids on each other and, for "rigid", rotations all around (2D) or the principal axes with all proper
/// sign choices and the 24 rotations of the cube (3D); each is refined by Levenberg-Marquardt. No reflections.
/// @param mode   "rigid", "translation" (one candidate) or "none" (the identity)
/// @param count  at most so many candidates, >= 1
/// @throws std::invalid_argument if a shape is empty
template <int Dim>
std::vector<AlignmentCandidate<Dim>> align(const LevelSet<Dim>& a, const LevelSet<Dim>& b, const std::string& mode,
                                           int count);

}  // namespace morphodesic
