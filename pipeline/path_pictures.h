#pragma once

#include <vector>

#include "geodesic/discrete_geodesic.h"
#include "pipeline/png.h"

namespace morphodesic::pipeline {

/// Half width of the part of the unit cube that pictures show, around its centre: shapes reach 0.36 from it.
inline constexpr double picture_radius = 0.4;

/// A shape in one colour on a transparent background, anti-aliased; solids are shaded, seen obliquely from above.
template <int Dim>
[[nodiscard]] RgbaImage shape_picture(const LevelSet<Dim>& u, int pixels);

/// Frames 0 .. K of a path. Frame k < K is coloured by the dissipation of the step that starts there, frame K by that
/// of the step that ends there.
struct PathPictures {
    std::vector<RgbaImage> frames;
    double highest = 0.0;  ///< value of the last colour: 98 % of the object have less; the first colour is 0
};

/// Colours show the viscous dissipation rate density (1) of [WBRS09], lambda/2 (tr eps)^2 + mu tr eps^2, of the
/// velocity v = (phi_k - id) / tau, in units of 1/time^2 (mu = 1, the path takes the time 1).
template <int Dim>
[[nodiscard]] PathPictures path_pictures(const GeodesicResult<Dim>& path, int pixels);

/// Nodal values of that density for one step, eps by central differences of the displacement.
template <int Dim>
[[nodiscard]] ScalarField<Dim> dissipation_rate(const Deformation<Dim>& phi, double tau, double lambda, double mu);

}  // namespace morphodesic::pipeline
