#pragma once

#include <vector>

#include "datasets/lattice.h"
#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// Distance of every node to the nearest of some points [N], in the units of the lattice. The nearest point is handed
/// on from node to node along the six directions of the axes; where two points are almost equally near the wrong one of
/// them may win, so the error is a small fraction of the spacing and vanishes near the points.
/// Bits do not depend on the number of threads.
/// @param points  not empty; points outside the lattice count from its nearest node on
std::vector<float> distance_to_points(const Lattice& lattice, const std::vector<Vector3>& points);

/// Points on the surface, no two neighbours farther apart than the spacing; contains all points of the mesh.
std::vector<Vector3> surface_samples(const TriangleMesh& mesh, double spacing);

}  // namespace morphodesic::datasets
