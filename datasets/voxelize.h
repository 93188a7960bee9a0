#pragma once

#include <vector>

#include "datasets/lattice.h"
#include "datasets/triangle_mesh.h"
#include "geodesic/grid/fields.h"

namespace morphodesic::datasets {

/// Distance to the triangles at the nodes [N], exact up to two spacings; beyond them too large by up to half a spacing,
/// and equal to band * spacing beyond the band.
std::vector<float> distance_to_triangles(const TriangleMesh& mesh, const Lattice& lattice, double band = 3.0);

/// Surface between the nodes with positive and with negative values, as a closed mesh seen from the negative side.
/// @param values  [N], > 0 inside, in the units of the lattice; negative at the border of the lattice
TriangleMesh isosurface(const Lattice& lattice, const std::vector<float>& values);

/// Signed distance to a closed mesh (MeshTopology::closed) at the nodes of the unit cube's grid, > 0 where the surface
/// goes around at least once. Exact (to float precision) within four cells of the surface, too large by at most h / 5
/// beyond.
LevelSet<3> signed_distance(const TriangleMesh& mesh, const DyadicGrid<3>& grid);

}  // namespace morphodesic::datasets
