#pragma once

#include <cstddef>
#include <vector>

#include "datasets/triangle_mesh.h"

/// Pieces of a scan that lie far from the object and are no part of it: a triangle or a few points that the scanner or
/// an export left somewhere. They are left out first of all, since the grid on which surfaces are rebuilt is as large
/// as all there is: a single far point would leave the object a few cells. The object is where all but 1 % of the area
/// or of the points lies, on every side. What does not come within half its length of that is stray, as long as all of
/// it together is 1 % at most: a larger share is no mistake.
namespace morphodesic::datasets {

struct Strays {
    std::size_t count = 0;  ///< triangles or points that were left out
    double share = 0.0;     ///< of the area or of the points
};

/// Leaves out stray pieces of a surface. Closed ones only if they are specks: others are parts of the object.
/// @param mesh            cleaned, and each patch of one orientation
/// @param speck_fraction  closed pieces below this share of the volume are specks
Strays leave_out_strays(TriangleMesh& mesh, double speck_fraction);

/// Leaves out stray points; points that a chain of others joins to the object stay.
/// @param points  not empty, no two the same
Strays leave_out_strays(std::vector<Vector3>& points);

}  // namespace morphodesic::datasets
