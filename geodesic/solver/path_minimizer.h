#pragma once

#include <vector>

#include "geodesic/energy/path_energy.h"

namespace morphodesic {

struct MinimizerOptions {
    double tolerance = 3e-3;   ///< stop: relative decrease of E over five iterations
    int max_iterations = 400;  ///< > 0
    int history = 4;           ///< pairs of L-BFGS, > 0; 6 take as many iterations
};

struct MinimizerSummary {
    Termination termination = Termination::converged;
    int iterations = 0;
    int evaluations = 0;
    PathTerms terms;  ///< at the path that was reached
};

/// Minimises (14) over all deformations and all shapes between at once: L-BFGS whose initial Hessian is
/// PathPreconditioner, Armijo line search. Steps to folded deformations are rejected, contours of the shapes between are
/// kept from becoming steep (SlopeLimit).
/// @param x  path, PathLayout order: start on entry, minimiser on return
/// @throws std::invalid_argument if the energy of the start is infinite, though its folds were repaired
template <int Dim>
MinimizerSummary minimize_path(PathEnergy<Dim>& energy, std::vector<double>& x, const MinimizerOptions& options);

}  // namespace morphodesic
