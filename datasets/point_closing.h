#pragma once

#include <vector>

#include "datasets/lattice.h"
#include "datasets/triangle_mesh.h"

/// Morphological closing of point clouds.
namespace morphodesic::datasets {

/// 6th smallest distance to other points, for about a thousand of the points, in ascending order.
std::vector<double> sorted_spacings(const std::vector<Vector3>& points);

/// Signed distance of the closing: the region beyond the ball's reach, shrunk by its radius.
struct Closing {
    std::vector<float> values;  ///< > 0 inside
    double volume = 0.0;        ///< by counting nodes
    bool has_core = false;      ///< a ball of this radius fits inside: the points enclose more than themselves
};
/// The closing of points by a ball.
/// @param distance  of the nodes to the nearest point [N]
Closing closing(const Lattice& lattice, const std::vector<float>& distance, double radius);

}  // namespace morphodesic::datasets
