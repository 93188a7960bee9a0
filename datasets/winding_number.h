#pragma once

#include <cstdint>
#include <vector>

#include "datasets/lattice.h"
#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

/// Winding numbers of a closed surface (MeshTopology::closed) at the nodes of a lattice [N]: how many times it goes
/// around each. Exact but for nodes on the surface; clamped to [-127, 127].
std::vector<std::int8_t> winding_numbers(const TriangleMesh& mesh, const Lattice& lattice);

}  // namespace morphodesic::datasets
