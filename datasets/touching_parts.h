#pragma once

#include <cstdint>
#include <vector>

#include "datasets/lattice.h"
#include "datasets/triangle_mesh.h"
#include "datasets/triangle_tree.h"

/// Parts of a solid that lie face to face, as two bricks do. Between them is no room, but a surface made of both has
/// two walls there, and the distance from it would be zero all over a plane within the solid. No winding number tells:
/// it is 1 on both sides.
namespace morphodesic::datasets {

/// Whether patches of a closed surface lie face to face on more than a few cells: nearer to each other than a hundredth
/// of a cell. Patches that meet at a point or along an edge do not touch.
/// @param mesh   closed, seen from outside
/// @param patch  its patches across edges of two triangles
/// @param cell   what no grid that it will be drawn on can tell apart [length]
bool parts_touch(const TriangleMesh& mesh, const Patches& patch, double cell);

/// Sets the winding number to 1 at nodes that lie in the slits between touching parts.
void close_slits(const TriangleTree& surface, const Lattice& lattice, std::vector<std::int8_t>& winding);

}  // namespace morphodesic::datasets
