#pragma once

#include <vector>

#include "datasets/triangle_mesh.h"

/// Repair of what scanners get wrong: noise and holes.
namespace morphodesic::datasets {

/// How far the points of a surface lie off the smooth surface through their neighbours: median over the surface of the
/// root mean square residual of local quadrics, units of the mesh. Edges and small features hardly count.
/// @param mesh  oriented so that neighbours agree
double roughness(const TriangleMesh& mesh);

/// Moves each point along its normal onto the quadric that fits its neighbourhood. The neighbourhood of each point
/// grows as long as the quadric fits within the noise, so that flat parts are smoothed far and small features are kept.
/// Bits do not depend on the number of threads.
/// @param noise  as roughness measures it, > 0
/// Source of the choice of the neighbourhood: Lepski 1990; Goldenshluger and Nemirovski 1997.
void smooth_noise(TriangleMesh& mesh, double noise);

/// Moves the free points so that the surface goes on through them as smoothly as a thin plate held by the others does.
/// @param is_free  [points]
void fair(TriangleMesh& mesh, const std::vector<char>& is_free);

}  // namespace morphodesic::datasets
