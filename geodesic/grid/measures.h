#pragma once

#include "geodesic/grid/fields.h"

namespace morphodesic {

/// Size and topology of the object {u > 0}.
struct ShapeMeasures {
    double volume = 0.0;   ///< area in 2D, volume in 3D; length^Dim
    double surface = 0.0;  ///< perimeter in 2D, surface area in 3D; length^(Dim-1)
    int euler = 0;         ///< Euler number; 2D: parts minus holes; 3D: parts minus tunnels plus cavities
    int components = 0;    ///< connected parts
};

/// Measures of the object on the Freudenthal triangulation of the grid (2 triangles or 6 tetrahedra per cell), where u
/// is taken as linear: volume and surface are exact for it, second order in h for a smooth shape; Euler number and
/// parts are those of the nodes inside with the edges, triangles and tetrahedra between them.
template <int Dim>
ShapeMeasures measure(const LevelSet<Dim>& u);

/// How full a shape is: V / g^Dim times V^((Dim - 1) / Dim) / S, with the volume V, the radius of gyration g (root mean
/// square distance from the centroid) and the surface S, in units of what a ball has. Gaps, holes and limbs lower it;
/// size and rigid motions do not change it. Nodes count by how far they are from the contour, so that the error is of
/// second order in h.
/// @param u  signed distance
/// @return 1 for a ball, less for all else; 0 without an object
template <int Dim>
double fullness(const LevelSet<Dim>& u);

/// Volume of the part of the object where inside(centre of a simplex) holds.
template <int Dim, class Inside>
double volume_where(const LevelSet<Dim>& u, Inside&& inside);

namespace detail {

/// Share of a simplex with linear values f in which f > 0, and the size of {f = 0} in it.
struct SimplexPart {
    double volume = 0.0, surface = 0.0;
};
template <int Dim>
SimplexPart simplex_part(const std::array<Point<Dim>, Dim + 1>& x, const std::array<double, Dim + 1>& f);

/// Visits every simplex of the triangulation with its nodes.
template <int Dim, class Visitor>
void for_each_simplex(const DyadicGrid<Dim>& grid, Visitor&& visit) {
    constexpr int orders[6][3] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {0, 2, 1}, {1, 2, 0}, {2, 1, 0}};
    constexpr int simplices = Dim == 2 ? 2 : 6;
    const int cells = grid.cells_per_axis();
    typename DyadicGrid<Dim>::Index cell{};
    for (std::size_t c = 0; c < grid.cell_count(); ++c) {
        for (int s = 0; s < simplices; ++s) {
            std::array<typename DyadicGrid<Dim>::Index, Dim + 1> nodes;
            nodes[0] = cell;
            for (std::size_t i = 0; i < Dim; ++i) {
                nodes[i + 1] = nodes[i];
                ++nodes[i + 1][static_cast<std::size_t>(orders[s][i])];
            }
            visit(nodes);
        }
        for (std::size_t a = 0; a < Dim && ++cell[a] == cells; ++a) cell[a] = 0;
    }
}

}  // namespace detail

template <int Dim, class Inside>
double volume_where(const LevelSet<Dim>& u, Inside&& inside) {
    double volume = 0.0;
    detail::for_each_simplex<Dim>(u.grid, [&](const auto& nodes) {
        std::array<Point<Dim>, Dim + 1> x;
        std::array<double, Dim + 1> f;
        Point<Dim> centre{};
        bool any = false;
        for (std::size_t i = 0; i <= Dim; ++i) {
            x[i] = u.grid.position(nodes[i]);
            f[i] = u.values[u.grid.index(nodes[i])];
            any = any || f[i] > 0;
            for (std::size_t a = 0; a < Dim; ++a) centre[a] += x[i][a] / (Dim + 1);
        }
        if (any && inside(centre)) volume += detail::simplex_part<Dim>(x, f).volume;
    });
    return volume;
}

}  // namespace morphodesic
