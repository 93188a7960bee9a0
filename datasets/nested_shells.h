#pragma once

#include <vector>

#include "datasets/triangle_mesh.h"

/// Shells within shells, as a hollow object has them. From outside the wall of a cavity is not to be seen, so no look
/// at it tells which of its sides is which; but the file does, if the wall is turned against the shell around it.
namespace morphodesic::datasets {

/// What becomes of the patches of a surface.
struct PatchFate {
    std::vector<char> turn;    ///< [patches] the other way round than in the mesh
    std::vector<char> hidden;  ///< [patches] to be left out
};

/// Corrects what was decided for patches one by one. One that is (almost) closed, lies within another one and is turned
/// inward in the file, where that shows its outer side, is the wall of a cavity and stays; so does what lies within a
/// cavity. If the file shows the inner side of the outer shell, all is meant the other way round.
/// @return  whether there seems to be a cavity whose wall is too open to keep it
bool keep_cavity_walls(const TriangleMesh& mesh, const Patches& patch, PatchFate& fate);

}  // namespace morphodesic::datasets
