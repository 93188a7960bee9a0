#pragma once

#include <array>
#include <span>
#include <vector>

#include "geodesic/energy/path_energy.h"
#include "geodesic/kernels/transport_kernels.h"
#include "geodesic/solver/mismatch_points.h"
#include "geodesic/solver/multigrid.h"
#include "geodesic/solver/trajectories.h"

namespace morphodesic {

/// Correction of a path by moves that leave the mismatch as it is: the shapes between are carried along by a motion of
/// the material, and the deformations follow. The mismatch is blind to them, so a preconditioner that looks at phi_k
/// and u_k one by one takes them for stiff; here only the dissipation resists.
///
/// On a coarse grid in frame 0 live, for the material point X,
///   v_k (k = 1..K), sum_k v_k = 0: what phi_k adds to the motion of X; z_k = v_1 + .. + v_k moves it in frame k;
///   y_k (k = 1..K-1): change of the level of shape k, in units of 1 / sqrt(curvature of the mismatch in u_k).
/// With P_k(x) the material point at x in frame k, Phi_k its inverse, A_k = D Phi_k, they become
///   delta phi_k(x) = A_k v_k(P_{k-1}(x)),    delta u_k(x) = -(grad u_k A_k z_k)(P_k(x)) + d_k(x) y_k(P_k(x)),
/// both fading out far from the contour (near_contour).
/// In the basis cos(pi m (k - 1/2) / K) of the time steps the energy decouples: 2 c K times the elasticity of v_m
/// (MoveElasticity), and what the transport leaves of the mismatch (contours are no straight lines) times
/// 1 / (4 sin^2(pi m / 2 K)); each is solved by a V-cycle. The mismatch couples y_k in a chain with ends fixed, which
/// is inverted exactly.
template <int Dim>
class TransportCorrection {
public:
    explicit TransportCorrection(const PathLayout<Dim>& layout);

    /// Building the maps and operators at the path x takes three calls: the points of the path are followed first,
    void follow(const PathEnergy<Dim>& energy, std::span<const double> x);
    /// then the mismatch of each step k = 0..K-1 is added point by point (calls for different steps may be concurrent),
    void add_point(int k, const MismatchPoint<Dim>& point);
    /// and then the operators are built.
    /// @param weights    stiffness of the steps k = 1..K at the nodes of frame k - 1
    /// @param inverse_u  1 / curvature of the mismatch in u_k with the factor PathPreconditioner uses, k = 1..K-1
    void build(const PathEnergy<Dim>& energy, std::span<const double> x, const std::vector<std::vector<float>>& weights,
               const std::vector<std::vector<float>>& inverse_u);

    /// The correction, symmetric and positive semidefinite, in two calls: takes the gradient,
    void take(std::span<const float> gradient);
    /// and adds the correction for it to the direction. Both in PathLayout order; they may be the same memory.
    void add_to(std::span<float> direction);

private:
    static constexpr std::size_t width = kernels::transport_width;
    static_assert(2 * Dim + 1 <= width);
    void add_rest(int k, int of, std::size_t node, const Point<Dim>& fraction, const double (&e)[Dim]);
    [[nodiscard]] kernels::TransportMaps<Dim> maps(int k) const;
    void push(int k, std::span<const float> gradient);
    void solve();
    void pull(int k, std::span<float> direction) const;

    PathLayout<Dim> layout_;
    DyadicGrid<Dim> coarse_;
    Trajectories<Dim> trajectories_;
    double unit_ = 0.0;                                       // of the mismatch at a point
    std::vector<typename VCycle<Dim>::Mass> rest_;            // per step, [coarse nodes]
    std::vector<std::vector<float>> level_unit_;              // d_k, k = 1..K-1
    std::vector<std::vector<float>> buffers_;                 // per frame, [coarse nodes][width]
    std::vector<VCycle<Dim>> modes_;                          // m = 1..K-1
    VCycleVectors<Dim> vectors_;                              // of modes_
    std::vector<std::array<std::vector<float>, Dim>> modal_;  // per mode, right side and solution
};

}  // namespace morphodesic
