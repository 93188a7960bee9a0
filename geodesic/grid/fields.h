#pragma once

#include <array>
#include <vector>

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic {

/// Multilinear (Q1) function given by its values at the nodes, [N] in the order of DyadicGrid.
template <int Dim>
struct ScalarField {
    DyadicGrid<Dim> grid;
    std::vector<double> values;

    ScalarField() = default;
    explicit ScalarField(DyadicGrid<Dim> g, double value = 0.0) : grid(g), values(g.node_count(), value) {}
};

/// Level set function u of a shape: u > 0 inside, u < 0 outside, in units of length of the unit cube; near the contour
/// a signed distance.
template <int Dim>
using LevelSet = ScalarField<Dim>;

/// Q1 vector field, one array [N] per component.
template <int Dim>
struct VectorField {
    DyadicGrid<Dim> grid;
    std::array<std::vector<double>, Dim> components;

    VectorField() = default;
    explicit VectorField(DyadicGrid<Dim> g) : grid(g) {
        for (auto& c : components) c.assign(g.node_count(), 0.0);
    }
};

/// Deformation phi of the unit cube, stored as its displacement phi - id (so that near-identical shapes lose no
/// digits); the displacement vanishes on the boundary of the cube.
template <int Dim>
struct Deformation {
    VectorField<Dim> displacement;

    Deformation() = default;
    explicit Deformation(DyadicGrid<Dim> g) : displacement(g) {}
    [[nodiscard]] const DyadicGrid<Dim>& grid() const { return displacement.grid; }
};

}  // namespace morphodesic
