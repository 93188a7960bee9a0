#pragma once

#include <functional>
#include <string>
#include <vector>

#include "geodesic/grid/fields.h"
#include "geodesic/solver/geodesic_options.h"
#include "geodesic/solver/rigid_motion.h"

namespace morphodesic {

/// What one (level, K) of the cascade reached.
struct LevelReport {
    int level = 0;
    int time_steps = 0;
    double rim_width = 0.0;  ///< eps / h: wide while starts compete, then GeodesicOptions::rim_width
    int iterations = 0;
    int evaluations = 0;
    double total_energy = 0.0;
    double path_length = 0.0;
    double min_det = 0.0;    ///< least det D phi at points and corners of cells; of the last level the certified bound
    int folds_repaired = 0;  ///< cells in which the prolonged deformation folded and was repaired
    Termination termination = Termination::converged;  ///< max_steps also where a round goes on with a wider rim
    double seconds = 0.0;
};

/// A discrete geodesic between two shapes.
template <int Dim>
struct GeodesicResult {
    GeodesicOptions options;
    Termination termination = Termination::converged;
    std::string message;  ///< one sentence on the termination, empty where there is nothing to say

    double path_length = 0.0;          ///< sum_k sqrt(E_deform,k): the distance; unit length^(Dim/2)
    double path_energy = 0.0;          ///< K sum_k E_deform,k
    double total_energy = 0.0;         ///< E of (14)
    double error = 0.0;                ///< error bar of path_length, see add_error_bar
    double extrapolated_length = 0.0;  ///< path length extrapolated to h -> 0
    double min_det = 0.0;              ///< guaranteed lower bound of det D phi_k over all cells and steps; > 0: 1-1
    std::vector<double> deformation_energy;  ///< E_deform,k, k = 1..K
    std::vector<double> mismatch_energy;     ///< E_match,k (without eta), k = 1..K
    std::vector<LevelReport> levels;         ///< the cascade, coarse to fine
    double seconds = 0.0;

    /// Motion of the first shape onto the second one before the solve (alignment).
    RigidMotion<Dim> motion;
    /// Motion of both shapes after that: the path is computed where it no longer depends on how the second shape is
    /// turned and where it lies (canonical_frame). The identity unless shapes are aligned rigidly and nothing is
    /// hidden; in_pose_of_last takes it back.
    RigidMotion<Dim> frame;
    std::vector<LevelSet<Dim>> shapes;  ///< u_0 .. u_K on the finest level; u_K is the second shape, in the frame
    std::vector<Deformation<Dim>> deformations;  ///< phi_1 .. phi_K
};

/// Called after each level; returning false cancels the solve.
using GeodesicObserver = std::function<bool(const LevelReport&)>;

/// Computes a discrete geodesic from shape a to shape b: minimises (14) coarse to fine in space and time.
/// @param a, b   level sets (signed distances, > 0 inside) on grids of any level >= options.level
/// @param mask   occlusion mask chi in [0,1] of the mismatch of step 1, in the frame of a (moved with a by the
///               alignment, which looks at what is visible); empty values: chi = 1
/// @throws std::invalid_argument if options.problems() is not empty, a grid is too coarse, a shape is empty or not
///                               finite, or the mask hides its whole contour or leaves [0, 1]
template <int Dim>
GeodesicResult<Dim> compute_discrete_geodesic(const LevelSet<Dim>& a, const LevelSet<Dim>& b,
                                              const GeodesicOptions& options, const ScalarField<Dim>& mask = {},
                                              const GeodesicObserver& observer = {});

}  // namespace morphodesic
