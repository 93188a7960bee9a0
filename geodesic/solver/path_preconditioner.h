#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geodesic/energy/path_energy.h"
#include "geodesic/solver/multigrid.h"
#include "geodesic/solver/transport_correction.h"

namespace morphodesic {

/// Symmetric positive definite approximation of the inverse Hessian of (14), matched to the energy:
///   phi_k:  one V-cycle of -2 c K div(w_k grad) + 2 eta delta^2 n n^T, c = mu + lambda/4,
///           w_k = (1 - delta) H_eps(u_{k-1}) + delta; the second term is the Gauss-Newton matrix of the mismatch,
///           n = grad u_k at the deformed point: stiff across the contour, free along it;
///   u_k:    division by the lumped Gauss-Newton matrix of the two mismatches it is part of, plus a floor of 1 % of its
///           largest value.
/// Both are assembled at the quadrature points: the rim is narrower than a cell, nodes alone would miss it. Added to it
/// is a TransportCorrection for moves of shapes and deformations together.
template <int Dim>
class PathPreconditioner {
public:
    explicit PathPreconditioner(const PathEnergy<Dim>& energy);

    /// Builds the operators at the path x.
    void update(const PathEnergy<Dim>& energy, std::span<const double> x);

    /// Multiplies a vector in PathLayout order by the approximate inverse Hessian, in place.
    void apply(std::span<float> vector);

    /// Goes on without the TransportCorrection, where its directions turn out to be of no use.
    /// @return false if there was none
    bool drop_transport();

private:
    PathLayout<Dim> layout_;
    std::vector<VCycle<Dim>> cycles_;                    // per time step
    VCycleVectors<Dim> vectors_;                         // of cycles_
    std::vector<std::vector<float>> inverse_u_;          // per shape between
    std::optional<TransportCorrection<Dim>> transport_;  // for more than one time step
};

}  // namespace morphodesic
