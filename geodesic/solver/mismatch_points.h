#pragma once

#include <algorithm>
#include <span>
#include <utility>

#include "geodesic/grid/injectivity.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/mismatch_kernel.h"
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
/// close to a contour, see kernels::mismatch_points_of; cell by cell.
template <int Dim, class Visitor>
void for_each_mismatch_point(const DyadicGrid<Dim>& grid, std::span<const Point<Dim>> points, const double* from,
                             const double* to, const DisplacementView<Dim>& w, double eps, Visitor&& visit) {
    const auto offsets = q1::corner_offsets(grid);
    const auto cells = static_cast<std::size_t>(grid.cells(0));
    kernels::MismatchRow<Dim> row{{}, {}, grid.cells_per_unit(), eps, from, to, {}};
    std::copy(grid.cells().begin(), grid.cells().end(), row.cells);
    std::copy(w.begin(), w.end(), row.w);
    static thread_local kernels::MismatchRowPoints<Dim> found;  // rows are many, and no visitor looks at another one
    MismatchPoint<Dim> p{};
    for (std::size_t done = 0; done < grid.cell_count(); done += cells) {
        typename DyadicGrid<Dim>::Index low{};
        std::copy(row.low, row.low + Dim, low.begin());
        const std::size_t first = grid.index(low);
        const bool any = kernels::mismatch_points_of<Dim>(row, points, found);
        for (int a = 1; a < Dim && ++row.low[a] == grid.cells(a); ++a) row.low[a] = 0;
        for (std::size_t i = 0; any && i < cells; ++i) {
            bool loaded = false;
            for (std::size_t q = 0; q < points.size(); ++q) {
                const std::size_t at = q * cells + i;
                if (!found.near[at]) continue;
                if (!std::exchange(loaded, true)) {
                    p.node = first + i;
                    for (int a = 0; a < Dim; ++a) {
                        for (std::size_t c = 0; c < offsets.size(); ++c)
                            p.displacement[a][c] = row.w[a][p.node + offsets[c]];
                    }
                }
                p.fraction = points[q];
                p.target.node = static_cast<std::size_t>(found.node[at]);
                p.here = found.here[at];
                p.there = found.there[at];
                for (std::size_t a = 0; a < Dim; ++a) {
                    p.target.fraction[a] = found.fraction[a][at];
                    p.slope[a] = found.slope[a][at];
                }
                visit(p);
            }
        }
    }
}

}  // namespace morphodesic
