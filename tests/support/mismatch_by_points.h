#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/q1_element.h"

namespace morphodesic::tests {

/// Midpoints of so many parts per axis of the unit cell.
template <int Dim>
std::vector<Point<Dim>> midpoints(int per_axis) {
    std::vector<Point<Dim>> points;
    for (int p = 0; p < static_cast<int>(std::pow(per_axis, Dim) + 0.5); ++p) {
        Point<Dim> x;
        for (int a = 0, rest = p; a < Dim; ++a, rest /= per_axis) {
            x[static_cast<std::size_t>(a)] = (rest % per_axis + 0.5) / per_axis;
        }
        points.push_back(x);
    }
    return points;
}

/// E_match (12) of a time step in the cell at `node`, by the given points of the unit cell, which all weigh the same.
/// @param w         displacement, one pointer per component
/// @param from, to  u_{k-1} and u_k
template <int Dim>
double mismatch_by_points(const DyadicGrid<Dim>& grid, std::size_t node, std::span<const Point<Dim>> points,
                          const std::array<const double*, Dim>& w, const double* from, const double* to, double eps) {
    const auto low = grid.position(grid.node(node));
    double sum = 0.0;
    for (const Point<Dim>& p : points) {
        Point<Dim> here = low;
        for (std::size_t a = 0; a < Dim; ++a) here[a] += p[a] * grid.spacing();
        Point<Dim> there = here;
        const auto moved = q1::values<Dim, Dim>(grid, w, here);
        for (std::size_t a = 0; a < Dim; ++a) there[a] += moved[a];
        const double d =
            smooth_heaviside(q1::value(grid, to, there), eps) - smooth_heaviside(q1::value(grid, from, here), eps);
        sum += d * d;
    }
    return sum / static_cast<double>(points.size()) * std::pow(grid.spacing(), Dim);
}

}  // namespace morphodesic::tests
