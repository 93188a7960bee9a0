#pragma once

#include <vector>

#include "datasets/lattice.h"
#include "datasets/triangle_mesh.h"
#include "datasets/triangle_tree.h"

namespace morphodesic::datasets {

struct Turned {
    std::size_t turned = 0;      ///< triangles
    std::size_t hidden = 0;      ///< triangles of open patches that see nothing of the outside: walls within the solid
    bool filled_cavity = false;  ///< what looks like the wall of a cavity was too open to be one
};

/// Turns each open patch so that its front, not its back, looks into the open (Takayama et al. 2014), and removes those
/// that do not see it at all; closed patches get a positive volume. Walls of cavities stay as they are
/// (nested_shells.h).
/// @param surface  the tree of the same mesh
Turned turn_patches_outward(TriangleMesh& mesh, const Patches& patch, const TriangleTree& surface);

/// Rebuilds an open surface. Near triangles their distance says where the surface is; in holes the 1/2 level of the
/// winding number does, at the distance |w - 1/2| / |grad w|.
/// @param distance  of the nodes to the triangles, exact near them [N]
TriangleMesh rebuilt_open(const TriangleTree& tree, const Lattice& lattice, const std::vector<float>& distance);

}  // namespace morphodesic::datasets
