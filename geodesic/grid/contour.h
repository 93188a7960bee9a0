#pragma once

#include <vector>

#include "geodesic/grid/fields.h"

namespace morphodesic {

/// Closed polygon, the last vertex is joined to the first; unit cube coordinates.
using ContourLoop = std::vector<Point<2>>;

/// The contour {u = value} of a 2D level set as closed polygons with {u > value} on their left: counter-clockwise
/// around parts, clockwise around holes. Vertices lie on grid edges by linear interpolation; where two parts meet in a
/// cell its bilinear value in the middle decides. What touches the boundary of the square is closed just outside it.
std::vector<ContourLoop> contour(const LevelSet<2>& u, double value = 0.0);

}  // namespace morphodesic
