#pragma once

#include <functional>

#include "datasets/synthetic_solids.h"
#include "geodesic/discrete_geodesic.h"
#include "pipeline/figures/path_rows.h"
#include "pipeline/path_pictures.h"

namespace morphodesic::pipeline {

/// A generated solid in the middle of the cube, on a grid of the given level. @param scale  cube units per millimetre
[[nodiscard]] LevelSet<3> solid_shape(const datasets::GeneratedSolid& solid, double scale, int level);

/// Scale at which the larger of the solids fits into the cube (see datasets::common_scale).
[[nodiscard]] double fitting_scale(const std::vector<datasets::GeneratedSolid>& solids);

/// The camera of the quadrupeds and feet: from the front right and above, pictures `aspect` times as high as wide; they
/// are cut along their plane of symmetry.
[[nodiscard]] SolidView side_view(int pixels, double aspect = 1.0, double zoom = 1.2);

/// The largest zoom at which all the solids are seen whole, with a small margin.
[[nodiscard]] double fitting_zoom(const std::vector<LevelSet<3>>& shapes, datasets::View camera);

/// Shapes 0 .. K - 1 of a path, coloured by the dissipation of the step that starts there.
struct SolidFrames {
    std::vector<RgbaImage> frames;
    double highest = 1.0;  ///< value of the last colour: 98 % of the objects have less
};
[[nodiscard]] SolidFrames dissipation_pictures(const GeodesicResult<3>& path, const SolidView& view);

/// Colour of a point x of the slicing plane of shape k, where its level set is u.
using PlaneColour = std::function<Colour(std::size_t k, const Point<3>& x, double u)>;

/// Solids cut open along the view's slicing plane through the middle: the part behind the plane is shaded, the plane is
/// opaque in the object, with its contour as a line, and half transparent around it.
[[nodiscard]] std::vector<RgbaImage> cut_pictures(const std::vector<LevelSet<3>>& shapes, const SolidView& view,
                                                  const PlaneColour& plane);
/// Level lines of u in the plane, as bands.
[[nodiscard]] PlaneColour level_lines_in_plane(double band);
/// A grid of the first shape, carried along by the path; lines at multiples of `spacing` of the coordinates that the
/// plane has.
[[nodiscard]] PlaneColour grid_in_plane(const GeodesicResult<3>& path, int slice_axis, double spacing);

/// The geodesic from a cat-like to a lion-like quadruped; computed once per program run.
[[nodiscard]] const GeodesicResult<3>& quadruped_path(const FigureOptions& options);

}  // namespace morphodesic::pipeline
