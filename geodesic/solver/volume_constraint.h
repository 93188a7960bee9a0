#pragma once

#include <span>
#include <vector>

#include "geodesic/energy/path_energy.h"

namespace morphodesic {

/// Area (2D) or volume (3D) of {u > 0}, from a ramp of width 2 h across the contour: second order for distance
/// functions.
template <int Dim>
double enclosed_volume(const DyadicGrid<Dim>& grid, const double* u);

/// Keeps the volumes of the shapes between on the straight line between those of the two ends (equal ends: constant),
/// as in section 6 of [WBRS09], by predictor and corrector: gradients and directions are projected on the tangent of
/// the constraint, then each u_k is shifted by a constant until its volume fits.
template <int Dim>
class VolumeConstraint {
public:
    explicit VolumeConstraint(const PathEnergy<Dim>& energy);

    /// Corrector: u_k += c_k. @return false if a volume cannot be reached (a shape has vanished)
    bool correct(std::span<double> x) const;
    /// Gradient of the energy along the constraint at x: g - (g . 1) / (n . 1) n for each u_k, n the volume's gradient.
    void project_gradient(std::span<const double> x, std::span<float> gradient) const;
    /// Predictor: the direction without its part across the constraint: d - (n . d) / (n . 1).
    void project_direction(std::span<const double> x, std::span<float> direction) const;

private:
    template <class Body>
    void for_each_shape(std::span<const double> x, const Body& body) const;

    PathLayout<Dim> layout_;
    std::vector<double> target_;  // k = 0..K
};

}  // namespace morphodesic
