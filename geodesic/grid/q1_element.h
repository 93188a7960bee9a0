#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "geodesic/grid/fields.h"

namespace morphodesic::q1 {

/// Offsets of the corners of a cell from its first node; bit a of the corner is its position on axis a.
template <int Dim>
constexpr std::array<std::size_t, 1 << Dim> corner_offsets(const DyadicGrid<Dim>& grid) {
    std::array<std::size_t, 1 << Dim> offsets{};
    for (int c = 0; c < (1 << Dim); ++c) {
        typename DyadicGrid<Dim>::Index i{};
        for (int a = 0; a < Dim; ++a) i[a] = (c >> a) & 1;
        offsets[static_cast<std::size_t>(c)] = grid.index(i);
    }
    return offsets;
}

/// Multilinear shape function of `corner` at a point of the unit cell.
template <int Dim>
constexpr double shape(int corner, const Point<Dim>& x) {
    double value = 1.0;
    for (int a = 0; a < Dim; ++a) value *= ((corner >> a) & 1) ? x[a] : 1.0 - x[a];
    return value;
}

/// Its derivative along `axis`, per unit cell.
template <int Dim>
constexpr double shape_slope(int corner, const Point<Dim>& x, int axis) {
    double value = ((corner >> axis) & 1) ? 1.0 : -1.0;
    for (int a = 0; a < Dim; ++a) {
        if (a != axis) value *= ((corner >> a) & 1) ? x[a] : 1.0 - x[a];
    }
    return value;
}

/// Cell that contains a point of the cube (points outside go to the nearest cell) and the place in that cell.
template <int Dim>
struct Location {
    std::size_t node;     ///< first node of the cell
    Point<Dim> fraction;  ///< in [0,1]
};

template <int Dim>
Location<Dim> locate(const DyadicGrid<Dim>& grid, const std::type_identity_t<Point<Dim>>& x) {
    Location<Dim> at{};
    typename DyadicGrid<Dim>::Index cell{};
    for (int a = 0; a < Dim; ++a) {
        const int cells = grid.cells(a);
        const double y = std::clamp(x[a] * grid.cells_per_unit(), 0.0, 1.0 * cells);
        cell[a] = std::min(static_cast<int>(y), cells - 1);
        at.fraction[a] = y - cell[a];
    }
    at.node = grid.index(cell);
    return at;
}

/// Value of a Q1 function at any point of the cube; points outside take the value of the nearest point.
template <int Dim>
double value(const DyadicGrid<Dim>& grid, const double* field, const std::type_identity_t<Point<Dim>>& x) {
    const auto at = locate(grid, x);
    const auto offsets = corner_offsets(grid);
    double sum = 0.0;
    for (int c = 0; c < (1 << Dim); ++c) {
        sum += shape<Dim>(c, at.fraction) * field[at.node + offsets[static_cast<std::size_t>(c)]];
    }
    return sum;
}

/// Values of several Q1 functions at one point, as `value`.
template <int Dim, std::size_t Count>
std::array<double, Count> values(const DyadicGrid<Dim>& grid, const std::array<const double*, Count>& fields,
                                 const std::type_identity_t<Point<Dim>>& x) {
    const auto at = locate(grid, x);
    const auto offsets = corner_offsets(grid);
    std::array<double, Count> sums{};
    for (int c = 0; c < (1 << Dim); ++c) {
        const double share = shape<Dim>(c, at.fraction);
        for (std::size_t f = 0; f < Count; ++f) {
            sums[f] += share * fields[f][at.node + offsets[static_cast<std::size_t>(c)]];
        }
    }
    return sums;
}

/// Visits every cell with the index of its first node.
template <int Dim, class Visitor>
void for_each_cell(const DyadicGrid<Dim>& grid, Visitor&& visit) {
    typename DyadicGrid<Dim>::Index i{};
    for (std::size_t cell = 0; cell < grid.cell_count(); ++cell) {
        visit(grid.index(i));
        for (int a = 0; a < Dim && ++i[a] == grid.cells(a); ++a) i[a] = 0;
    }
}

}  // namespace morphodesic::q1
