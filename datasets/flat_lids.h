#pragma once

#include <cstddef>
#include <vector>

#include "datasets/triangle_mesh.h"
#include "datasets/triangle_tree.h"

namespace morphodesic::datasets {

/// Flat cuts, as of an object that stood on a floor or was cut off at the edge of the scan, are closed flat: wide
/// openings whose walls do not bend over them yet. A lid that goes on smoothly would be a dome. Over a plane rim the
/// 1/2 level of the winding number is the plane, over another one it bulges as little as the rim does.
/// @param rebuilt  closed, by winding numbers; lids of plane rims are moved onto the plane
/// @param is_free  which of its points lie off the scan; those of flat lids are so no more [points]
/// @param scan     what was rebuilt
/// @param ragged   how far the rim may end before the cut, by the grid and by the points that are far between: it is
///                 where the outermost points of the rim are, but no more beyond its mean than this
/// @param size     of the object
/// @return  number of flat lids
std::size_t flatten_lids(TriangleMesh& rebuilt, std::vector<char>& is_free, const TriangleTree& scan, double ragged,
                         double size);

}  // namespace morphodesic::datasets
