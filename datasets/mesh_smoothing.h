#pragma once

#include <vector>

#include "datasets/triangle_mesh.h"

/// Repair of what scanners get wrong: noise and holes.
namespace morphodesic::datasets {

/// How far the points of a surface lie off the smooth surface through their neighbours: median over the surface of the
/// root mean square residual of local quadrics, units of the mesh. Edges and small features hardly count.
/// @param mesh  oriented so that neighbours agree
double roughness(const TriangleMesh& mesh);

/// Tells noise from detail: how alike neighbouring points stand out from the mean of their own neighbours. Detail that
/// the mesh resolves changes little from one point to the next (0.6 to 1 on clean meshes, also coarse ones, 0.4 on a
/// rough scan from photographs); noise does not hang together (0.1 down to -0.24, the value for independent errors of
/// points with six neighbours).
/// @param least  if more than half of the points stand out less than this (units of the mesh), nothing stands out: on
///   flat faces there is only rounding, and it looks like noise
/// @return  correlation over all edges, in [-1, 1]; 1 if nothing stands out
double bump_correlation(const TriangleMesh& mesh, double least = 0.0);

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
