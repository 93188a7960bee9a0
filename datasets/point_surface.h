#pragma once

#include <vector>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

struct PointSurface {
    TriangleMesh mesh;        ///< the same points and the triangles between them, none if there are too few points
    double unevenness = 0.0;  ///< how far neighbours lie off their plane, root mean square, over how far apart the
                              ///< farthest are; median over the points
};

/// Triangles between neighbouring points of a surface: those of the Delaunay triangulations of each point and its
/// neighbours in its tangent plane on which at least two of the three corners agree. Where points are missing there are
/// none, so openings stay open. Triangles that hang together face the same side, outward if they close.
/// none, so openings stay open; neighbouring triangles need not face the same side.
/// Bits do not depend on the number of threads.
/// @param points  no two the same
/// Sources: Gopi, Krishnan, Silva, Surface reconstruction based on lower dimensional localized Delaunay triangulation,
/// 2000; for the sides Hoppe, DeRose, Duchamp, McDonald, Stuetzle, Surface reconstruction from unorganized points,
/// 1992.
PointSurface surface_through(std::vector<Vector3> points);

}  // namespace morphodesic::datasets
