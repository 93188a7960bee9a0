#pragma once

#include <openvdb/openvdb.h>

#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// Where a grid has a value, as triangles in its world space: a point in each cell that the surface passes through,
/// faces of four corners cut along their shorter diagonal.
TriangleMesh surface_of(const openvdb::FloatGrid& grid, double value);

}  // namespace morphodesic::datasets
