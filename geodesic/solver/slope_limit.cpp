#include "geodesic/solver/slope_limit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/vector_kernels.h"

namespace morphodesic {

template <int Dim>
SlopeLimit<Dim>::SlopeLimit(const PathLayout<Dim>& layout)
    : layout_(layout), scaled_(static_cast<std::size_t>(layout.time_steps)) {}

/// Lists both ends of the edges and diagonals of the cell at `node` that cross the contour too steeply.
template <int Dim>
void SlopeLimit<Dim>::list_steep(const double* u, std::size_t node, double limit, std::vector<Scaled>& scaled) const {
    const auto corners = q1::corner_offsets(layout_.grid);
    for (std::size_t c = 0; c < corners.size(); ++c) {
        for (std::size_t d = 0; d < c; ++d) {
            const std::size_t one = node + corners[c], other = node + corners[d];
            const double most = limit * std::sqrt(1.0 * std::popcount(c ^ d));
            const double change = std::abs(u[one] - u[other]);
            if (!(u[one] * u[other] < 0.0 && change > most)) continue;
            scaled.push_back({one, most / change});
            scaled.push_back({other, most / change});
        }
    }
}

template <int Dim>
void SlopeLimit<Dim>::apply(std::span<double> x) {
    const auto& grid = layout_.grid;
    const auto cells = static_cast<std::size_t>(grid.cells(0));
    const double limit = steepest * grid.spacing();
    const auto stride = grid.strides();
    for_indices(1, layout_.time_steps, [&](int k) {
        double* u = x.data() + layout_.level_set(k);
        auto& scaled = scaled_[static_cast<std::size_t>(k)];
        scaled.clear();
        for_marked_cells(
            grid,
            [&](std::size_t row, unsigned char* flags) {
                return kernels::steep_cells<Dim>(cells, u + row, stride, limit, flags);
            },
            [&](std::size_t cell) { list_steep(u, cell, limit, scaled); });
        // A node has the factor of the steepest edge it is at.
        std::sort(scaled.begin(), scaled.end(), [](const Scaled& a, const Scaled& b) {
            return std::tie(a.node, a.factor) < std::tie(b.node, b.factor);
        });
        const auto same = [](const Scaled& a, const Scaled& b) { return a.node == b.node; };
        scaled.erase(std::unique(scaled.begin(), scaled.end(), same), scaled.end());
        for (const Scaled& s : scaled) u[s.node] *= s.factor;
    });
}

template <int Dim>
void SlopeLimit<Dim>::hold(std::span<const double> x, std::span<float> gradient) const {
    for (int k = 1; k < layout_.time_steps; ++k) {
        const std::size_t first = layout_.level_set(k);
        for (const Scaled& s : scaled_[static_cast<std::size_t>(k)]) {
            float& g = gradient[first + s.node];
            if (x[first + s.node] * static_cast<double>(g) < 0) g = 0.0F;
        }
    }
}

template class SlopeLimit<2>;
template class SlopeLimit<3>;

}  // namespace morphodesic
