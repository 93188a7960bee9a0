#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/quadrature.h"

namespace morphodesic {

/// Where preconditioners look at a cell, given where the energy does: one or two pairs of points at opposite places.
/// More do not save iterations (measured).
template <int Dim>
constexpr std::span<const Point<Dim>> mismatch_points(kernels::Quadrature energy) {
    constexpr auto& points = kernels::quadrature::points<Dim, kernels::Quadrature::few>;
    return std::span(points).first(energy == kernels::Quadrature::few ? 2 : 4);
}

/// A quadrature point of one time step that is close to a contour, before or after the deformation.
template <int Dim>
struct MismatchPoint {
    std::size_t node;                    ///< first node of its cell
    Point<Dim> fraction;                 ///< place in that cell
    q1::Location<Dim> target;            ///< cell and place of the deformed point
    double here, there;                  ///< delta_eps of u_{k-1} at the point and of u_k at the deformed point
    double slope[Dim];                   ///< grad u_k at the deformed point
    double displacement[Dim][1 << Dim];  ///< of the corners of the cell
};

/// visit(point) for those of the `points` of every cell of the step u_{k-1} = from, u_k = to, phi = id + w that are
/// closer than 6 eps to a contour; elsewhere delta_eps^2 |grad u|^2 is below 1e-3 of its largest value.
template <int Dim, class Visitor>
void for_each_mismatch_point(const DyadicGrid<Dim>& grid, std::span<const Point<Dim>> points, const double* from,
                             const double* to, const DisplacementView<Dim>& w, double eps, Visitor&& visit) {
    constexpr int corners = 1 << Dim;
    const auto offsets = q1::corner_offsets(grid);
    const double per_cell = grid.cells_per_unit(), far = 6.0 * eps;
    MismatchPoint<Dim> p{};
    double shape[kernels::quadrature::points<Dim, kernels::Quadrature::few>.size()][corners];
    for (std::size_t q = 0; q < points.size(); ++q) {
        for (int c = 0; c < corners; ++c) shape[q][c] = q1::shape<Dim>(c, points[q]);
    }
    typename DyadicGrid<Dim>::Index cell{};
    for (std::size_t number = 0; number < grid.cell_count(); ++number) {
        p.node = grid.index(cell);
        const auto low = cell;
        for (int a = 0; a < Dim && ++cell[static_cast<std::size_t>(a)] == grid.cells(a); ++a) {
            cell[static_cast<std::size_t>(a)] = 0;
        }
        double u_from[corners];
        for (int c = 0; c < corners; ++c) {
            const std::size_t i = p.node + offsets[static_cast<std::size_t>(c)];
            u_from[c] = from[i];
            for (int a = 0; a < Dim; ++a) p.displacement[a][c] = w[static_cast<std::size_t>(a)][i];
        }
        // A cell that is far from both contours has no part in it. Shapes between need not be distances: where two
        // cracks meet they are steep, and far is what is far for the values around. Displacements stretch a cell two
        // times at most where that matters.
        const auto [least, most] = std::minmax_element(u_from, u_from + corners);
        const double steep_from = std::max(1.0, (*most - *least) * per_cell);
        const bool near_from = *least<far * steep_from&& * most> - far * steep_from;
        if (!near_from) {
            Point<Dim> y{};
            for (int a = 0; a < Dim; ++a) {
                const auto at = static_cast<std::size_t>(a);
                y[at] = (low[at] + 0.5) / per_cell;
                for (int c = 0; c < corners; ++c) y[at] += p.displacement[a][c] / corners;
            }
            const auto middle = q1::locate(grid, y);
            double u_to[corners];
            for (int c = 0; c < corners; ++c) u_to[c] = to[middle.node + offsets[static_cast<std::size_t>(c)]];
            const auto [low_to, high_to] = std::minmax_element(u_to, u_to + corners);
            const double reach = (far + 2.0 * grid.spacing()) * std::max(1.0, (*high_to - *low_to) * per_cell);
            if (*low_to > reach || *high_to < -reach) continue;
        }
        for (std::size_t q = 0; q < points.size(); ++q) {
            Point<Dim> y{};
            double before = 0.0;
            for (int a = 0; a < Dim; ++a) {
                const auto at = static_cast<std::size_t>(a);
                y[at] = (low[at] + points[q][at]) / per_cell;
                for (int c = 0; c < corners; ++c) y[at] += shape[q][c] * p.displacement[a][c];
            }
            for (int c = 0; c < corners; ++c) before += shape[q][c] * u_from[c];
            p.target = q1::locate(grid, y);
            double after = 0.0;
            std::fill(p.slope, p.slope + Dim, 0.0);
            for (int c = 0; c < corners; ++c) {
                const double v = to[p.target.node + offsets[static_cast<std::size_t>(c)]];
                after += q1::shape<Dim>(c, p.target.fraction) * v;
                for (int a = 0; a < Dim; ++a)
                    p.slope[a] += q1::shape_slope<Dim>(c, p.target.fraction, a) * v * per_cell;
            }
            double steep_to = 1.0;
            for (const double g : p.slope) steep_to = std::max(steep_to, std::abs(g));
            if (std::abs(after) > far * steep_to && std::abs(before) > far * steep_from) continue;
            p.fraction = points[q];
            p.there = smooth_delta(after, eps);
            p.here = smooth_delta(before, eps);
            visit(p);
        }
    }
}

}  // namespace morphodesic
