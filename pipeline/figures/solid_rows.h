#pragma once

#include "datasets/synthetic_solids.h"
#include "geodesic/discrete_geodesic.h"
#include "pipeline/figures/path_rows.h"

namespace morphodesic::pipeline {

/// A generated solid in the middle of the cube, on a grid of the given level. @param scale  cube units per millimetre
[[nodiscard]] LevelSet<3> solid_shape(const datasets::GeneratedSolid& solid, double scale, int level);

/// Scale at which the larger of the solids fits into the cube (see datasets::common_scale).
[[nodiscard]] double fitting_scale(const std::vector<datasets::GeneratedSolid>& solids);

/// A solid on a transparent background, shaded, seen from the front right and above; coloured by dissipation if a rate
/// is given (`high_rate`: value of the last colour).
[[nodiscard]] RgbaImage solid_picture(const LevelSet<3>& u, int pixels, const ScalarField<3>* rate = nullptr,
                                      double high_rate = 1.0);

/// Shapes 0 .. K - 1 of a path, coloured by the dissipation of the step that starts there.
struct SolidFrames {
    std::vector<RgbaImage> frames;
    double highest = 1.0;  ///< value of the last colour: 98 % of the objects have less
};
[[nodiscard]] SolidFrames dissipation_pictures(const GeodesicResult<3>& path, int pixels);

/// A solid cut open along the plane y = 1/2, seen as in solid_picture: the part behind the plane is shaded, the plane
/// carries the level lines of u as bands, opaque in the object and half transparent around it.
[[nodiscard]] RgbaImage cut_picture(const LevelSet<3>& u, int pixels, double band);

/// The geodesic from a cat-like to a lion-like quadruped; computed once per program run.
[[nodiscard]] const GeodesicResult<3>& quadruped_path(const FigureOptions& options);

}  // namespace morphodesic::pipeline
