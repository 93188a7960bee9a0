#pragma once

#include <span>
#include <vector>

#include "geodesic/solver/multigrid.h"
#include "geodesic/solver/trajectories.h"

namespace morphodesic {

/// What the elastic energy of a time step, of one mode in time, makes of moves v of material points: on the coarse grid
/// in frame 0, the mean over all steps. A move changes phi_k by A_k v(P_{k-1}), and the derivative of that is
/// A_k grad v A_{k-1}^-1 + (grad A_k) v: moves are stiffer by |A|^2 |A^-1|^2 / Dim^2 where the path has sheared the
/// material (the mean over all grad v of a size), and where A jumps from node to node, as along cracks, no move is
/// free, not even a constant one. Without both, steps of the minimiser are up to five times too long there, the more
/// the finer the grid.
template <int Dim>
struct MoveElasticity {
    std::vector<float> stiffness;       ///< [coarse nodes], in units of the weights
    typename VCycle<Dim>::Mass masses;  ///< [coarse nodes], of (grad A) v

    /// @param weights  stiffness of the steps k = 1..K at the nodes of frame k - 1, each [nodes of grid]
    /// @param grid     that of the path
    MoveElasticity(const Trajectories<Dim>& trajectories, const DyadicGrid<Dim>& grid, const DyadicGrid<Dim>& coarse,
                   std::span<const std::vector<float>> weights);
};

}  // namespace morphodesic
