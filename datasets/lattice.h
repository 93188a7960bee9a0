#pragma once

#include <array>
#include <cstddef>

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic::datasets {

/// Nodes of a box-shaped regular grid in 3D, in any units. Storage order as DyadicGrid: axis 0 runs fastest.
struct Lattice {
    std::array<int, 3> nodes{};  ///< per axis
    Point<3> origin{};           ///< of node (0, 0, 0)
    double spacing = 1.0;        ///< > 0

    [[nodiscard]] std::size_t node_count() const {
        return static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) *
               static_cast<std::size_t>(nodes[2]);
    }
    [[nodiscard]] std::size_t index(int i, int j, int k) const {
        return static_cast<std::size_t>(i) +
               static_cast<std::size_t>(nodes[0]) *
                   (static_cast<std::size_t>(j) + static_cast<std::size_t>(nodes[1]) * static_cast<std::size_t>(k));
    }
    [[nodiscard]] Point<3> position(int i, int j, int k) const {
        return {origin[0] + i * spacing, origin[1] + j * spacing, origin[2] + k * spacing};
    }
};

}  // namespace morphodesic::datasets
