#pragma once

#include <span>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// Cuts a polygon into corners - 2 triangles of its own corners, all turned as it is. No corner is left out, also not
/// in the middle of a straight side, so that what fits to the polygon also fits to its triangles. Quads are cut from
/// their concave corner, else from the first; others ear by ear, the best shaped first.
/// @param corners    numbers of points, at least three; nearly in a plane, or the cut is one of many
/// @param triangles  gets the triangles
/// Time: corners^2.
void cut_polygon(const std::vector<Vector3>& points, std::span<const int> corners,
                 std::vector<std::array<int, 3>>& triangles);

}  // namespace morphodesic::datasets
